// What the pixels of a tile keep while they are open. A pixel that nothing has touched, that one triangle covers, or
// that is finished needs no more than a word of six bytes. A pixel that surfaces share has a record as well: bit planes
// that say which surface owns which mask position, with as many planes as there are states; 8 bytes for each surface;
// and 16 bytes of sums once a surface is final or a speck was seen. Records lie in chunks of a pool that the tile's
// pixels have in common. When a pool on chip has no free chunk, a record continues in memory. A pool that is in memory
// already has no other place to go: there, surfaces of the pixel are merged.
//
// The modelled machine links the chunks of a record, and those that are free, as a file system does. Which chunk is
// where changes nothing, so this program counts chunks and keeps each record in one piece. It also keeps the positions
// of each state where the machine has bit planes, which say the same (stages/beam/position_states-inl.h).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "simd/depth_plane.h"
#include "simd/wide_mask.h"
#include "stages/data/half_bits.h"
#include "stages/data/owner_slot.h"
#include "stages/data/pixel_sums.h"

namespace beampipe {

// ---- The modelled machine's layout ----

// A word holds three fp16 numbers, the colour of a finished pixel; or the triangle that covers the pixel; or a record's
// first chunk, its number of owners, whether it has empty and final positions and sums, and the area of what is final.
// Finished pixels are known by their closed depth, which is in front of everything.
inline constexpr std::uint32_t kPixelWordBytes = 6;
inline constexpr std::uint32_t kTriangleBits = 23, kOwnerCountBits = 5, kFlagBits = 3, kAreaBits = 16;
// Of a bin's pool, and of a frame's, where nothing is final before the end, so that a flag is left for the number.
inline constexpr std::uint32_t kChunkNumberBits = 16, kFrameChunkNumberBits = 24;
// One bit tells records from what takes less, where a second one tells untouched pixels from covered ones.
static_assert(2 + kTriangleBits <= 8 * kPixelWordBytes);
static_assert(1 + kChunkNumberBits + kOwnerCountBits + kFlagBits + kAreaBits <= 8 * kPixelWordBytes);
static_assert(1 + kFrameChunkNumberBits + kOwnerCountBits + kFlagBits - 1 + kAreaBits <= 8 * kPixelWordBytes);

// A chunk, and the number of the record's next chunk or, if it is free, of the next free one.
inline constexpr std::uint32_t kChunkBytes = 16, kChunkLinkBytes = 2, kFrameChunkLinkBytes = 3;
static_assert(kChunkNumberBits <= 8 * kChunkLinkBytes && kFrameChunkNumberBits <= 8 * kFrameChunkLinkBytes);

// States of a position: empty, final, or owned by one of these. Five bit planes are the most.
inline constexpr std::size_t kMostStates = 32, kMostOwners = kMostStates - 2;

// Bit planes for so many states that occur.
constexpr std::uint32_t planes_for(std::size_t states) {
  return states < 2 ? 0 : static_cast<std::uint32_t>(std::bit_width(states - 1));
}

// What a record holds. Planes, slots and sums begin with a chunk each, so that one can grow without the others' moving.
struct RecordShape {
  std::uint8_t owners = 0;
  bool has_empty = false;  // are there positions that nothing covers yet?
  bool has_final = false;  // are there positions whose surface is final?
  bool has_sums = false;

  constexpr std::size_t first_owner() const {
    return std::size_t{has_empty} + has_final;
  }  // its state; those below: see above
  constexpr std::size_t states() const { return first_owner() + owners; }
  constexpr std::uint32_t planes() const { return planes_for(states()); }
  constexpr std::uint32_t chunks(std::size_t words) const {
    const auto of = [](std::size_t bytes) {
      return static_cast<std::uint32_t>((bytes + kChunkBytes - 1) / kChunkBytes);
    };
    return of(planes() * words * 4) + of(owners * sizeof(OwnerSlot)) + (has_sums ? of(sizeof(PixelSums)) : 0);
  }
};

// The longest record, and the shortest one that can show two surfaces, or one in front of nothing.
constexpr std::uint32_t most_chunks(std::size_t words) {
  return RecordShape{.owners = kMostOwners, .has_empty = true, .has_final = true, .has_sums = true}.chunks(words);
}
constexpr std::uint32_t least_chunks(std::size_t words) { return RecordShape{.owners = 2}.chunks(words); }

// Of a tile of 32 x 32 pixels, on chip and in memory.
static_assert(32 * 32 * most_chunks(kMaxMaskWords) <= 1u << kChunkNumberBits);

// The free chunks of a tile's pool.
class ChunkPool {
 public:
  // A pool on chip, of so many bytes with the links of its chunks. Beyond it, records continue in memory.
  explicit ChunkPool(std::size_t bytes) : on_chip_(bytes / (kChunkBytes + kChunkLinkBytes)) {}

  // A pool in memory that the whole frame shares. It is for others to say when it is full, and to close it. A record
  // can have `guaranteed` chunks even then.
  static ChunkPool of_frame(std::uint32_t guaranteed) {
    ChunkPool pool(std::size_t{1} << 40);
    pool.guaranteed_ = guaranteed;
    pool.link_bytes_ = kFrameChunkLinkBytes;
    return pool;
  }
  void close() { is_closed_ = true; }

  // Of one record.
  struct Chunks {
    std::uint16_t count = 0, in_memory = 0;
  };

  // May a record have so many chunks?
  bool has_room(const Chunks& of, std::uint32_t count) const {
    return !is_closed_ || count <= std::max<std::uint32_t>(of.count, guaranteed_);
  }

  // A record's chunks become so many. Chunks in memory are the first to be given back.
  void resize(Chunks& of, std::uint32_t count) {
    beyond_guaranteed_ = beyond_guaranteed_ + beyond(count) - beyond(of.count);
    if (count > of.count) {
      const std::size_t wanted = count - of.count, room = on_chip_ - std::min(on_chip_, used_on_chip_);
      const std::size_t taken = std::min(wanted, room);
      used_on_chip_ += taken;
      of.in_memory = static_cast<std::uint16_t>(of.in_memory + (wanted - taken));
      in_memory_ += wanted - taken;
      taken_since_collection_ += wanted;
    } else {
      const std::size_t given = of.count - count, from_memory = std::min<std::size_t>(given, of.in_memory);
      of.in_memory = static_cast<std::uint16_t>(of.in_memory - from_memory);
      in_memory_ -= from_memory;
      used_on_chip_ -= given - from_memory;
    }
    of.count = static_cast<std::uint16_t>(count);
    peak_ = std::max(peak_, used());
    peak_in_memory_ = std::max(peak_in_memory_, in_memory_);
  }

  // Is it time to look for what is final? Only if seven eighths of the pool are in use, and a quarter of it was taken
  // since the last time, so that a collection is paid by what made it necessary.
  bool wants_collection() const { return 8 * used() > 7 * on_chip_ && 4 * taken_since_collection_ > on_chip_; }
  void collected() { taken_since_collection_ = 0; }

  std::size_t used() const { return used_on_chip_ + in_memory_; }
  std::size_t beyond_guaranteed() const { return beyond_guaranteed_; }  // chunks of all records
  std::size_t peak() const { return peak_; }
  std::uint32_t link_bytes() const { return link_bytes_; }
  std::size_t peak_in_memory() const { return peak_in_memory_; }

 private:
  std::size_t beyond(std::uint32_t count) const { return count - std::min(count, guaranteed_); }

  std::size_t on_chip_, used_on_chip_ = 0, in_memory_ = 0;
  std::uint32_t guaranteed_ = 0, link_bytes_ = kChunkLinkBytes;
  std::size_t beyond_guaranteed_ = 0;
  bool is_closed_ = false;
  std::size_t taken_since_collection_ = 0, peak_ = 0, peak_in_memory_ = 0;
};

// So many chunks more or fewer than are guaranteed, from this triangle of the frame on.
struct PoolClaim {
  std::uint32_t triangle = 0;
  std::int32_t chunks = 0;
};

// Chunks that were read and written in memory.
struct ChunkRequests {
  std::uint64_t reads = 0, writes = 0;

  void operator+=(const ChunkRequests& more) { reads += more.reads, writes += more.writes; }
  std::uint64_t all() const { return reads + writes; }
};

// One access to the record of a pixel.
struct RecordVisit {
  std::uint32_t key = 0;     // the number of the triangle in the list for which it was visited
  std::uint32_t pixel = 0;   // of the tile
  std::uint16_t chunks = 0;  // that it has; 0: they are free again
  bool is_write = false;
};

// ---- This program's ----

enum class PixelKind : std::uint8_t { untouched, covered, open, finished };

struct PixelWord {
  PixelKind kind = PixelKind::untouched;
  RecordShape shape;             // open
  FixedSum area;                 // open: of what is final, by analytic area
  std::uint32_t number = 0;      // covered: of the triangle in the bin's list
  ChunkPool::Chunks chunks;      // open
  void* record = nullptr;        // open: this program's (RecordStore)
  std::uint8_t record_size = 0;  // open
  HalfBits color[3];             // finished; linear RGB
};

// What each record has.
template <std::size_t Words>
struct RecordHead {
  PixelSums sums;
  // In a frame's pool, the nearest depth of a speck. It has room in the sums of final colours by positions: all three
  // are 0 as long as nothing is final.
  float nearest_speck;
  std::uint32_t empty[Words], final[Words];  // positions
};

// A record with room for so many owners. Depths of owners are not part of the modelled record: the machine computes
// them again whenever it needs them, and this program keeps them. Eight of the depths may be read at once, and four of
// the positions, from any multiple of as many.
template <std::size_t Words, std::size_t Owners>
struct Record {
  static_assert(Owners % 8 == 0);
  RecordHead<Words> head;
  float depths[4][Owners];  // the depth plane, and its upper bound in the pixel
  OwnerSlot slots[Owners];
  std::uint32_t owned[Owners][Words];  // positions
};

// Where a record lies. Kernels have to inline what is marked so: a view that a call returns is stored in parts and
// loaded as a whole, and that load waits.
template <std::size_t Words>
struct RecordView {
  RecordHead<Words>* head = nullptr;
  float* depths = nullptr;
  OwnerSlot* slots = nullptr;
  std::uint32_t* positions = nullptr;
  std::size_t row = 0;  // of depths

  template <std::size_t Owners>
  [[gnu::always_inline]] static RecordView of(Record<Words, Owners>& record) {
    return {&record.head, record.depths[0], record.slots, record.owned[0], Owners};
  }

  std::uint32_t* owned(std::size_t k) const { return positions + k * Words; }
  const float* z() const { return depths; }
  const float* dzdu() const { return depths + row; }
  const float* dzdv() const { return depths + 2 * row; }
  DepthPlane<float> plane(std::size_t k) const { return {depths[k], depths[row + k], depths[2 * row + k]}; }
  float farthest(std::size_t k) const { return depths[3 * row + k]; }
  [[gnu::always_inline]] void set(std::size_t k, const OwnerSlot& slot, const DepthPlane<float>& plane,
                                  float far) const {
    slots[k] = slot;
    depths[k] = plane.z, depths[row + k] = plane.dzdu, depths[2 * row + k] = plane.dzdv, depths[3 * row + k] = far;
  }
  [[gnu::always_inline]] void move(std::size_t from, std::size_t to) const {
    set(to, slots[from], plane(from), farthest(from));
  }
};

// Records with room for 8, 16, or 32 owners, each size in blocks that never move.
template <std::size_t Words>
class RecordStore {
 public:
  static constexpr std::size_t owners_in(std::uint8_t size) { return std::size_t{8} << size; }
  static constexpr std::uint8_t size_for(std::size_t owners) { return owners <= 8 ? 0 : owners <= 16 ? 1 : 2; }

  // The sizes have room for 8, 16 and 32 owners.
  void* take(std::uint8_t size) { return size == 0 ? small_.take() : size == 1 ? medium_.take() : large_.take(); }
  void give_back(std::uint8_t size, void* record) {
    (size == 0 ? small_.free : size == 1 ? medium_.free : large_.free).push_back(record);
  }
  [[gnu::always_inline]] static RecordView<Words> view(std::uint8_t size, void* record) {
    return size == 0   ? view_of<owners_in(0)>(record)
           : size == 1 ? view_of<owners_in(1)>(record)
                       : view_of<owners_in(2)>(record);
  }

 private:
  template <std::size_t Owners>
  [[gnu::always_inline]] static RecordView<Words> view_of(void* record) {
    return RecordView<Words>::of(*static_cast<Record<Words, Owners>*>(record));
  }

  template <std::size_t Owners>
  struct Slab {
    static constexpr std::size_t kBlock = 64;
    std::vector<std::unique_ptr<Record<Words, Owners>[]>> blocks;
    std::vector<void*> free;

    void* take() {
      if (free.empty()) {
        Record<Words, Owners>* const block =
            blocks.emplace_back(std::make_unique_for_overwrite<Record<Words, Owners>[]>(kBlock)).get();
        for (std::size_t i = kBlock; i > 0; --i) free.push_back(block + i - 1);
      }
      void* const record = free.back();
      free.pop_back();
      return record;
    }
  };

  Slab<owners_in(0)> small_;
  Slab<owners_in(1)> medium_;
  Slab<owners_in(2)> large_;
};

// What a pixel that one triangle covers is compared by. The modelled machine computes it again.
struct CoverDepth {
  DepthPlane<float> plane;
  float farthest;
};

// The open pixels of a tile, row by row.
template <std::size_t Words>  // 32 positions a word
struct PooledPixels {
  // `owners`: the most of a pixel, up to kMostOwners; beyond that, two are merged.
  PooledPixels(std::size_t count, const ChunkPool& of_records, std::size_t owners = kMostOwners)
      : words(count),
        covers(std::make_unique_for_overwrite<CoverDepth[]>(count)),
        pool(of_records),
        most_owners(owners) {}

  std::vector<PixelWord> words;
  std::unique_ptr<CoverDepth[]> covers;  // set where one triangle covers the pixel
  RecordStore<Words> records;
  ChunkPool pool;
  std::size_t most_owners;
  std::uint32_t closes_at = ~0u;  // the triangle of the frame from which on the pool is closed
};

}  // namespace beampipe

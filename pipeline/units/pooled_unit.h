// Composition with records in a pool: pixels pay for the edges that they have.
#pragma once

#include <algorithm>
#include <vector>

#include "pipeline/memory/record_memory.h"
#include "pipeline/units/frame_pool.h"
#include "pipeline/units/owner_units.h"
#include "stages/beam/compose_pooled.h"
#include "stages/cost/closed_depth_cost.h"

namespace beampipe {

inline constexpr const char* kRecordPool = "record_pool";  // the surface

// A word for each pixel, and so many bytes for each in a pool of records.
inline std::vector<Surface> pooled_pixel_surfaces(int pool_bytes) {
  const auto bytes = static_cast<std::uint32_t>(pool_bytes);
  std::vector<Surface> surfaces = {{"pixel_words", times("R16UI", kPixelWordBytes / 2), kPixelWordBytes}};
  if (bytes > 0) surfaces.push_back({kRecordPool, times("R8UI", bytes), bytes});
  return surfaces;
}

// Charges what records beyond a pool on chip have moved: a chunk there takes a sector. Where the pool is in memory
// itself, RecordMemory has its requests.
inline void charge_spills(Bin& bin, const BinStage& stage, const ChunkPool& pool, const ChunkRequests& spills) {
  const std::uint32_t bytes = bin.memory().sector_bytes;
  Bin::KeptInMemory records{stage.counters.stage, pool.peak_in_memory() * bytes};
  if (bin.models_memory() && bin.keeps_pixels_on_chip()) {
    stage.moves_in_l2(kSpilledRecords, spills.all() * bytes);
    records.reads = spills.reads, records.writes = spills.writes;
  }
  bin.spills(records);
}

// Charges the depth planes and the records that composition has asked for.
inline void charge_requests(Bin& bin, const BinStage& stage, const std::vector<DepthFetch>& fetched,
                            const std::vector<RecordVisit>& visits, RecordMemory& records) {
  for (const DepthFetch& fetch : fetched)
    bin.triangle_fetches().depth(fetch.triangle, stage.counters, fetch.has_vertices);
  for (const RecordVisit& visit : visits) records.access(visit, stage.counters);
}

struct RecordPool {
  int bytes_per_pixel;
  std::size_t most_owners = kMostOwners;  // of a pixel
  FramePool* of_frame = nullptr;          // in memory; null: the bin's, on chip
  std::uint32_t closes_at = ~0u;          // as PooledPixels::closes_at
};

template <std::size_t Words>
class ComposePooledUnit {
 public:
  ComposePooledUnit(Bin& bin, const OwnersBin& owners, const RecordPool& pool)
      : bin_(bin),
        stage_(bin.stage(StageId::compose)),
        owners_(owners),
        maps_{bin.pixel_counter("fragments"), bin.pixel_counter("merges")},
        pooled_maps_{bin.pixel_counter("memory_chunks"), bin.pixel_counter("record_bytes")},
        frame_pool_(pool.of_frame),
        pixels_(bin.tile.pixels(),
                pool.of_frame ? ChunkPool::of_frame(least_chunks(Words))
                              : ChunkPool(bin.tile.pixels() * static_cast<std::size_t>(pool.bytes_per_pixel)),
                pool.most_owners),
        words_(bin, pooled_pixel_surfaces(0)),
        records_(bin.memory(), kRecordPool, bin.tile.pixels(),
                 {most_chunks(Words), kChunkBytes + pixels_.pool.link_bytes()}) {
    pixels_.closes_at = pool.closes_at;
    if (!frame_pool_) return;
    pooled_maps_.refusals = &bin.pixel_counter("refusals");
    pooled_maps_.lost_specks = &bin.pixel_counter("lost_specks");
  }

  // `first`: as in OwnersBatch.
  void operator()(const std::vector<Fragment>& fragments, std::size_t first, ClosedDepth& closed, ShadeUnit& shade) {
    PooledResult result = new_result();
    compose_pooled(owners_, {fragments, first}, stage_.timed(), PooledTile<Words>{pixels_, closed, maps_, result});
    charge(closed, stage_.counters);
    words_.merge(fragments);
    for (const std::vector<std::uint32_t>& written : result.collections) words_.collect(written);
    collections_ += result.collections.size();
    claims_.insert(claims_.end(), result.claims.begin(), result.claims.end());
    finish(result, shade);
  }

  // The picture.
  std::vector<glm::vec4> resolve_owners(ShadeUnit& shade) {
    PooledResult result = new_result();
    words_.finish();
    const std::vector<PixelColor> colors = finish_pooled(owners_, stage_.timed(), pixels_, result);
    finish(result, shade);
    records_.flush(stage_.counters);
    charge_spills(bin_, stage_, pixels_.pool, spills_);
    if (bin_.models_memory() && !bin_.keeps_pixels_on_chip()) records_.add_bytes(bin_.pixel_counter("bytes"));
    if (frame_pool_) {
      frame_pool_->add(claims_);
    } else {
      report_pool();
    }
    bin_.triangle_fetches().flush(stage_.counters);
    return resolve(colors, bin_.background(), kColorBytes + sizeof(std::uint16_t), bin_.stage(StageId::resolve).timed(),
                   bin_.observers());
  }

 private:
  // What holds for the whole bin, in each of its pixels.
  void report_pool() {
    const auto set = [&](const char* name, double value) {
      std::vector<float>& pixels = bin_.pixel_counter(name);
      std::fill(pixels.begin(), pixels.end(), static_cast<float>(value));
    };
    set("collections", static_cast<double>(collections_));
    set("pool_bytes", static_cast<double>(pixels_.pool.peak() * (kChunkBytes + pixels_.pool.link_bytes())) /
                          static_cast<double>(bin_.tile.pixels()));
  }

  PooledResult new_result() {
    PooledResult result(pooled_maps_);
    result.texels = bin_.texels();
    if (!owners_.shader.is_flat()) result.shadings = &bin_.pixel_counter("shadings");
    result.lists_visits = bin_.models_memory() && !bin_.keeps_pixels_on_chip();
    result.lists_claims = frame_pool_ != nullptr;
    return result;
  }

  void finish(const PooledResult& result, ShadeUnit& shade) {
    charge_requests(bin_, stage_, result.fetched, result.visits, records_);
    spills_ += result.spills;
    shade.visible(result.shaded, result.decisions);
  }

  Bin& bin_;
  BinStage stage_;
  OwnersBin owners_;
  OwnersMaps maps_;
  PooledMaps pooled_maps_;
  FramePool* frame_pool_;
  PooledPixels<Words> pixels_;
  OpenPixelStore words_;
  RecordMemory records_;
  std::uint64_t collections_ = 0;
  ChunkRequests spills_;
  std::vector<PoolClaim> claims_;
};

}  // namespace beampipe

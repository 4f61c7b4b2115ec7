#include "pipeline/memory/sample_memory.h"

#include <algorithm>
#include <array>
#include <bit>

namespace beampipe {
namespace {

// Cells are numbered pixel by pixel, and the elements of the Z order row by row.
std::vector<std::uint32_t> cell_positions(const Tile& tile, const CellGrid& grid, const ZOrder& order) {
  std::vector<std::uint32_t> positions;
  positions.reserve(order.of.size());
  const std::int32_t width = tile.width() * grid.columns;
  for (std::int32_t y = 0; y < tile.height() * grid.rows; y += grid.rows)
    for (std::int32_t x = 0; x < width; x += grid.columns)
      for (std::int32_t row = y; row < y + grid.rows; ++row)
        for (std::int32_t column = x; column < x + grid.columns; ++column)
          positions.push_back(order.of[static_cast<std::size_t>(row * width + column)]);
  return positions;
}

constexpr std::array<std::uint32_t, kMaxMaskSamples> kBit = [] {
  std::array<std::uint32_t, kMaxMaskSamples> bits{};
  for (std::size_t s = 0; s < bits.size(); ++s) bits[s] = 1u << s;
  return bits;
}();

}  // namespace

SampleMemory::SampleMemory(const MemorySystem& memory, const Tile& tile, const Sampling& sampling,
                           std::uint32_t color_bytes, SameValue same_value)
    : modelled_(memory.models_framebuffer()),
      plane_bytes_(memory.plane_bytes),
      samples_(static_cast<std::size_t>(sampling.pattern.count)),
      cells_(static_cast<std::size_t>(sampling.grid.cells_per_pixel())),
      order_(modelled_ ? ZOrder(tile.width() * sampling.grid.columns, tile.height() * sampling.grid.rows)
                       : ZOrder(1, 1)),
      cell_position_(modelled_ ? cell_positions(tile, sampling.grid, order_) : std::vector<std::uint32_t>{}),
      same_value_(std::move(same_value)),
      color_sample_bytes_(color_bytes),
      owner_(modelled_ ? order_.positions * samples_ : 0, kNoTriangle),
      depth_(memory, "depth", order_,
             {.parts = static_cast<std::uint32_t>(samples_),
              .part_bytes = kSampleDepthBytes,
              .compressed_bytes = [this](std::size_t first, std::size_t elements) {
                return depth_bytes(first, elements);
              }}) {
  if (color_bytes == 0) return;
  color_.emplace(memory, "samples", order_,
                 TileSurface::Element{.parts = static_cast<std::uint32_t>(samples_),
                                      .part_bytes = color_bytes,
                                      .compressed_bytes = [this](std::size_t first, std::size_t elements) {
                                        return this->color_bytes(first, elements);
                                      }});
}

void SampleMemory::replay(const std::vector<SampleAccess>& accesses, bool write_depth, bool write_color,
                          StageCounters& counters) {
  if (!modelled_) return;
  write_color = write_color && color_;
  // What lies in one block is accessed at once. That changes no order between the surfaces: the cache of depth hears of
  // the next block after that of colour has heard of this one.
  for (std::size_t first = 0, end = 0; first < accesses.size(); first = end) {
    const auto at = [&](std::size_t from, bool reads, bool writes) {
      return [this, access = &accesses[from], reads, writes](std::size_t i) {
        return TileSurface::Access{access[i].triangle, cell_position_[access[i].cell], reads ? access[i].tested : 0,
                                   writes ? access[i].passed : 0};
      };
    };
    end = first + depth_.access_run(accesses.size() - first, at(first, true, write_depth), counters);
    for (std::size_t i = first, next = end; i < end; i = next) {
      if (write_color) next = i + color_->access_run(end - i, at(i, false, true), counters);
      for (std::size_t own_of = i; own_of < next; ++own_of) {
        const SampleAccess& access = accesses[own_of];
        own(std::size_t{cell_position_[access.cell]} * samples_, access.passed, access.triangle, owner_);
      }
    }
  }
}

// `first`: of the cell's samples. Branches on single samples would not be predicted.
void SampleMemory::own(std::size_t first, std::uint32_t samples, std::uint32_t triangle,
                       std::vector<std::uint32_t>& owner) const {
  std::uint32_t* const owners = owner.data() + first;
  for (std::size_t s = 0; s < samples_; ++s) owners[s] = (samples & kBit[s]) != 0 ? triangle : owners[s];
}

void SampleMemory::test_in_order(const std::vector<OrderedAccess>& accesses, StageCounters& counters) {
  if (!modelled_) return;
  for (const OrderedAccess& access : accesses) {
    const std::uint32_t position = cell_position_[access.cell];
    depth_.access_at(access.triangle, position, access.read, access.written, counters);
    own(std::size_t{position} * samples_, access.written, access.triangle, owner_);
  }
}

void SampleMemory::blend_in_order(const std::vector<OrderedAccess>& accesses, StageCounters& counters) {
  if (!modelled_ || !color_) return;
  color_owner_.resize(owner_.size(), kNoTriangle);
  for (const OrderedAccess& access : accesses) {
    const std::uint32_t position = cell_position_[access.cell];
    color_->access_at(access.triangle, position, access.read, access.written, counters);
    // What is blended with all samples of a cell leaves equal ones equal.
    if (access.read == 0 || !covers_cell(access.written))
      own(std::size_t{position} * samples_, access.written, access.triangle, color_owner_);
  }
}

void SampleMemory::test(const std::vector<SampleAccess>& accesses, StageCounters& counters) {
  if (!modelled_) return;
  for (const SampleAccess& access : accesses)
    depth_.access_at(access.triangle, cell_position_[access.cell], access.tested, 0, counters);
}

void SampleMemory::blend(const std::vector<SampleAccess>& accesses, StageCounters& counters) {
  if (!modelled_) return;
  for (const SampleAccess& access : accesses) {
    const std::uint32_t position = cell_position_[access.cell];
    depth_.access_at(access.triangle, position, access.tested, 0, counters);
    if (color_) color_->access_at(access.triangle, position, access.passed, access.passed, counters);
  }
}

void SampleMemory::flush(StageCounters& counters) {
  depth_.flush(counters);
  if (color_) color_->flush(counters);
  std::fill(owner_.begin(), owner_.end(), kNoTriangle);  // the next pass writes another, cleared surface
  std::fill(color_owner_.begin(), color_owner_.end(), kNoTriangle);
}

void SampleMemory::add_bytes(std::vector<float>& pixels) const {
  if (!modelled_) return;
  for (std::size_t cell = 0; cell < cell_position_.size(); ++cell) {
    const std::uint32_t position = cell_position_[cell];
    const std::uint32_t color = color_ ? color_->touched_bytes(position) : 0;
    pixels[cell / cells_] += static_cast<float>(depth_.touched_bytes(position) + color);
  }
}

// The planes of the block, and for each sample the number of its plane. "Cleared" counts as a plane of its own.
std::uint32_t SampleMemory::depth_bytes(std::size_t first, std::size_t elements) {
  const std::size_t begin = first * samples_, end = std::min((first + elements) * samples_, owner_.size());
  const std::size_t samples = elements * samples_, raw = samples * kSampleDepthBytes;
  if (end - begin == samples && owner_[begin] != kNoTriangle && all_show(&owner_[begin], samples, owner_[begin]))
    return std::min(plane_bytes_, static_cast<std::uint32_t>(raw));
  // What differs from the sample before, and of that what differs from all before.
  planes_.resize(samples);
  std::size_t changes = 0, planes = 0;
  std::uint32_t before = kNoTriangle;
  bool cleared = end - begin < samples;
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t owner = owner_[i];
    planes_[changes] = owner;
    changes += owner != before && owner != kNoTriangle;
    cleared |= owner == kNoTriangle;
    before = owner;
  }
  for (std::size_t i = 0; i < changes; ++i) {
    const std::uint32_t owner = planes_[i];
    bool known = false;
    for (std::size_t j = 0; j < planes; ++j) known |= planes_[j] == owner;
    planes_[planes] = owner;
    planes += !known;
  }
  if (planes * plane_bytes_ >= raw) return static_cast<std::uint32_t>(raw);
  const auto index_bits = static_cast<std::size_t>(std::bit_width(planes + cleared - 1));
  return static_cast<std::uint32_t>(planes * plane_bytes_ + (samples * index_bits + 7) / 8);
}

// One value per element, when the samples of each element of the block agree.
std::uint32_t SampleMemory::color_bytes(std::size_t first, std::size_t elements) const {
  const auto compressed = static_cast<std::uint32_t>(elements) * color_sample_bytes_;
  for (std::size_t element = first; element < std::min(first + elements, order_.positions); ++element) {
    const std::uint32_t* const owners = &(color_owner_.empty() ? owner_ : color_owner_)[element * samples_];
    if (all_show(owners, samples_, *owners)) continue;
    for (std::size_t sample = 1; sample < samples_; ++sample) {
      if (owners[sample] == owners[sample - 1]) continue;
      if (owners[sample] == kNoTriangle || owners[sample - 1] == kNoTriangle ||
          !same_value_(owners[sample], owners[sample - 1]))
        return compressed * static_cast<std::uint32_t>(samples_);
    }
  }
  return compressed;
}

}  // namespace beampipe

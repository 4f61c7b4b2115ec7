#include "stages/samples/sample_select.h"

#include <algorithm>
#include <bit>

#include "simd/match.h"
#include "stages/data/mix_bits.h"
#include "stages/samples/sample_select_cost.h"

namespace beampipe {
namespace {

constexpr std::size_t kSamples = 8;  // per pixel

// The tile's quads, and the samples of their pixels in the visibility buffer.
class QuadGrid {
 public:
  explicit QuadGrid(const Tile& tile) : tile_(tile), columns_((tile.width() + 1) / 2), rows_((tile.height() + 1) / 2) {}

  std::size_t count() const { return static_cast<std::size_t>(columns_ * rows_); }
  // Of a quad: its place in the frame, in quads.
  std::int32_t x(std::size_t quad) const { return tile_.x0 / 2 + static_cast<std::int32_t>(quad) % columns_; }
  std::int32_t y(std::size_t quad) const { return tile_.y0 / 2 + static_cast<std::int32_t>(quad) / columns_; }
  // Is pixel p of the quad inside the tile?
  bool has_pixel(std::size_t quad, int p) const { return pixel_x(quad, p) < tile_.x1 && pixel_y(quad, p) < tile_.y1; }
  // Index of the pixel's first sample.
  std::size_t first_sample(std::size_t quad, int p) const {
    return tile_.index(pixel_x(quad, p), pixel_y(quad, p)) * kSamples;
  }

 private:
  std::int32_t pixel_x(std::size_t quad, int p) const { return 2 * x(quad) + p % 2; }
  std::int32_t pixel_y(std::size_t quad, int p) const { return 2 * y(quad) + p / 2; }

  const Tile& tile_;
  std::int32_t columns_, rows_;
};

// A 32-bit hash, as hardware might have it. It gives the same numbers for the same seed and quad, whatever else is
// rendered.
class QuadRandom {
 public:
  QuadRandom(std::uint32_t seed, std::int32_t x, std::int32_t y, SelectWork& work)
      : work_(work),
        state_(mix_bits(mix_bits(mix_bits(seed) ^ static_cast<std::uint32_t>(x)) ^ static_cast<std::uint32_t>(y))) {}

  // The number of one of the bits that are set.
  int pick(std::uint32_t bits) {
    state_ = mix_bits(state_ + 0x9e3779b9u);
    const std::uint32_t skips = state_ % static_cast<std::uint32_t>(std::popcount(bits));
    ++work_.picks, work_.skips += skips;
    for (std::uint32_t skip = skips; skip > 0; --skip) bits &= bits - 1;
    return std::countr_zero(bits);
  }

 private:
  SelectWork& work_;
  std::uint32_t state_;
};

// The materials of a quad's samples, and which of the samples are inside the frame.
struct QuadMaterials {
  const std::uint32_t* ids;  // kQuadSamples
  std::uint32_t inside;
};

int materials_of(const QuadMaterials& quad) {
  int materials = 0;
  for (std::uint32_t left = quad.inside; left != 0; ++materials)
    left &= ~match_mask_scalar(quad.ids, quad.ids[std::countr_zero(left)]);
  return materials;
}

// Adds extra samples while there is room and a material has none. Returns the samples of the materials that still have
// none; `missing`: before.
std::uint32_t add_extras(const QuadMaterials& quad, std::uint32_t room, QuadRandom& random, std::uint32_t missing,
                         std::vector<ExtraSample>& extras, SelectWork& work) {
  while (missing != 0 && extras.size() < room) {
    const int location = random.pick(missing);
    const std::uint32_t mask = match_mask_scalar(quad.ids, quad.ids[location]) & quad.inside;
    extras.push_back({kNoTriangle, mask, static_cast<std::uint8_t>(location), {}});
    missing &= ~mask;
    ++work.extras;
  }
  return missing;
}

// Returns the shading samples whose material has another shading sample, as bits.
std::uint32_t to_spare(const std::uint32_t masks[4]) {
  std::uint32_t slots = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) slots |= std::uint32_t{i != j && masks[i] != 0 && masks[i] == masks[j]} << i;
  return slots;
}

// Switches shading samples until every material has one or no shading sample can be spared. masks[i]: the samples of
// shading sample i's material.
void switch_samples(const QuadMaterials& quad, QuadRandom& random, std::uint32_t missing, std::uint32_t masks[4],
                    std::uint8_t locations[4], SelectWork& work) {
  while (missing != 0) {
    ++work.searches;
    const std::uint32_t spare = to_spare(masks);
    if (spare == 0) break;
    const int slot = random.pick(spare), location = random.pick(missing);
    locations[slot] = static_cast<std::uint8_t>(location);
    masks[slot] = match_mask_scalar(quad.ids, quad.ids[location]) & quad.inside;
    missing &= ~masks[slot];
    ++work.switched;
  }
}

// Gives each visibility sample to one of its material's shading samples.
void share_out(QuadRandom& random, const std::uint32_t masks[4], const std::uint8_t locations[4], SampleQuad& quad,
               SelectWork& work) {
  for (int i = 0; i < 4; ++i) {
    std::uint32_t same = 0;
    for (int j = 0; j < 4; ++j) same |= std::uint32_t{masks[i] != 0 && masks[i] == masks[j]} << j;
    if (same == 0 || std::countr_zero(same) != i) continue;  // no mask, or not the first of its material
    ++work.groups;
    for (int pixel = 0; pixel < 4; ++pixel) {
      std::uint32_t here = same;
      for (int j = 0; j < 4; ++j)
        if (locations[j] / 8 != pixel) here &= ~(1u << j);
      const std::uint32_t candidates = here != 0 ? here : same;
      const bool one = std::has_single_bit(candidates);
      for (std::uint32_t bits = masks[i] & 0xffu << 8 * pixel; bits != 0; bits &= bits - 1) {
        quad.mask[one ? std::countr_zero(candidates) : random.pick(candidates)] |= bits & (~bits + 1);
        ++work.given, work.given_once += one;
      }
    }
  }
}

// What the selection of all quads starts with.
struct Start {
  std::vector<std::uint32_t> inside;    // per quad: the samples inside the frame
  std::vector<std::uint32_t> ids;       // the materials of the samples, kQuadSamples per quad
  std::vector<std::uint32_t> masks;     // per shading sample, four per quad: the samples of its material
  std::vector<std::uint8_t> locations;  // likewise: the sample where it is shaded
};

Start start(const QuadGrid& grid, const SampleTile& surface, const std::vector<std::uint32_t>& materials,
            std::uint32_t jitter) {
  const std::size_t count = grid.count();
  Start all{std::vector<std::uint32_t>(count), std::vector<std::uint32_t>(count * kQuadSamples, kNoTriangle),
            std::vector<std::uint32_t>(4 * count), std::vector<std::uint8_t>(4 * count)};
  for (std::size_t q = 0; q < count; ++q) {
    for (int p = 0; p < 4; ++p) {
      all.locations[4 * q + static_cast<std::size_t>(p)] =
          static_cast<std::uint8_t>(8u * static_cast<unsigned>(p) + jitter);
      if (!grid.has_pixel(q, p)) continue;
      all.inside[q] |= 0xffu << 8 * p;
      const std::uint32_t* const triangle = surface.triangle.data() + grid.first_sample(q, p);
      std::uint32_t* const id = all.ids.data() + kQuadSamples * q + kSamples * static_cast<std::size_t>(p);
      for (std::size_t s = 0; s < kSamples; ++s)
        id[s] = triangle[s] == kNoTriangle ? kNoTriangle : materials[triangle[s]];
    }
  }
  match_masks(all.ids.data(), all.locations.data(), count, all.masks.data());
  for (std::size_t i = 0; i < 4 * count; ++i)
    all.masks[i] &= all.inside[i / 4] >> 8 * (i % 4) & 1 ? all.inside[i / 4] : 0;
  return all;
}

}  // namespace

std::vector<SampleQuad> sample_select(const SampleTile& surface, const Tile& tile,
                                      const std::vector<std::uint32_t>& materials, const SelectOptions& options,
                                      StageCounters& counters) {
  const QuadGrid grid(tile);
  Start all = start(grid, surface, materials, options.jitter);
  std::vector<SampleQuad> quads(grid.count());
  SelectWork work;
  for (std::size_t q = 0; q < grid.count(); ++q) {
    QuadRandom random(options.seed, grid.x(q), grid.y(q), work);
    std::uint32_t* const masks = all.masks.data() + 4 * q;
    std::uint8_t* const locations = all.locations.data() + 4 * q;
    const QuadMaterials quad{all.ids.data() + kQuadSamples * q, all.inside[q]};
    quads[q].materials = static_cast<std::uint8_t>(materials_of(quad));
    quads[q].pixels = static_cast<std::uint8_t>(std::popcount(quad.inside) / static_cast<int>(kSamples));
    const std::uint32_t missing = add_extras(
        quad, options.room, random, quad.inside & ~(masks[0] | masks[1] | masks[2] | masks[3]), quads[q].extras, work);
    switch_samples(quad, random, missing, masks, locations, work);
    share_out(random, masks, locations, quads[q], work);
    const auto triangle_at = [&](std::uint8_t location) {
      return surface.triangle[grid.first_sample(q, location / 8) + location % kSamples];
    };
    for (int p = 0; p < 4; ++p) {
      quads[q].location[p] = locations[p];
      quads[q].triangle[p] = masks[p] == 0 ? kNoTriangle : triangle_at(locations[p]);
      work.stored += masks[p] != 0;
    }
    for (ExtraSample& extra : quads[q].extras) extra.triangle = triangle_at(extra.location);
    work.ends += quads[q].extras.size() < options.room;
  }
  work.pixels = tile.pixels();
  work.quads = grid.count();
  work.shaded = shaded_samples(quads);
  charge(work, counters);
  return quads;
}

std::vector<std::uint32_t> triangles_of(const std::vector<SampleQuad>& quads) {
  std::vector<std::uint32_t> triangles;
  triangles.reserve(4 * quads.size());
  for (const SampleQuad& quad : quads) triangles.insert(triangles.end(), quad.triangle, quad.triangle + 4);
  for (const auto& [quad, extra] : extras_of(quads)) triangles.push_back(extra->triangle);
  return triangles;
}

std::uint64_t shaded_samples(const std::vector<SampleQuad>& quads) {
  std::uint64_t samples = 0;
  for (const std::uint32_t triangle : triangles_of(quads)) samples += triangle != kNoTriangle;
  return samples;
}

}  // namespace beampipe

#include "stages/samples/sample_select.h"

#include <algorithm>
#include <bit>

#include "stages/cost/counting.h"
#include "stages/samples/mix_bits.h"

namespace beampipe {
namespace {

// What was done, for the counters.
struct SelectWork {
  std::uint64_t picks = 0, skips = 0;  // one of several at random; bits before it
  std::uint64_t searches = 0;          // for a shading sample to spare
  std::uint64_t switched = 0;
  std::uint64_t groups = 0;                 // of shading samples of one material
  std::uint64_t given = 0, given_once = 0;  // visibility samples; those that had one shading sample to go to
};

// A 32-bit hash as hardware would have it; the same for the same seed and quad, whatever else is rendered.
class QuadRandom {
 public:
  QuadRandom(std::uint32_t seed, std::int32_t x, std::int32_t y, SelectWork& work)
      : work_(work),
        state_(mix_bits(mix_bits(mix_bits(seed) ^ static_cast<std::uint32_t>(x)) ^ static_cast<std::uint32_t>(y))) {}

  // One of the bits that are set.
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

// The samples' materials, and which of them are inside the frame.
struct QuadMaterials {
  std::uint32_t ids[kQuadSamples];
  std::uint32_t inside;
};

// Shading samples whose material has another one.
std::uint32_t to_spare(const std::uint32_t masks[4]) {
  std::uint32_t slots = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) slots |= std::uint32_t{i != j && masks[i] != 0 && masks[i] == masks[j]} << i;
  return slots;
}

// Switches shading samples until every material has one or none is to spare.
void switch_samples(const QuadMaterials& quad, QuadRandom& random, std::uint32_t masks[4], std::uint8_t locations[4],
                    SelectWork& work) {
  std::uint32_t missing = quad.inside & ~(masks[0] | masks[1] | masks[2] | masks[3]);
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
    if (same == 0 || std::countr_zero(same) != i) continue;  // nothing, or done with the first of them
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

OperationCounts match_cost() {
  return count_operations([](OperationCounts& counts) {
    Counted<std::uint32_t> ids[kQuadSamples];
    for (auto& id : ids) id = Counted<std::uint32_t>(0, counts);
    match_mask_scalar(ids, ids[0]);
    counts.bit += kQuadSamples;  // gathering the comparisons into a mask
  });
}

using CountedBits = Counted<std::uint32_t>;

// The quad's random state; its samples inside the frame, and those whose material has no shading sample; which shading
// samples are of one material, four by four, and whether each is the first of them.
OperationCounts quad_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedBits x(1, counts);
    mix_bits(mix_bits(mix_bits(x) ^ x) ^ x);
    for (int p = 0; p < 4; ++p) x& x;
    x & ~(x | x | x | x);
    counts += OperationCounts{.add = 4 * (4 * 2 + 1), .bit = 4 * (4 + 1)};
  });
}

OperationCounts pick_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedBits x(1, counts);
    mix_bits(x + x) % x;
    counts.bit += 2;  // how many bits there are, and the number of the one
  });
}

// For each pixel: of four shading samples, is it there; else any of them, is it the only one; the material's samples.
OperationCounts group_cost() { return OperationCounts{.add = 4 * (4 + 1), .bit = 4 * (4 * 2 + 2)}; }

}  // namespace

std::vector<SampleQuad> sample_select(const SampleTile& surface, const Tile& tile,
                                      const std::vector<std::uint32_t>& materials, const SelectOptions& options,
                                      StageCounters& counters) {
  const std::int32_t columns = (tile.width() + 1) / 2, rows = (tile.height() + 1) / 2;
  const auto count = static_cast<std::size_t>(columns * rows);
  std::vector<QuadMaterials> found(count);
  std::vector<SampleQuad> quads(count);
  std::vector<std::uint32_t> ids(count * kQuadSamples, kNoTriangle), masks(4 * count);
  std::vector<std::uint8_t> locations(4 * count);
  const auto first_sample = [&](std::size_t quad, int p) {  // of pixel p; past the surface's end when outside
    const auto x = 2 * (static_cast<std::int32_t>(quad) % columns) + p % 2,
               y = 2 * (static_cast<std::int32_t>(quad) / columns) + p / 2;
    return x < tile.width() && y < tile.height() ? static_cast<std::size_t>(y * tile.width() + x) * 8
                                                 : tile.pixels() * 8;
  };
  for (std::size_t q = 0; q < count; ++q) {
    found[q].inside = 0;
    for (int p = 0; p < 4; ++p) {
      locations[4 * q + static_cast<std::size_t>(p)] =
          static_cast<std::uint8_t>(8u * static_cast<unsigned>(p) + options.jitter);
      const std::size_t at = first_sample(q, p);
      if (at == tile.pixels() * 8) continue;
      found[q].inside |= 0xffu << 8 * p;
      for (std::size_t s = 0; s < 8; ++s) {
        const std::uint32_t triangle = surface.triangle[at + s];
        ids[kQuadSamples * q + 8 * static_cast<std::size_t>(p) + s] =
            triangle == kNoTriangle ? kNoTriangle : materials[triangle];
      }
    }
    std::copy_n(ids.data() + kQuadSamples * q, kQuadSamples, found[q].ids);
  }
  match_masks(ids.data(), locations.data(), count, masks.data());

  std::uint64_t stored = 0;
  SelectWork work;
  for (std::size_t q = 0; q < count; ++q) {
    QuadRandom random(options.seed, tile.x0 / 2 + static_cast<std::int32_t>(q) % columns,
                      tile.y0 / 2 + static_cast<std::int32_t>(q) / columns, work);
    std::uint32_t* const of_quad = masks.data() + 4 * q;
    std::uint8_t* const where = locations.data() + 4 * q;
    for (int p = 0; p < 4; ++p) of_quad[p] &= found[q].inside >> 8 * p & 1 ? found[q].inside : 0;
    switch_samples(found[q], random, of_quad, where, work);
    share_out(random, of_quad, where, quads[q], work);
    for (int p = 0; p < 4; ++p) {
      quads[q].location[p] = where[p];
      quads[q].triangle[p] =
          of_quad[p] == 0 ? kNoTriangle : surface.triangle[first_sample(q, where[p] / 8) + where[p] % 8u];
      stored += of_quad[p] != 0;
    }
  }

  counters.items_in += tile.pixels() * 8;
  counters.items_out += stored;
  counters.ops += match_cost() * (4 * count + work.switched);
  counters.ops += quad_cost() * count;
  counters.ops += OperationCounts{.add = 24, .bit = 12} * work.searches;  // 12 pairs: there, equal; noted
  counters.ops += OperationCounts{.bit = 3} * work.switched;              // within the frame; no longer missing
  counters.ops += pick_cost() * work.picks;
  counters.ops += OperationCounts{.add = 1, .bit = 1} * work.skips;
  counters.ops += group_cost() * work.groups;
  counters.ops += OperationCounts{.add = 2, .bit = 4} * work.given;  // the lowest bit, into its mask, off the list
  counters.ops += OperationCounts{.bit = 1} * work.given_once;       // whose number that is
  counters.bytes_read += tile.pixels() * 8 * 4;
  counters.bytes_written += stored * kShadingSampleBytes;
  counters.lanes_used += shaded_samples(quads);
  counters.lanes_issued += 4 * count;
  return quads;
}

std::uint64_t shaded_samples(const std::vector<SampleQuad>& quads) {
  std::uint64_t samples = 0;
  for (const SampleQuad& quad : quads)
    for (const std::uint32_t triangle : quad.triangle) samples += triangle != kNoTriangle;
  return samples;
}

}  // namespace beampipe

// The scalar twins of compose by the published rules and of compose_z3: one fragment after the other is added to its
// pixel.

#include "simd/plane_order.h"
#include "stages/beam/casav_fragment.h"
#include "stages/beam/compose_z3.h"
#include "tests/simd/merge_cases.h"
#include "tests/stages/beam_pixels.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::merge_twins_test {

using namespace twins;

class MergeTwins : public SceneTwins {
 protected:
  void make_fragments(const BeamFragmentOptions& options) {
    StageCounters ignored;
    fragments_ = fragments_of(triangles_, tile_, options);
    shade(shade_triangles(triangles_, trace_.frames[0].lighting), fragments_, ignored);
  }
  void make_casav_fragments() {
    const SamplePattern pattern = hammersley_pattern();
    const MaskTable table(pattern);
    BeamFragmentOptions options;
    options.positions = {pattern};
    options.table = &table;
    options.tiny_positions = 1;
    make_fragments(options);
    StageCounters ignored;
    buffer_ = a_buffer(sort_records(fragments_, SortKey::centroid), tile_.pixels(), 42, 42, ignored);
  }

  AggregateOf<Float, Bits> counting(const Aggregate& a) {
    return {.alpha = real(a.alpha),
            .mask = bits(a.mask),
            .plane = {real(a.plane.z), real(a.plane.dzdu), real(a.plane.dzdv)},
            .thickness = real(a.thickness),
            .z_min = real(a.z_min),
            .z_max = real(a.z_max),
            .color = {real(a.color[0]), real(a.color[1]), real(a.color[2])}};
  }
  FragmentOf<Float, Bits> counting(const Fragment& fragment) {
    const MergeFragment in = merge_fragment(fragment);
    return {counting(in.surface), bits(in.tiny), bits(in.front)};
  }
  static Aggregate value_of(const AggregateOf<Float, Bits>& a) {
    return {.alpha = a.alpha.value,
            .mask = a.mask.value,
            .plane = {a.plane.z.value, a.plane.dzdu.value, a.plane.dzdv.value},
            .thickness = a.thickness.value,
            .z_min = a.z_min.value,
            .z_max = a.z_max.value,
            .color = {a.color[0].value, a.color[1].value, a.color[2].value}};
  }

  // The numbers of an aggregate that each merge converts from the stored formats and back.
  static void convert(AggregateOf<Float, Bits>& a, CasavStorage storage) {
    for (Float& channel : a.color) channel = converted(channel);
    if (storage == CasavStorage::text)
      for (Float* const number : {&a.plane.dzdu, &a.plane.dzdv, &a.thickness}) *number = converted(*number);
  }

  // `merged`: takes a fragment and the old aggregate and returns the new aggregate as it is stored.
  template <class Merged>
  std::vector<Aggregate> merge_all(Merged&& merged) {
    std::vector<Aggregate> pixels(tile_.pixels(), kEmptyAggregate);
    twin_ = {};
    for (std::size_t pixel = 0; pixel < tile_.pixels(); ++pixel)
      for (std::uint32_t i = buffer_.first[pixel]; i < buffer_.first[pixel + 1]; ++i)
        pixels[pixel] = merged(fragments_[buffer_.records[i]], pixels[pixel]);
    return pixels;
  }

  static void expect_same(const std::vector<Aggregate>& found, const std::vector<Aggregate>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].mask, expected[i].mask) << i;
      ASSERT_EQ(numbers_of(found[i]), numbers_of(expected[i])) << i;
    }
  }

  template <class Stored>
  void compose_into(CasavStorage storage, const MergeRules& rules = {}) {
    const MergePositions positions(hammersley_pattern());
    std::uint64_t position_tests = 0;
    const std::vector<Aggregate> expected = merge_all([&](const Fragment& fragment, const Aggregate& before) {
      AggregateOf<Float, Bits> old = counting(before);
      convert(old, storage);
      MergeStepsOf<Bits> steps{};
      AggregateOf<Float, Bits> merged = merge_formula(counting(fragment), old, positions, rules, steps);
      convert(merged, storage);
      // A look-up is a word of 32 positions.
      position_tests += 32 * (steps.front_line.value + steps.back_line.value);
      for (const Bits& mask : {steps.tested, steps.reached, steps.moved})
        position_tests += static_cast<std::uint64_t>(std::popcount(mask.value));
      return Aggregate(Stored(value_of(merged)));
    });
    StageCounters counters;
    expect_same(compose(fragments_, buffer_, {positions, rules, storage}, counters), expected);
    EXPECT_EQ(counters.ops, twin_);
    EXPECT_EQ(counters.position_tests, position_tests);
    EXPECT_EQ(counters.lanes_used, fragments_.size());
    EXPECT_EQ(counters.lanes_issued, fragments_.size());
  }

  std::vector<Fragment> fragments_;
  ABuffer buffer_;
};

TEST_P(MergeTwins, Compose) {
  make_casav_fragments();
  compose_into<SlidesAggregate>(CasavStorage::slides);
  compose_into<TextAggregate>(CasavStorage::text);
  for (const MergeRules& rules : every_merge_rule())
    if (rules.partition != MergeRules::Partition::given) compose_into<SlidesAggregate>(CasavStorage::slides, rules);
}

TEST_P(MergeTwins, Over) {
  make_casav_fragments();
  const std::vector<Aggregate> expected = merge_all([&](const Fragment& fragment, const Aggregate& before) {
    AggregateOf<Float, Bits> old = counting(before);
    convert(old, CasavStorage::slides);
    AggregateOf<Float, Bits> merged = over_formula(counting(fragment), old);
    convert(merged, CasavStorage::slides);
    return Aggregate(SlidesAggregate(value_of(merged)));
  });
  StageCounters counters;
  expect_same(compose_over(fragments_, buffer_, counters), expected);
  EXPECT_EQ(counters.ops, twin_);
}

// ---- Z3 ----

struct CountedLayer {
  Float z, dzdu, dzdv;
  Float color[3];
  std::vector<Bits> mask;

  bool empty() const {
    return std::all_of(mask.begin(), mask.end(), [](const Bits& word) { return word.value == 0; });
  }
};

template <std::size_t Words>
class Z3Twin {
 public:
  using Pixel = Z3Pixel<Words>;

  Z3Twin(const PositionSet& positions, OperationCounts& counts) : positions_(positions), counts_(counts) {}

  // Returns whether two layers were merged.
  bool add(const Fragment& fragment, Pixel& pixel) {
    CountedLayer arriving = arriving_layer(fragment);
    std::vector<CountedLayer> layers;
    for (std::uint32_t k = 0; k < kZ3Layers; ++k) {
      CountedLayer layer = loaded(pixel, k);
      std::vector<Bits> contested;
      for (std::size_t w = 0; w < Words; ++w) contested.push_back(layer.mask[w] & bits(fragment.mask.words[w]));
      const std::vector<Bits> nearer = positions_won(arriving, layer, contested);
      for (std::size_t w = 0; w < Words; ++w) {
        arriving.mask[w] = arriving.mask[w] & ~(contested[w] & ~nearer[w]);
        layer.mask[w] = layer.mask[w] & ~(contested[w] & nearer[w]);
      }
      if (!layer.empty()) layers.push_back(layer);
    }
    if (arriving.empty()) return false;
    layers.push_back(arriving);
    const bool one_too_many = layers.size() > kZ3Layers;
    if (one_too_many) merge_two(layers);
    for (std::uint32_t k = 0; k < kZ3Layers; ++k) store(k < layers.size() ? &layers[k] : nullptr, k, pixel);
    return one_too_many;
  }

 private:
  Float real(float value) { return Float(value, counts_); }
  Bits bits(std::uint32_t word) { return Bits(word, counts_); }

  // Its colour is fp16 and not multiplied by alpha. Its slopes are rounded like those that they are compared with.
  CountedLayer arriving_layer(const Fragment& fragment) {
    const auto slope = [&](float value) { return converted(converted(real(UpperHalf(value)))); };
    CountedLayer layer{real(fragment.plane.z), slope(fragment.plane.dzdu), slope(fragment.plane.dzdv), {}, {}};
    for (int c = 0; c < 3; ++c) layer.color[c] = converted(real(HalfBits(fragment.color[c] / fragment.alpha)));
    for (std::size_t w = 0; w < Words; ++w) layer.mask.push_back(bits(fragment.mask.words[w]));
    return layer;
  }

  CountedLayer loaded(const Pixel& pixel, std::uint32_t k) {
    const Z3Layer& stored = pixel.layers[k];
    CountedLayer layer{real(stored.z), converted(real(stored.slopes[0])), converted(real(stored.slopes[1])), {}, {}};
    for (int c = 0; c < 3; ++c) layer.color[c] = converted(real(stored.color[c]));
    for (std::size_t w = 0; w < Words; ++w) {
      std::array<Bits, kZ3Planes> planes;
      for (std::size_t b = 0; b < planes.size(); ++b) planes[b] = bits(pixel.owners.planes[b][w]);
      layer.mask.push_back(word_in_state(planes, k + 1));
    }
    return layer;
  }

  void store(const CountedLayer* layer, std::uint32_t k, Pixel& pixel) {
    for (int number = 0; number < 2 + 3; ++number) converted(real(0));
    for (std::size_t w = 0; w < Words; ++w)
      for (std::size_t b = 0; b < kZ3Planes; ++b)
        pixel.owners.planes[b][w] =
            word_put(bits(pixel.owners.planes[b][w]), layer ? layer->mask[w] : bits(0), (k + 1) >> b & 1).value;
    if (!layer) return;
    pixel.layers[k].z = layer->z.value;
    pixel.layers[k].slopes[0] = UpperHalf(layer->dzdu.value), pixel.layers[k].slopes[1] = UpperHalf(layer->dzdv.value);
    for (int c = 0; c < 3; ++c) pixel.layers[k].color[c] = HalfBits(layer->color[c].value);
  }

  // The positions where the first layer is nearer. They are only computed if a position is contested.
  std::vector<Bits> positions_won(const CountedLayer& a, const CountedLayer& b, const std::vector<Bits>& contested) {
    std::vector<Bits> nearer(Words, bits(0));
    if (std::all_of(contested.begin(), contested.end(), [](const Bits& word) { return word.value == 0; }))
      return nearer;
    for (std::size_t w = 0; w < Words; ++w)
      for (std::size_t s = 0; s < 32; ++s)
        nearer[w].value |= std::uint32_t{nearer_formula<Float>({a.z, a.dzdu, a.dzdv}, {b.z, b.dzdu, b.dzdv},
                                                               real(position_u(positions_.patterns[w], s)),
                                                               real(position_v(positions_.patterns[w], s)))}
                           << s;
    return nearer;
  }

  Float count(const CountedLayer& layer) {
    Float sum = bit_count(layer.mask[0]);
    for (std::size_t w = 1; w < Words; ++w) sum = sum + bit_count(layer.mask[w]);
    return sum;
  }

  void merge_two(std::vector<CountedLayer>& layers) {
    std::size_t first = 0, second = 1;
    float least = INFINITY;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      for (std::size_t j = i + 1; j < layers.size(); ++j) {
        const Float distance = magnitude(layers[i].z - layers[j].z);
        if (distance < real(least)) least = distance.value, first = i, second = j;
      }
    }
    CountedLayer &a = layers[first], &b = layers[second];
    const Float in_a = count(a), in_b = count(b);
    const Float share = in_a / (in_a + in_b), rest = Float(1.0f) - share;
    const auto mean = [&](const Float& x, const Float& y) { return share * x + rest * y; };
    a.z = mean(a.z, b.z), a.dzdu = mean(a.dzdu, b.dzdu), a.dzdv = mean(a.dzdv, b.dzdv);
    for (int c = 0; c < 3; ++c) a.color[c] = mean(a.color[c], b.color[c]);
    for (std::size_t w = 0; w < Words; ++w) a.mask[w] = a.mask[w] | b.mask[w];
    std::swap(b, layers.back());
    layers.pop_back();
  }

  const PositionSet& positions_;
  OperationCounts& counts_;
};

TEST_P(MergeTwins, ComposeZ3) {
  const auto compare = [&]<std::size_t Words>(Z3Pixel<Words>) {
    const PositionGrid grid(32 * Words);
    const PositionSet positions(cell_patterns(32 * Words));
    make_fragments(grid_options(grid, 0));
    std::vector<Z3Pixel<Words>> pixels(tile_.pixels()), twins = pixels;
    std::vector<float> merges(tile_.pixels()), twin_merges = merges;
    StageCounters counters;
    compose_z3(fragments_, positions, counters, pixels, merges);
    twin_ = {};
    Z3Twin<Words> twin(positions, twin_);
    for (const Fragment& fragment : fragments_)
      twin_merges[fragment.pixel] += twin.add(fragment, twins[fragment.pixel]) ? 1.0f : 0.0f;
    EXPECT_EQ(counters.ops, twin_);
    EXPECT_EQ(merges, twin_merges);
    const std::vector<PixelColor> found = z3_colors(pixels), expected = z3_colors(twins);
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].alpha, expected[i].alpha) << i;
      ASSERT_EQ(found[i].color, expected[i].color) << i;
      for (std::size_t k = 0; k < kZ3Layers; ++k)
        ASSERT_EQ(+pixels[i].layers[k].z, +twins[i].layers[k].z) << i;  // packed
    }
  };
  compare(Z3Pixel<1>());
  compare(Z3Pixel<4>());
}

BEAMPIPE_ON_EVERY_SCENE(MergeTwins);

}  // namespace beampipe::merge_twins_test

// The history of a pixel is the pixel: its weights times its colours are the bits of the picture, but for what formats
// change.

#include "pipeline/technique_table.h"
#include "stages/geometry/draw_plan.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/test.h"
#include "traces/scenes.h"

namespace beampipe::inspect_test {

struct Tolerance {
  double most_rest;     // of a channel: what formats and limits may change; colours are about 1
  double weight_error;  // of the sum of all weights
};

// By what a technique says that it errs by. fp16 has 11 bits, and `alpha` rounds to it after each fragment. Owners that
// become one keep 9 bits of their colour, and z3 rounds it at each merge. The limits of beam move a channel by up to 3
// positions. Samples are added up in double precision, so opaque triangles leave no rest. Layers over the picture are
// added in single precision.
Tolerance tolerance_of(const Technique& technique) {
  const auto errs_by = [&](ErrorSource source) { return std::ranges::count(technique.errs_by, source) > 0; };
  const bool sums_up_samples = !technique.sampled_at.empty() && !errs_by(ErrorSource::merges_of_layers) &&
                               !errs_by(ErrorSource::sums_in_fp16) && !errs_by(ErrorSource::sums_in_unorm8);
  if (sums_up_samples) return {0, errs_by(ErrorSource::gbuffer_of_8_bits) ? 1e-6 : 1e-12};
  const double rounding = std::max(errs_by(ErrorSource::estimated_areas) ? 2e-3 : 4e-3, technique.rounding_error);
  if (errs_by(ErrorSource::double_counting)) return {rounding, 10};
  if (errs_by(ErrorSource::sums_in_unorm8)) return {rounding, rounding};
  if (errs_by(ErrorSource::merges_of_layers)) return {rounding, 1e-6};
  return {technique.counted_positions > 0 ? 3.0 / technique.counted_positions : rounding, 1e-4};
}

float error_at(const Image& image, const Image& reference, std::size_t pixel) {
  float error = 0;
  for (std::size_t c = 0; c < 3; ++c) error += std::abs(image.rgba[4 * pixel + c] - reference.rgba[4 * pixel + c]);
  return error;
}

// The ten pixels that are farthest from the reference, and ten others.
std::vector<PixelAddress> chosen_pixels(const Image& image, const Image& reference, unsigned seed) {
  std::vector<std::size_t> pixels(std::size_t{image.width} * image.height);
  std::iota(pixels.begin(), pixels.end(), 0);
  std::stable_sort(pixels.begin(), pixels.end(), [&](std::size_t a, std::size_t b) {
    return error_at(image, reference, a) > error_at(image, reference, b);
  });
  std::mt19937 random(seed);
  std::shuffle(pixels.begin() + 10, pixels.end(), random);
  std::vector<PixelAddress> chosen;
  for (std::size_t i = 0; i < 20; ++i)
    chosen.push_back(
        {static_cast<std::uint32_t>(pixels[i] % image.width), static_cast<std::uint32_t>(pixels[i] / image.width)});
  return chosen;
}

void expect_the_picture(const PixelHistory& history, const Image& image, const Tolerance& tolerance) {
  const float* rgba = image.rgba.data() + 4 * (std::size_t{history.at.y} * image.width + history.at.x);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(history.pixel[c], rgba[c]) << "channel " << c;
  const glm::dvec3 sum = history.sum(), rest = history.rest();
  double weights = 0;
  for (const HistoryTerm& term : history.terms) weights += term.weight;
  EXPECT_NEAR(weights, 1.0, tolerance.weight_error);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(static_cast<float>(sum[c] + rest[c]), rgba[c]) << "channel " << c;
    EXPECT_LE(std::abs(rest[c]), tolerance.most_rest * std::max(1.0, sum[c])) << "channel " << c << " of " << sum[c];
  }
}

// What `--causes` is told of the pixel is what its history says.
void expect_the_weights(const PixelHistory& history, const PixelWeights& weights) {
  std::map<std::uint32_t, double> told, found;
  for (const SurfaceWeight& each : weights) told[each.triangle] += each.weight;
  for (const HistoryTerm& term : history.terms)
    if (term.fragment != kNobody) found[history.fragments[term.fragment].triangle] += term.weight;
  for (const auto& [triangle, weight] : told) EXPECT_NEAR(found[triangle], weight, 1e-6) << triangle;
  for (const auto& [triangle, weight] : found) EXPECT_NEAR(told[triangle], weight, 1e-6) << triangle;
}

// What a fragment covers, it owns in the end, or someone else has it.
void expect_consistent(const PixelHistory& history) {
  std::vector<std::uint32_t> owned(history.fragments.size());
  for (const std::uint32_t owner : history.owners)
    if (owner != kNobody) ++owned[owner];
  for (std::size_t i = 0; i < history.fragments.size(); ++i) {
    const HistoryFragment& each = history.fragments[i];
    if (each.fate != Fate::owner && each.fate != Fate::hidden && each.fate != Fate::closed_off) continue;
    const bool is_composed = std::any_of(history.fragments.begin(), history.fragments.end(),
                                         [](const auto& other) { return other.fate == Fate::composed; });
    if (is_composed) continue;  // without owners
    const auto covered = static_cast<std::uint32_t>(std::count(each.mask.begin(), each.mask.end(), true));
    std::uint32_t lost = 0;
    for (const PositionMove& move : each.lost) lost += move.positions;
    EXPECT_EQ(owned[i] + lost, covered) << "fragment " << i;
  }
}

constexpr double kBlending = 2e-7;  // what blending in single precision may leave

// `most_more`: rest beyond that of the technique.
void inspect(const Trace& trace, const std::string& name, unsigned seed, double most_more = 0) {
  const TextureSet textures(trace, name);
  FrameInput run;
  run.memory.modelled = false;
  run.textures = &textures;
  const Image reference = parse_technique("reference").render(trace, 0, run).image;
  std::vector<std::string> specs = example_specs();
  specs.push_back("acaa:64,double=stencil,color=fp32");
  for (const std::string& spec : specs) {
    const Technique technique = parse_technique(spec);
    if (!technique.is_observable) continue;
    Tolerance tolerance = tolerance_of(technique);
    if (spec.find("double=saturate") != std::string::npos) tolerance.weight_error = 1e-4;  // sums stop at 1
    if (spec.find("color=fp32") != std::string::npos) tolerance = {1e-5, 1e-4};
    tolerance.most_rest += most_more;
    std::vector<PixelWeights> weights;
    const FrameSinks sinks{.weights = technique.has_weights ? &weights : nullptr};
    const Image image = technique.render(trace, 0, run, sinks).image;
    const std::vector<PixelAddress> pixels = chosen_pixels(image, reference, seed);
    std::vector<PixelHistory> histories;
    FrameInput observed = run;
    observed.pixels = &pixels;
    technique.render(trace, 0, observed, {.histories = &histories});
    ASSERT_EQ(histories.size(), pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      SCOPED_TRACE(name + ", " + spec + ", pixel " + std::to_string(pixels[i].x) + "," + std::to_string(pixels[i].y));
      EXPECT_EQ(histories[i].at, pixels[i]);
      expect_the_picture(histories[i], image, tolerance);
      expect_consistent(histories[i]);
      if (technique.has_weights)
        expect_the_weights(histories[i], weights[std::size_t{pixels[i].y} * image.width + pixels[i].x]);
    }
  }
}

// One bin of 8 x 8 pixels has triangles, the other one has none.
TEST(Inspect, PixelsWithoutTrianglesHaveTheirSamples) {
  Trace trace = pixel_trace(16, 8, quad(1, 1, 7, 7, 0.5, glm::vec3(1)));
  const std::vector<PixelAddress> at = {{4, 4}, {12, 4}};
  for (const bool in_order : {false, true}) {
    if (in_order) trace.frames[0].draws[0].state.stencil = Stencil{.function = Compare::equal};
    ASSERT_EQ(needs_api_order(trace, trace.frames[0]), in_order);
    FrameInput run{1};
    run.tile_size = 8, run.pixels = &at;
    std::vector<PixelHistory> histories;
    parse_technique("msaa:8").render(trace, 0, run, {.histories = &histories});
    ASSERT_EQ(histories.size(), at.size());
    for (const PixelHistory& history : histories) EXPECT_EQ(history.positions.size(), 8u) << in_order;
  }
}

Trace scene(const std::string& name, std::uint32_t triangles) {
  return make_scene(name, {.triangles = triangles, .width = 41, .height = 23});
}

TEST(Inspect, AFenceIsItsPictureToTheBit) { inspect(scene("fence", 20000), "fence", 1); }
TEST(Inspect, ASoupIsItsPictureToTheBit) { inspect(scene("soup", 5000), "soup", 2); }
TEST(Inspect, CutoutsAreTheirPictureToTheBit) { inspect(scene("leaves", 2000), "leaves", 3); }
TEST(Inspect, SheetsAreTheirPictureToTheBit) { inspect(scene("sheets", 200), "sheets", 4, kBlending); }
TEST(Inspect, RandomSurfacesAreTheirPictureToTheBit) {
  inspect(random_surfaces(45, 31, 150, 3), "surfaces", 5, kBlending);
}

}  // namespace beampipe::inspect_test

// Compares techniques with exact arithmetic in the hard cases, and exact arithmetic with closed forms.

#include <numbers>

#include "pipeline/technique_table.h"
#include "simd/sample_pattern.h"
#include "tests/pipeline/test_traces.h"
#include "tests/traces/test_folder.h"
#include "tools/stress/case_parts.h"
#include "tools/stress/exact.h"
#include "tools/stress/judge.h"

namespace beampipe::stress_test {

constexpr glm::vec3 kWhite(1.0f);

void expect_pixel(const glm::dvec4& found, const glm::dvec4& expected) {
  for (int c = 0; c < 4; ++c) EXPECT_DOUBLE_EQ(found[c], expected[c]);
}

TEST(Exact, AreasOfHalfAndOfCrossingTriangles) {
  // First a triangle over the lower left half; then two that cover the whole pixel and intersect at x = 1/4. The second
  // one is nearer on the left.
  const Trace half = pixel_trace(1, 1, {{{{0, 0, 0.5}, {0, 1, 0.5}, {1, 1, 0.5}}, kWhite}});
  expect_pixel(exact_areas(half, half.frames[0]).at(0, 0), {0.5, 0.5, 0.5, 0.5});
  const Trace cross = pixel_trace(1, 1,
                                  {{{{-1, -1, 0.5}, {3, -1, 0.5}, {-1, 3, 0.5}}, {1, 0, 0}},
                                   {{{-1, -1, 0.1875}, {3, -1, 1.1875}, {-1, 3, 0.1875}}, {0, 1, 0}}});
  // z of the second is 0.1875 + (x + 1) / 4. It is 0.5 at x = 0.25, and reaches the far plane only outside the pixel.
  expect_pixel(exact_areas(cross, cross.frames[0]).at(0, 0), {0.75, 0.25, 0, 1});
}

TEST(Exact, EqualDepthIsTheEarliersAndEdgesAreTopLeft) {
  const PixelSpaceTriangle first{{{-1, -1, 0.5}, {3, -1, 0.5}, {-1, 3, 0.5}}, {1, 0, 0}};
  PixelSpaceTriangle second = first;
  second.color = {0, 1, 0};
  const Trace same = pixel_trace(1, 1, {first, second});
  expect_pixel(exact_areas(same, same.frames[0]).at(0, 0), {1, 0, 0, 1});
  expect_pixel(exact_samples(same, same.frames[0], {{128, 128}}).at(0, 0), {1, 0, 0, 1});
  // Two halves share the edge x = 1/2, on which the sample lies. It is the left edge of the right one.
  const Trace halves = pixel_trace(1, 1,
                                   {{{{0.5, -4, 0.5}, {0.5, 4, 0.5}, {-4, 0, 0.5}}, {1, 0, 0}},
                                    {{{0.5, -4, 0.5}, {0.5, 4, 0.5}, {5, 0, 0.5}}, {0, 1, 0}}});
  expect_pixel(exact_samples(halves, halves.frames[0], {{128, 128}}).at(0, 0), {0, 1, 0, 1});
}

TEST(Exact, ClipsAtTheNearPlane) {
  // z = 2 x - 1, so that the left half of the pixel is in front of the near plane.
  const Trace trace = pixel_trace(1, 1, {{{{-3, -3, -7}, {5, -3, 9}, {-3, 5, -7}}, kWhite}});
  expect_pixel(exact_areas(trace, trace.frames[0]).at(0, 0), {0.5, 0.5, 0.5, 0.5});
}

// The area of the unit square where a x + b y >= c, computed by clipping.
double part_beyond(double a, double b, double c) {
  const glm::dvec2 square[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<glm::dvec2> kept;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec2 p = square[i], q = square[(i + 1) % 4];
    const double at_p = a * p.x + b * p.y - c, at_q = a * q.x + b * q.y - c;
    if (at_p >= 0) kept.push_back(p);
    if ((at_p >= 0) != (at_q >= 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  double twice = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const glm::dvec2 p = kept[i], q = kept[(i + 1) % kept.size()];
    twice += p.x * q.y - q.x * p.y;
  }
  return twice / 2;
}

// An edge that cuts off as much as possible touches a position: in each direction, the last one.
TEST(LargestCut, IsWhatTheMaskPositionsAllow) {
  for (const int positions : {32, 64, 128, 256}) {
    double largest = 0;
    for (int k = 0; k < 3600; ++k) {
      const double a = std::cos(k * std::numbers::pi / 1800), b = std::sin(k * std::numbers::pi / 1800);
      double last = -2;
      for (const SamplePattern& pattern : cell_patterns(positions))
        for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s)
          last = std::max(last, (a * pattern.x[s] + b * pattern.y[s]) / kSubpixelUnits);
      largest = std::max(largest, part_beyond(a, b, last));
    }
    EXPECT_LE(largest, largest_cut(positions) * (1 + 1e-9)) << positions;
    EXPECT_GE(largest, largest_cut(positions) * 0.99) << positions;
  }
}

using SavedCases = FolderTest;

// JSON has no NaN and no infinity, which not_finite is made of.
TEST_F(SavedCases, CanBeReadAgain) {
  for (const HardCase& hard_case : hard_cases()) {
    if (hard_case.name == "not_finite") continue;
    try {
      write_trace(hard_case.trace, path("case.json"));
      write_trace(read_trace(path("case.json")), path("again.json"));
    } catch (const std::runtime_error& error) {
      ADD_FAILURE() << hard_case.name << ": " << error.what();
      continue;
    }
    EXPECT_EQ(read("case.json"), read("again.json")) << hard_case.name;
  }
}

TEST(Judge, NoticesThatSurfacesWhichVaryAreMissing) {
  Technique nothing = parse_technique("msaa:1");
  nothing.renderer = [](const Trace& trace, std::size_t index, const FrameInput&, const FrameSinks&) {
    const Frame& frame = trace.frames[index];
    FrameResult result;
    result.image = {frame.width, frame.height, {}};
    for (std::size_t i = 0; i < std::size_t{frame.width} * frame.height; ++i)
      result.image.rgba.insert(result.image.rgba.end(),
                               {frame.background.r, frame.background.g, frame.background.b, 0});
    return result;
  };
  int judged = 0;
  for (const HardCase& hard_case : hard_cases()) {
    if (!hard_case.between && hard_case.name != "layers") continue;
    EXPECT_FALSE(Judge(hard_case).judge(nothing, {}).passes()) << hard_case.name;
    ++judged;
  }
  EXPECT_EQ(judged, 8);
}

// All in one test: a judge computes exact areas once, which takes longer than all of the techniques.
TEST(HardCases, AreWithinTheLimitsOfEachTechnique) {
  FrameInput options;
  options.memory.modelled = false;
  for (const HardCase& hard_case : hard_cases()) {
    Judge judge(hard_case);
    for (const std::string& spec : stressed_specs()) {
      const Technique technique = parse_technique(spec);
      if (technique.sampled_at.size() > 32) continue;                  // exact samples take long where there are many
      if (hard_case.name == "large" && spec == "reference") continue;  // 800 million samples
      const Verdict verdict = judge.judge(technique, options);
      EXPECT_TRUE(verdict.passes()) << spec << ", " << hard_case.name << ": " << verdict.error << ", limit "
                                    << verdict.limit;
    }
  }
}

TEST(CrowdedBin, IsExact) {
  const HardCase hard_case = crowded_bin();
  FrameInput options;
  options.memory.modelled = false;
  for (const char* spec : {"beam", "beam:bits=64,pool=16", "beam:order=stream", "msaa:8"})
    EXPECT_TRUE(Judge(hard_case).judge(parse_technique(spec), options).passes()) << spec;
}

}  // namespace beampipe::stress_test

// Runs scalar twins on numbers that count, with the data of every procedural scene of flat triangles.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "stages/geometry/vertex_setup.h"
#include "tests/test.h"
#include "tests/traces/scene_names.h"

namespace beampipe::twins {

using Int = Counted<std::int64_t>;
using Float = Counted<float>;
using Real = Counted<double>;
using Bits = Counted<std::uint32_t>;

class SceneTwins : public testing::TestWithParam<SceneKind> {
 protected:
  // `stacked`: triangles of the scene where each covers the whole picture.
  explicit SceneTwins(std::uint32_t stacked = 8) : stacked_(stacked) {}

  void SetUp() override {
    const std::uint32_t triangles = GetParam().name == "stack" ? stacked_ : 1500;
    trace_ = make_scene(GetParam().name, {.triangles = triangles, .width = 48, .height = 28});
    triangles_ = vertex_setup(trace_, trace_.frames[0], setup_);
    for (std::uint32_t i = 0; i < triangles_.triangles.size(); ++i) list_.push_back(i);
    ASSERT_FALSE(list_.empty());
  }

  Int integer(std::int64_t value) { return Int(value, twin_); }
  Float real(float value) { return Float(value, twin_); }
  Real real(double value) { return Real(value, twin_); }
  Bits bits(std::uint32_t value) { return Bits(value, twin_); }

  const Tile tile_{0, 0, 48, 28};
  Trace trace_;
  SetupTriangles triangles_;
  TriangleList list_;
  StageCounters setup_;   // counted by vertex_setup
  OperationCounts twin_;  // counted by the twins

 private:
  const std::uint32_t stacked_;
};

// Instantiates a suite that is derived from SceneTwins.
#define BEAMPIPE_ON_EVERY_SCENE(suite)                                      \
  INSTANTIATE_TEST_SUITE_P(Scenes, suite, testing::ValuesIn(flat_scenes()), \
                           [](const auto& scene) { return std::string(scene.param.name); })

}  // namespace beampipe::twins

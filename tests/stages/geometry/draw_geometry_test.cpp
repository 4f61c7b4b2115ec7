// geometry_numbers: draws of the same triangles at the same place have the same number, and no others.
#include "stages/geometry/draw_geometry.h"

#include "tests/test.h"

namespace beampipe::draw_geometry_test {

struct TwoDraws {
  Trace trace;
  Frame frame;

  TwoDraws() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    trace.meshes = {mesh, mesh};
    frame.draws.resize(2);
    frame.draws[1].mesh = 1;
  }

  DrawState& state(std::size_t draw) { return frame.draws[draw].state; }
  std::vector<std::uint32_t> numbers() const { return geometry_numbers(trace, frame); }
};

TEST(DrawGeometry, EverythingThatMovesATriangleMatters) {
  const Viewport small{0, 0, 8, 8};
  const std::tuple<const char*, bool, std::function<void(TwoDraws&)>> cases[] = {
      {"a copy of a mesh", true, [](TwoDraws&) {}},
      {"colours", true, [](TwoDraws& draws) { draws.trace.meshes[1].colors.emplace_back(1, 0, 0); }},
      {"depth functions", true, [](TwoDraws& draws) { draws.state(1).depth.function = Compare::equal; }},
      {"positions", false, [](TwoDraws& draws) { draws.trace.meshes[1].positions[2].z = 1; }},
      {"fourth coordinates", false, [](TwoDraws& draws) { draws.trace.meshes[1].ws = std::vector<float>(3, 2); }},
      {"indices", false,
       [](TwoDraws& draws) { std::swap(draws.trace.meshes[1].triangles[0].y, draws.trace.meshes[1].triangles[0].z); }},
      {"transforms", false, [](TwoDraws& draws) { draws.frame.draws[1].transform[3][0] = 1e-9; }},
      {"a viewport", false, [&](TwoDraws& draws) { draws.state(1).viewport = small; }},
      {"the same viewport", true, [&](TwoDraws& draws) { draws.state(0).viewport = draws.state(1).viewport = small; }},
      {"depth ranges", false, [](TwoDraws& draws) { draws.state(1).depth.far = 0.5f; }}};
  for (const auto& [what, are_same, change] : cases) {
    TwoDraws draws;
    change(draws);
    EXPECT_EQ(draws.numbers().at(0) == draws.numbers().at(1), are_same) << what;
  }
}

TEST(DrawGeometry, AThousandDrawsOfOneMeshHaveOneNumber) {
  TwoDraws draws;
  draws.frame.draws.assign(1000, draws.frame.draws[0]);
  EXPECT_EQ(draws.numbers(), std::vector<std::uint32_t>(1000, 0));
}

}  // namespace beampipe::draw_geometry_test

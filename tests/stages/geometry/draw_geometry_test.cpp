// geometry_numbers: draws of the same triangles at the same place have the same number, and no others.
#include "stages/geometry/draw_geometry.h"

#include <gtest/gtest.h>

namespace beampipe::draw_geometry_test {

struct DrawGeometry : testing::Test {
  Trace trace;
  Frame frame;

  DrawGeometry() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    trace.meshes = {mesh, mesh};
    frame.draws.resize(2);
    frame.draws[1].mesh = 1;
  }

  bool are_same() const {
    const std::vector<std::uint32_t> numbers = geometry_numbers(trace, frame);
    return numbers.at(0) == numbers.at(1);
  }
};

TEST_F(DrawGeometry, ACopyOfAMeshIsTheSame) { EXPECT_TRUE(are_same()); }

TEST_F(DrawGeometry, ColoursAndDepthFunctionsDoNotMatter) {
  trace.meshes[1].colors = {{1, 0, 0}};
  frame.draws[1].state.depth.function = Compare::equal;
  EXPECT_TRUE(are_same());
}

TEST_F(DrawGeometry, PositionsMatter) {
  trace.meshes[1].positions[2].z = 1;
  EXPECT_FALSE(are_same());
}

TEST_F(DrawGeometry, FourthCoordinatesMatter) {
  trace.meshes[1].ws = {1, 1, 2};
  EXPECT_FALSE(are_same());
}

TEST_F(DrawGeometry, IndicesMatter) {
  trace.meshes[1].triangles = {{0, 2, 1}};
  EXPECT_FALSE(are_same());
}

TEST_F(DrawGeometry, TransformsMatter) {
  frame.draws[1].transform[3][0] = 1e-9;
  EXPECT_FALSE(are_same());
}

TEST_F(DrawGeometry, ViewportsMatter) {
  frame.draws[1].state.viewport = Viewport{0, 0, 8, 8};
  EXPECT_FALSE(are_same());
  frame.draws[0].state.viewport = Viewport{0, 0, 8, 8};
  EXPECT_TRUE(are_same());
}

TEST_F(DrawGeometry, DepthRangesMatter) {
  frame.draws[1].state.depth.far = 0.5f;
  EXPECT_FALSE(are_same());
}

TEST_F(DrawGeometry, AThousandDrawsOfOneMeshHaveOneNumber) {
  frame.draws.assign(1000, frame.draws[0]);
  EXPECT_EQ(geometry_numbers(trace, frame), std::vector<std::uint32_t>(1000, 0));
}

}  // namespace beampipe::draw_geometry_test

#include "tools/cli/sight.h"

#include "tests/tools/fixtures.h"

namespace beampipe::sight_test {

// Two triangles, counter-clockwise as +z sees them, in the plane z.
Mesh square(float x, float y, float z, float half) {
  Mesh mesh;
  mesh.positions = {{x - half, y - half, z}, {x + half, y - half, z}, {x + half, y + half, z}, {x - half, y + half, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// Looks along -z from z = 10. At z = 0 it sees 20 x 10 units, so that a pixel of 20 x 10 has a side of 1.
Sight look_at(const std::vector<Mesh>& meshes, Cull cull = Cull::none) {
  Trace trace;
  trace.meshes = meshes;
  trace.materials.emplace_back();
  Frame frame;
  for (std::uint32_t i = 0; i < meshes.size(); ++i) frame.draws.push_back({.mesh = i, .cull = cull});
  const Camera camera{.eye = {0, 0, 10},
                      .target = {0, 0, 0},
                      .up = {0, 1, 0},
                      .fovy_deg = 2 * glm::degrees(std::atan(0.5)),
                      .near = 1,
                      .far = 100};
  return sight_from(trace, frame, camera, 20, 10);
}

TEST(Sight, TellsDepthAndPlaceOfTheFirstSurface) {
  const Sight sight = look_at({square(3, 2, 0, 1), square(3, 2, -5, 100)});
  ASSERT_EQ(sight.pixels.size(), 200u);
  int near = 0;
  for (std::size_t i = 0; i < 200; ++i) {
    const FirstSurface& pixel = sight.pixels[i];
    const double x = static_cast<double>(i % 20) - 9.5, y = 4.5 - static_cast<double>(i / 20);
    const bool is_near = std::abs(x - 3) < 1 && std::abs(y - 2) < 1;
    near += is_near;
    EXPECT_DOUBLE_EQ(pixel.depth, is_near ? 10 : 15) << i;
    const double scale = is_near ? 1.0 : 1.5;
    EXPECT_NEAR(glm::distance(pixel.point, glm::dvec3(x * scale, y * scale, is_near ? 0 : -5)), 0, 1e-12) << i;
    EXPECT_FALSE(pixel.is_back);
  }
  EXPECT_EQ(near, 4);
}

TEST(Sight, NothingIsInfinitelyFar) {
  const Sight sight = look_at({square(0, 0, 20, 5)});  // the camera stands in front of it and looks away
  for (const FirstSurface& pixel : sight.pixels) EXPECT_TRUE(std::isinf(pixel.depth));
  EXPECT_EQ(sight.triangles, 0u);
}

TEST(Sight, SeesBacksUnlessTheyAreCulled) {
  Mesh turned = square(0, 0, 0, 100);
  for (glm::uvec3& t : turned.triangles) std::swap(t.y, t.z);
  EXPECT_TRUE(look_at({turned}).pixels[0].is_back);
  EXPECT_TRUE(std::isinf(look_at({turned}, Cull::back).pixels[0].depth));
  EXPECT_TRUE(std::isfinite(look_at({turned}, Cull::front).pixels[0].depth));
  turned.materials = {kNoMaterial, 0};
  const Sight sight = look_at({turned});  // the material of the upper left triangle has one side
  EXPECT_TRUE(std::isinf(sight.pixels[0].depth));
  EXPECT_TRUE(std::isfinite(sight.pixels[199].depth));
}

// A floor under the eye, which reaches behind it.
TEST(Sight, SeesTrianglesThatReachBehindTheEye) {
  Mesh floor;
  floor.positions = {{-1000, -1, 1000}, {1000, -1, 1000}, {0, -1, -1000}};
  floor.triangles = {{0, 1, 2}};
  const Sight sight = look_at({floor});
  for (std::size_t i = 0; i < 200; ++i) {
    const double y = 4.5 - static_cast<double>(i / 20);
    EXPECT_EQ(std::isfinite(sight.pixels[i].depth), y < 0) << i;
    if (y >= 0) continue;
    EXPECT_NEAR(sight.pixels[i].depth, 10 / -y, 1e-9);
    EXPECT_FALSE(sight.pixels[i].is_back);
  }
}

TEST(Sight, CountsTrianglesThatNothingHides) {
  EXPECT_EQ(look_at({square(0, 0, 0, 2)}).triangles, 2u);
  EXPECT_EQ(look_at({square(0, 0, 0, 2), square(0, 0, -8, 2)}).triangles, 2u);  // hidden
  EXPECT_EQ(look_at({square(0, 0, 0, 2), square(6, 0, -8, 2)}).triangles, 4u);  // beside
  EXPECT_EQ(look_at({square(0, 0, 0, 2), square(30, 0, 0, 2)}).triangles, 2u);  // beyond the picture
}

}  // namespace beampipe::sight_test

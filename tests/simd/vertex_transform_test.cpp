#include "simd/vertex_transform.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe {
namespace {

// A camera at the origin that looks along -z: w = -z.
VertexTransform camera(double near, double far, double scale) {
  VertexTransform transform{{}, 1280, 720};
  transform.to_clip[0] = transform.to_clip[5] = scale;
  transform.to_clip[10] = (near + far) / (near - far), transform.to_clip[14] = 2 * near * far / (near - far);
  transform.to_clip[11] = -1;
  return transform;
}

// Mostly before the camera; some behind it, in its plane, on the view volume's border, huge, denormal, or no numbers.
float coordinate(Random& random) {
  if (random.one_in(12))
    return random.pick(std::array{0.0f, -0.0f, -1.0f, 1.0f, 3e38f, 1e-42f, std::numeric_limits<float>::infinity(),
                                  std::numeric_limits<float>::quiet_NaN()});
  return random.real32(-4, 2);
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)); }

TEST(VertexTransform, KernelEqualsTwin) {
  Random random(91);
  SCOPED_TRACE(random.name());
  std::size_t seen_in_all = 0;
  on_every_target([&] {
    for (int draw = 0; draw < 300; ++draw) {
      VertexTransform transform = camera(random.real(0.01, 1), random.real(2, 1e4), random.real(0.2, 3));
      if (random.one_in(3))
        for (double& element : transform.to_clip) element = random.real(-2, 2);
      std::vector<float> positions(3 * static_cast<std::size_t>(random.integer(1, 60)));
      for (float& value : positions) value = coordinate(random);
      std::vector<ProjectedVertex> found(positions.size() / 3);
      const std::size_t seen = transform_vertices(positions.data(), found.size(), transform, found.data());
      std::size_t expected_seen = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        const float* p = positions.data() + 3 * i;
        const ProjectedVertex expected = transform_vertex_scalar(transform, p[0], p[1], p[2]);
        const ProjectedVertex& vertex = found[i];
        expected_seen += expected.in_view;
        ASSERT_EQ(vertex.finite, expected.finite) << i;
        ASSERT_EQ(vertex.in_view, expected.in_view) << i;
        ASSERT_EQ(vertex.x, expected.x) << i;
        ASSERT_EQ(vertex.y, expected.y) << i;
        ASSERT_TRUE(same_bits(vertex.clip.x, expected.clip.x) && same_bits(vertex.clip.y, expected.clip.y) &&
                    same_bits(vertex.clip.z, expected.clip.z) && same_bits(vertex.clip.w, expected.clip.w))
            << i;
        ASSERT_TRUE(same_bits(vertex.screen.x, expected.screen.x) && same_bits(vertex.screen.y, expected.screen.y) &&
                    same_bits(vertex.screen.z, expected.screen.z))
            << i;
      }
      ASSERT_EQ(seen, expected_seen);
      seen_in_all += seen;
    }
  });
  EXPECT_GT(seen_in_all, 1'000u);
}

TEST(VertexTransform, CornersOfTheViewLandOnCornersOfThePicture) {
  const VertexTransform transform = camera(1, 3, 1);
  const std::vector<float> positions = {-1, 1, -1, 3, -3, -3, 0, 0, -2, 0, 0, 2};
  on_every_target([&] {
    std::vector<ProjectedVertex> found(4);
    EXPECT_EQ(transform_vertices(positions.data(), 4, transform, found.data()), 3u);
    const auto place = [](const ProjectedVertex& vertex) { return std::pair(vertex.x, vertex.y); };
    EXPECT_EQ(place(found[0]), std::pair(0, 0));
    EXPECT_EQ(place(found[1]), std::pair(1280 * 256, 720 * 256));
    EXPECT_EQ(place(found[2]), std::pair(640 * 256, 360 * 256));
    EXPECT_EQ(found[0].screen.z, -1.0) << "near plane";
    EXPECT_NEAR(found[1].screen.z, 0, 1e-15) << "far plane";
    EXPECT_FALSE(found[3].in_view) << "behind the camera";
    for (std::size_t i = 0; i < 4; ++i) {
      const float* p = positions.data() + 3 * i;
      EXPECT_EQ(found[i].in_view, transform_vertex_scalar(transform, p[0], p[1], p[2]).in_view) << i;
    }
  });
}

TEST(VertexTransform, TheEyeIsNotInView) {
  VertexTransform transform = camera(1, 3, 1);
  transform.to_clip[14] = 0;  // x, y, z and w are 0 there
  const std::vector<float> eye = {0, 0, 0};
  EXPECT_FALSE(transform_vertex_scalar(transform, 0, 0, 0).in_view);
  on_every_target([&] {
    ProjectedVertex found;
    EXPECT_EQ(transform_vertices(eye.data(), 1, transform, &found), 0u);
    EXPECT_TRUE(found.finite);
    EXPECT_FALSE(found.in_view);
  });
}

}  // namespace
}  // namespace beampipe

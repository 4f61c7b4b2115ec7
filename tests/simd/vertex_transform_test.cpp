#include "simd/vertex_transform.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::vertex_transform_test {

// A camera at the origin that looks along -z: w = -z.
VertexTransform camera(double near, double far, double scale) {
  VertexTransform transform{{}, 1280, 720};
  transform.to_clip[0] = transform.to_clip[5] = scale;
  transform.to_clip[10] = (near + far) / (near - far), transform.to_clip[14] = 2 * near * far / (near - far);
  transform.to_clip[11] = -1;
  return transform;
}

// Mostly in front of the camera. Some are behind it, in its plane, on the border of the view volume, huge, denormal, or
// not a number.
float coordinate(Random& random) {
  if (random.one_in(12))
    return random.pick(std::array{0.0f, -0.0f, -1.0f, 1.0f, 3e38f, 1e-42f, std::numeric_limits<float>::infinity(),
                                  std::numeric_limits<float>::quiet_NaN()});
  return random.real32(-4, 2);
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)); }

TEST(VertexTransform, EveryTargetEqualsTheFormulaOnDouble) {
  Random random(91);
  on_every_target([&] {
    std::size_t seen_in_all = 0;
    for (int draw = 0; draw < 300; ++draw) {
      VertexTransform transform = camera(random.real(0.01, 1), random.real(2, 1e4), random.real(0.2, 3));
      if (random.one_in(3))
        for (double& element : transform.to_clip) element = random.real(-2, 2);
      std::vector<float> positions(3 * static_cast<std::size_t>(random.integer(1, 60)));
      for (float& value : positions) value = coordinate(random);
      std::vector<ProjectedVertex> found(positions.size() / 3);
      std::vector<float> ws(random.one_in(2) ? found.size() : 0);
      for (float& w : ws) w = coordinate(random);
      const std::size_t seen =
          transform_vertices(positions.data(), found.size(), transform, found.data(), ws.empty() ? nullptr : ws.data());
      std::size_t expected_seen = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        const float* p = positions.data() + 3 * i;
        const ProjectedVertex expected =
            transform_vertex_scalar(transform, p[0], p[1], p[2], ws.empty() ? nullptr : &ws[i]);
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
    EXPECT_GT(seen_in_all, 300u);
  });
}

// The columns of the matrix, each chosen by a position of its own.
TEST(VertexTransform, HomogeneousPositionsPickColumns) {
  Random random(93);
  VertexTransform transform{{}, 64, 32};
  for (double& element : transform.to_clip) element = random.real(-2, 2);
  const std::vector<float> positions = {2, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0}, ws = {0, 0, 0, 2};
  on_every_target([&] {
    std::vector<ProjectedVertex> found(4);
    transform_vertices(positions.data(), 4, transform, found.data(), ws.data());
    for (std::size_t i = 0; i < 4; ++i) {
      const ClipVertex<double>& clip = found[i].clip;
      const double rows[] = {clip.x, clip.y, clip.z, clip.w};
      for (std::size_t row = 0; row < 4; ++row) EXPECT_EQ(rows[row], 2 * transform.to_clip[4 * i + row]) << i;
    }
  });
}

// On small integers double arithmetic is exact, and so is integer arithmetic. The matrix is given by rows here.
TEST(VertexTransform, EqualsIntegerArithmetic) {
  Random random(92);
  constexpr std::int64_t kWidth = 1279, kHeight = 719;  // odd, so that some vertices lie between two units
  on_every_target([&] {
    int seen_in_all = 0, border_in_all = 0;
    for (int draw = 0; draw < 2'000; ++draw) {
      std::int64_t matrix[4][4], p[3], clip[4];
      for (auto& row : matrix)
        for (std::int64_t& element : row) element = random.integer(-20, 20);
      for (std::int64_t& coordinate : p) coordinate = random.integer(-9, 9);
      const auto sum = [&](int row) {
        return matrix[row][0] * p[0] + matrix[row][1] * p[1] + matrix[row][2] * p[2] + matrix[row][3];
      };
      // w is a power of two, so that dividing by it is exact; now and then it is negative. Some vertices are exactly on
      // a plane that bounds the view volume.
      matrix[3][3] += (std::int64_t{1} << random.integer(6, 11)) * (random.one_in(8) ? -1 : 1) - sum(3);
      for (int row = 0; row < 3; ++row)
        if (random.one_in(6)) matrix[row][3] += (random.one_in(2) ? 1 : -1) * sum(3) - sum(row);
      for (int row = 0; row < 4; ++row) clip[row] = sum(row);
      VertexTransform transform{{}, kWidth, kHeight};
      for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t column = 0; column < 4; ++column)
          transform.to_clip[4 * column + row] = static_cast<double>(matrix[row][column]);
      const float position[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
      ProjectedVertex found;
      const std::size_t seen = transform_vertices(position, 1, transform, &found);

      const std::int64_t w = clip[3], farthest = std::max({std::abs(clip[0]), std::abs(clip[1]), std::abs(clip[2])});
      const bool in_view = w > 0 && farthest <= w;
      ASSERT_TRUE(found.finite);
      ASSERT_EQ(found.in_view, in_view) << "draw " << draw;
      ASSERT_EQ(seen, in_view);
      const double as_doubles[4] = {found.clip.x, found.clip.y, found.clip.z, found.clip.w};
      for (int row = 0; row < 4; ++row) ASSERT_EQ(as_doubles[row], static_cast<double>(clip[row])) << "draw " << draw;
      seen_in_all += in_view, border_in_all += in_view && farthest == w;
      if (!in_view) continue;
      // Pixels are (x / w + 1) / 2 of the width, and (1 - y / w) / 2 of the height; the grid rounds half up.
      const auto grid = [&](std::int64_t part, std::int64_t size) { return (part * size * 256 + w) / (2 * w); };
      ASSERT_EQ(found.x, grid(clip[0] + w, kWidth)) << "draw " << draw;
      ASSERT_EQ(found.y, grid(w - clip[1], kHeight)) << "draw " << draw;
      ASSERT_EQ(found.screen.x * 256, found.x);
      ASSERT_EQ(found.screen.y * 256, found.y);
      ASSERT_EQ(found.screen.z * static_cast<double>(2 * w), static_cast<double>(clip[2] - w)) << "draw " << draw;
    }
    EXPECT_GT(seen_in_all, 300);
    EXPECT_GT(border_in_all, 30);
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

}  // namespace beampipe::vertex_transform_test

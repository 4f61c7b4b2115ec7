#include "simd/triangle_setup.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::triangle_setup_test {

template <class Number>
std::uint64_t bits_of(Number x) {
  return std::bit_cast<std::uint64_t>(static_cast<double>(x));
}

// Vertices on the grid of 1/256 px, some of them equal in x, in y or altogether, and at most as far away as the guard
// band. Depths of all sizes.
ScreenVertex<double> random_vertex(Random& random, const ScreenVertex<double>& other) {
  const std::int64_t reach = random.pick(std::array<std::int64_t, 3>{200, 1 << 16, 1 << 23});
  const auto place = [&](double same) {
    return random.one_in(4) ? same : static_cast<double>(random.integer(-reach, reach)) / 256;
  };
  const double depth = random.pick(std::array{-1.0, -0.5, -0.0, 0.0, random.real(-1, 0), random.real(-1e-7, 0)});
  return {place(other.x), place(other.y), random.one_in(4) ? other.z : depth};
}

// The same formula one triangle at a time. Triangles without area have no slopes, but the same bits.
TEST(TriangleSetup, PlanesEqualTheFormulaOnEveryTarget) {
  Random random(71);
  for (int block = 0; block < 3'000; ++block) {
    ScreenCorners corners{};
    const auto count = static_cast<std::size_t>(random.integer(1, kSetupBlock));
    for (std::size_t i = 0; i < count; ++i) {
      ScreenVertex<double> last{};
      for (int k = 0; k < 3; ++k) {
        last = random_vertex(random, last);
        corners.x[k][i] = last.x, corners.y[k][i] = last.y, corners.z[k][i] = last.z;
      }
    }
    on_every_target([&] {
      DepthPlaneColumns planes;
      depth_planes(corners, count, planes);
      for (std::size_t i = 0; i < count; ++i) {
        const auto vertex = [&](int k) {
          return ScreenVertex<double>{corners.x[k][i], corners.y[k][i], corners.z[k][i]};
        };
        const AnchoredPlane<double> plane = depth_plane_of(vertex(0), vertex(1), vertex(2));
        const double found[] = {planes.z[i], planes.dzdx[i], planes.dzdy[i], planes.anchor_x[i], planes.anchor_y[i]};
        const double expected[] = {plane.z, plane.dzdx, plane.dzdy, plane.anchor_x, plane.anchor_y};
        for (int value = 0; value < 5; ++value) {
          if (std::isnan(expected[value])) {
            ASSERT_TRUE(std::isnan(found[value])) << "block " << block << ", triangle " << i;
          } else {
            ASSERT_EQ(bits_of(found[value]), bits_of(expected[value])) << "block " << block << ", triangle " << i;
          }
        }
      }
    });
  }
}

TEST(TriangleSetup, NormalsEqualTheFormulaOnEveryTarget) {
  Random random(73);
  for (int block = 0; block < 3'000; ++block) {
    std::array<double, 16> to_world;
    for (double& element : to_world) element = random.one_in(4) ? 0.0 : random.real(-3, 3);
    MeshCorners corners{};
    const auto count = static_cast<std::size_t>(random.integer(1, kSetupBlock));
    for (std::size_t i = 0; i < count; ++i) {
      const double size = random.pick(std::array{1e-30, 1e-3, 1.0, 1e6, 1e38});
      for (int k = 0; k < 3; ++k) {
        const bool same = k > 0 && random.one_in(4);  // a triangle without area
        corners.x[k][i] = same ? corners.x[k - 1][i] : double{random.real32(-size, size)};
        corners.y[k][i] = same ? corners.y[k - 1][i] : double{random.real32(-size, size)};
        corners.z[k][i] = same ? corners.z[k - 1][i] : double{random.real32(-size, size)};
      }
      corners.side[i] = random.one_in(2) ? 1.0 : -1.0;
    }
    on_every_target([&] {
      NormalColumns normals;
      unit_normals(to_world, corners, count, normals);
      for (std::size_t i = 0; i < count; ++i) {
        const auto corner = [&](int k) { return Vector<double>{corners.x[k][i], corners.y[k][i], corners.z[k][i]}; };
        const Vector<double> of_mesh[3] = {corner(0), corner(1), corner(2)};
        const Vector<double> normal = unit_normal(to_world, of_mesh, corners.side[i]);
        ASSERT_EQ(bits_of(normals.x[i]), bits_of(static_cast<float>(normal.x))) << "block " << block << ", " << i;
        ASSERT_EQ(bits_of(normals.y[i]), bits_of(static_cast<float>(normal.y))) << "block " << block << ", " << i;
        ASSERT_EQ(bits_of(normals.z[i]), bits_of(static_cast<float>(normal.z))) << "block " << block << ", " << i;
      }
    });
  }
}

}  // namespace beampipe::triangle_setup_test

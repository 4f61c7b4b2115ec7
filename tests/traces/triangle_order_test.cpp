#include "traces/triangle_order.h"

#include <glm/gtc/matrix_transform.hpp>

#include "tests/test.h"

namespace beampipe::triangle_order_test {

// Two draws of a mesh with triangles at depths 1, 5 and 3, seen along -z. The second draw is 1 farther away.
Trace two_draws() {
  Trace trace;
  Mesh& mesh = trace.meshes.emplace_back();
  mesh.name = "three";
  for (const float depth : {1.0f, 5.0f, 3.0f}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {{0, 0, -depth}, {1, 0, -depth}, {0, 1, -depth}});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.colors.emplace_back(depth, 0, 0);
  }
  Frame& frame = trace.frames.emplace_back();
  frame.width = frame.height = 4;
  frame.draws.resize(2);
  frame.draws[1].transform = glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, -1));
  frame.draws[1].cull = Cull::back;
  return trace;
}

// What the frame draws, in order: each triangle's colour and its draw's culling, by which the draws differ.
std::vector<std::pair<float, Cull>> drawn(const Trace& trace) {
  std::vector<std::pair<float, Cull>> triangles;
  for (const Draw& draw : trace.frames.at(0).draws)
    for (const glm::vec3& color : trace.meshes.at(draw.mesh).colors) triangles.emplace_back(color.r, draw.cull);
  return triangles;
}

using Drawn = std::vector<std::pair<float, Cull>>;
constexpr Cull kFirst = Cull::none, kSecond = Cull::back;

TEST(TriangleOrder, ByDepthOverAllDraws) {
  const Drawn near_to_far = {{1, kFirst}, {1, kSecond}, {3, kFirst}, {3, kSecond}, {5, kFirst}, {5, kSecond}};
  EXPECT_EQ(drawn(with_triangle_order(two_draws(), 0, TriangleOrder::near_to_far)), near_to_far);
  EXPECT_EQ(drawn(with_triangle_order(two_draws(), 0, TriangleOrder::far_to_near)),
            Drawn(near_to_far.rbegin(), near_to_far.rend()));
}

TEST(TriangleOrder, GivenKeepsOrderAndDraws) {
  const Trace same = with_triangle_order(two_draws(), 0, TriangleOrder::given);
  EXPECT_EQ(drawn(same), drawn(two_draws()));
  EXPECT_EQ(same.frames.at(0).draws.size(), 2u);
}

TEST(TriangleOrder, EveryOrderHasTheSameTriangles) {
  const auto vertices = [](const Trace& trace) {
    std::multimap<std::tuple<double, float, float>, int> found;
    for (const Draw& draw : trace.frames.at(0).draws) {
      const Mesh& mesh = trace.meshes.at(draw.mesh);
      for (const glm::uvec3& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
          const glm::vec3& p = mesh.positions.at(t[k]);
          found.emplace(std::tuple(draw.transform[3].z, p.z, p.x + 10 * p.y), k);
        }
    }
    return found;
  };
  for (const TriangleOrder order : {TriangleOrder::shuffled, TriangleOrder::near_to_far, TriangleOrder::far_to_near})
    EXPECT_EQ(vertices(with_triangle_order(two_draws(), 0, order)), vertices(two_draws()));
}

TEST(TriangleOrder, ShufflesBySeed) {
  const auto shuffled = [](std::uint64_t seed) {
    return drawn(with_triangle_order(two_draws(), 0, TriangleOrder::shuffled, seed));
  };
  EXPECT_EQ(shuffled(1), shuffled(1));
  int different = 0;
  for (std::uint64_t seed = 2; seed < 12; ++seed) different += shuffled(seed) != shuffled(1);
  EXPECT_GE(different, 8);  // of 720 orders
}

}  // namespace beampipe::triangle_order_test

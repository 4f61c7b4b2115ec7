#include "traces/triangle_order.h"

#include <algorithm>
#include <utility>

#include "traces/scenes/random.h"

namespace beampipe {
namespace {

struct OrderedTriangle {
  std::uint32_t draw, triangle;
  double depth;  // along the view direction
};

std::vector<OrderedTriangle> triangles_of(const Trace& trace, const Frame& frame) {
  std::vector<OrderedTriangle> triangles;
  for (std::uint32_t d = 0; d < frame.draws.size(); ++d) {
    const Mesh& mesh = trace.meshes[frame.draws[d].mesh];
    const glm::dmat4 to_view = frame.view * frame.draws[d].transform;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      double depth = 0;
      for (int k = 0; k < 3; ++k) depth -= (to_view * glm::dvec4(mesh.positions[mesh.triangles[t][k]], 1.0)).z / 3;
      triangles.push_back({d, t, depth});
    }
  }
  return triangles;
}

template <class Value>
void copy_value(const std::vector<Value>& from, std::size_t i, std::vector<Value>& to) {
  if (!from.empty()) to.push_back(from[i]);
}

void copy_vertex(const Mesh& from, std::uint32_t i, Mesh& to) {
  to.positions.push_back(from.positions[i]);
  copy_value(from.normals, i, to.normals);
  copy_value(from.tangents, i, to.tangents);
  for (int set = 0; set < 2; ++set) copy_value(from.uvs[set], i, to.uvs[set]);
  copy_value(from.vertex_colors, i, to.vertex_colors);
}

void put_in_order(std::vector<OrderedTriangle>& triangles, TriangleOrder order, std::uint64_t seed) {
  switch (order) {
    case TriangleOrder::given:
      break;
    case TriangleOrder::shuffled: {
      Random random(seed);
      for (std::size_t left = triangles.size(); left > 1; --left)
        std::swap(triangles[left - 1], triangles[random.bits() % left]);
      break;
    }
    case TriangleOrder::near_to_far:
      std::stable_sort(triangles.begin(), triangles.end(),
                       [](const auto& a, const auto& b) { return a.depth < b.depth; });
      break;
    case TriangleOrder::far_to_near:
      std::stable_sort(triangles.begin(), triangles.end(),
                       [](const auto& a, const auto& b) { return a.depth > b.depth; });
      break;
  }
}

}  // namespace

Trace with_triangle_order(const Trace& trace, std::size_t frame_index, TriangleOrder order, std::uint64_t seed) {
  const Frame& frame = trace.frames.at(frame_index);
  std::vector<OrderedTriangle> triangles = triangles_of(trace, frame);
  put_in_order(triangles, order, seed);
  Trace ordered;
  ordered.images = trace.images;
  ordered.materials = trace.materials;
  ordered.frames.push_back(frame);
  std::vector<Draw>& draws = ordered.frames.front().draws;
  draws.clear();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Draw& draw = frame.draws[triangles[i].draw];
    const Mesh& from = trace.meshes[draw.mesh];
    if (i == 0 || triangles[i].draw != triangles[i - 1].draw) {
      draws.push_back(draw);
      draws.back().mesh = static_cast<std::uint32_t>(ordered.meshes.size());
      ordered.meshes.emplace_back().name = from.name;
    }
    Mesh& to = ordered.meshes.back();
    const auto first = static_cast<std::uint32_t>(to.positions.size());
    const std::uint32_t triangle = triangles[i].triangle;
    for (int k = 0; k < 3; ++k) copy_vertex(from, from.triangles[triangle][k], to);
    to.triangles.emplace_back(first, first + 1, first + 2);
    to.colors.push_back(from.colors[triangle]);
    copy_value(from.materials, triangle, to.materials);
  }
  return ordered;
}

}  // namespace beampipe

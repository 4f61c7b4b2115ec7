#include "stages/geometry/vertex_setup.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "simd/vertex_transform.h"
#include "stages/geometry/clip.h"
#include "stages/geometry/setup_formulas.h"
#include "stages/geometry/vertex_setup_cost.h"

namespace beampipe {
namespace {

std::array<double, 16> elements_of(const glm::dmat4& matrix) {  // column-major
  std::array<double, 16> elements{};
  for (int i = 0; i < 16; ++i) elements[static_cast<std::size_t>(i)] = matrix[i / 4][i % 4];
  return elements;
}

// What all draws of a frame share.
struct View {
  double width, height;
  glm::dmat4 to_clip;  // from world space
  ClipPlanes planes;
  bool mirrored;

  explicit View(const Frame& frame)
      : width(frame.width),
        height(frame.height),
        to_clip(frame.projection * frame.view),
        planes(clip_planes(frame)),
        // Front faces are counter-clockwise on screen. A view or projection that mirrors reverses that in world space.
        // Clip space is left-handed, so a matrix that does not mirror has a negative determinant.
        mirrored(glm::determinant(to_clip) > 0) {}
};

// Sets up triangles of one draw, one after the other, and appends them to `out`.
class TriangleSetup {
 public:
  TriangleSetup(const View& view, const Mesh& mesh, const Draw& draw, std::uint32_t draw_index,
                const VertexTransform& transform, const std::vector<ProjectedVertex>& vertices)
      : view_(view),
        mesh_(mesh),
        draw_(draw),
        to_world_(elements_of(draw.transform)),
        draw_index_(draw_index),
        transform_(transform),
        vertices_(vertices) {}

  void add(std::size_t t) {
    const glm::uvec3& index = mesh_.triangles[t];
    const std::array<const ProjectedVertex*, 3> v = {&vertices_[index.x], &vertices_[index.y], &vertices_[index.z]};
    if (v[0]->in_view && v[1]->in_view && v[2]->in_view) {
      add_on_screen(t, *v[0], *v[1], *v[2]);
    } else if (v[0]->finite && v[1]->finite && v[2]->finite) {
      ++work.outside_tests;
      const std::array<ClipVertex<double>, 3> clip = {v[0]->clip, v[1]->clip, v[2]->clip};
      if (!outside_view(clip)) add_clipped(t, clip);
    }
  }

  SetupTriangles out;
  SetupWork work;

 private:
  void add_clipped(std::size_t t, const std::array<ClipVertex<double>, 3>& v) {
    Polygon polygon(v.begin(), v.end());
    bool clipped = false;
    for (const auto& plane : view_.planes)
      for (const ClipVertex<double>& p : v) clipped |= plane_distance(plane, p) < 0;
    work.plane_tests += view_.planes.size() * v.size();
    for (std::size_t i = 0; clipped && i < view_.planes.size(); ++i) {
      work.plane_tests += polygon.size();
      polygon = clip_to_plane(polygon, view_.planes[i], work.crossings);
    }
    const auto on_screen = [&](const ClipVertex<double>& p) {
      ProjectedVertex vertex{};
      vertex.clip = p;
      place_on_screen(transform_, vertex);
      ++work.projected;
      return vertex;
    };
    work.fans += polygon.size() < 3 ? 0 : polygon.size() - 2;
    for (std::size_t i = 2; i < polygon.size(); ++i)
      if (polygon[0].w > 0 && polygon[i - 1].w > 0 && polygon[i].w > 0)
        add_on_screen(t, on_screen(polygon[0]), on_screen(polygon[i - 1]), on_screen(polygon[i]));
  }

  void add_on_screen(std::size_t t, const ProjectedVertex& a, const ProjectedVertex& b, const ProjectedVertex& c) {
    ++work.areas;
    const std::int64_t area2 = doubled_area<std::int64_t>({a.x, b.x, c.x}, {a.y, b.y, c.y});
    if (area2 == 0) return;
    const bool front = area2 < 0;  // counter-clockwise with y up
    if (draw_.cull == (front ? Cull::front : Cull::back)) return;
    SetupTriangle triangle;
    const std::array<const ProjectedVertex*, 3> turned = {&a, front ? &c : &b, front ? &b : &c};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.x[k] = turned[k]->x, triangle.y[k] = turned[k]->y;
      triangle.vertex_z[k] = static_cast<float>(turned[k]->screen.z);
    }
    // Sorted, so that a triangle has the same depth whichever vertex comes first and whichever way it turns.
    std::array<ScreenVertex<double>, 3> p = {a.screen, b.screen, c.screen};
    const auto put_in_order = [&p](std::size_t i) {
      const auto key = [](const ScreenVertex<double>& v) { return std::array{v.x, v.y, v.z}; };
      if (key(p[i + 1]) < key(p[i])) std::swap(p[i], p[i + 1]);
    };
    put_in_order(0), put_in_order(1), put_in_order(0);
    const Slopes<double> slopes = depth_slopes(p[0], p[1], p[2]);
    triangle.depth = {p[0].z, slopes.dzdx, slopes.dzdy, p[0].x, p[0].y};
    triangle.front = front;
    out.triangles.push_back(triangle);
    out.attributes.push_back(attributes(t, front));
    out.draws.push_back(draw_index_);
  }

  FlatAttributes attributes(std::size_t t, bool front) {
    FlatAttributes flat{draw_.kd.value_or(mesh_.colors[t]), glm::vec3(0), draw_.shading == Shading::lambert};
    if (!flat.lit) return flat;
    ++work.normals;
    const auto world = [&](std::uint32_t i) {
      const glm::vec3& p = mesh_.positions[i];
      return world_point<double>(to_world_, {p.x, p.y, p.z});
    };
    const glm::uvec3& index = mesh_.triangles[t];
    double length = 0;
    const Vector<double> normal = face_normal(world(index.x), world(index.y), world(index.z), length);
    const double scale = (front != view_.mirrored ? 1.0 : -1.0) / length;
    if (length > 0) flat.normal = glm::vec3(glm::dvec3(normal.x, normal.y, normal.z) * scale);
    return flat;
  }

  const View& view_;
  const Mesh& mesh_;
  const Draw& draw_;
  std::array<double, 16> to_world_;
  std::uint32_t draw_index_;
  const VertexTransform& transform_;
  const std::vector<ProjectedVertex>& vertices_;
};

void append(const SetupTriangles& part, SetupTriangles& whole) {
  whole.triangles.insert(whole.triangles.end(), part.triangles.begin(), part.triangles.end());
  whole.attributes.insert(whole.attributes.end(), part.attributes.begin(), part.attributes.end());
  whole.draws.insert(whole.draws.end(), part.draws.begin(), part.draws.end());
}

constexpr std::size_t kChunk = 4096;  // vertices or triangles per task

// Calls work(first, end) for chunks of [0, count), in parallel.
template <class ChunkWork>
void for_each_chunk(std::size_t count, ChunkWork&& work) {
  tbb::parallel_for(std::size_t{0}, (count + kChunk - 1) / kChunk,
                    [&](std::size_t chunk) { work(chunk * kChunk, std::min(count, (chunk + 1) * kChunk)); });
}

// Appends the draw's triangles to `out`, chunk by chunk.
SetupWork add_draw(const View& view, const Mesh& mesh, const Draw& draw, std::uint32_t draw_index,
                   SetupTriangles& out) {
  const VertexTransform transform{elements_of(view.to_clip * draw.transform), view.width, view.height};
  std::vector<ProjectedVertex> vertices(mesh.positions.size());
  std::vector<std::size_t> in_view((vertices.size() + kChunk - 1) / kChunk);
  for_each_chunk(vertices.size(), [&](std::size_t first, std::size_t end) {
    in_view[first / kChunk] =
        transform_vertices(&mesh.positions[first].x, end - first, transform, vertices.data() + first);
  });
  std::vector<TriangleSetup> chunks((mesh.triangles.size() + kChunk - 1) / kChunk,
                                    TriangleSetup(view, mesh, draw, draw_index, transform, vertices));
  for_each_chunk(mesh.triangles.size(), [&](std::size_t first, std::size_t end) {
    chunks[first / kChunk].out.reserve(end - first);
    for (std::size_t t = first; t < end; ++t) chunks[first / kChunk].add(t);
  });
  SetupWork work;
  work.transformed = vertices.size();
  for (const std::size_t of_chunk : in_view) work.projected += of_chunk;
  for (const TriangleSetup& chunk : chunks) {
    append(chunk.out, out);
    work += chunk.work;
  }
  return work;
}

}  // namespace

SetupTriangles vertex_setup(const Trace& trace, const Frame& frame, StageCounters& counters) {
  SetupTriangles out;
  const View view(frame);
  SetupWork work;
  counters.stage = "vertex_setup";
  std::size_t triangles = 0;
  for (const Draw& draw : frame.draws) triangles += trace.meshes[draw.mesh].triangles.size();
  out.reserve(triangles);  // once, for all triangles, culled or not: pages that are never written take no memory
  counters.items_in += triangles;
  for (std::uint32_t i = 0; i < frame.draws.size(); ++i) {
    const Draw& draw = frame.draws[i];
    const Mesh& mesh = trace.meshes[draw.mesh];
    work += add_draw(view, mesh, draw, i, out);
    counters.bytes_read += mesh.triangles.size() * sizeof(glm::uvec3) + mesh.positions.size() * sizeof(glm::vec3);
  }
  work.triangles = out.triangles.size();
  counters.items_out = out.triangles.size();
  charge(work, counters);
  counters.bytes_written += out.triangles.size() * (sizeof(SetupTriangle) + sizeof(FlatAttributes));
  return out;
}

}  // namespace beampipe

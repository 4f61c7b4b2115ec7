#include "stages/geometry/vertex_setup.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "simd/vertex_transform.h"
#include "stages/geometry/clip.h"
#include "stages/geometry/draw_plan.h"
#include "stages/geometry/setup_formulas.h"
#include "stages/geometry/vertex_setup_cost.h"
#include "stages/surface/program_alpha.h"

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
  glm::dvec4 eye;  // world space; w is 1, or 0 if xyz is the direction towards a viewer at infinity

  explicit View(const Frame& frame)
      : width(frame.width),
        height(frame.height),
        to_clip(frame.projection * frame.view),
        planes(clip_planes(width, height)),
        // Front faces are counter-clockwise on screen. A view or projection that mirrors reverses that in world space.
        // Clip space is left-handed, so a matrix that does not mirror has a negative determinant.
        mirrored(glm::determinant(to_clip) > 0),
        eye(viewer(to_clip)) {}

 private:
  // The eye is where x, y and w are 0 in clip space. This needs no inverse, which a projection without depth has not.
  static glm::dvec4 viewer(const glm::dmat4& to_clip) {
    const glm::dvec4 x = scaled_row(to_clip, 0), y = scaled_row(to_clip, 1), w = scaled_row(to_clip, 3);
    glm::dvec4 point;  // by Cramer's rule
    for (int i = 0; i < 4; ++i) {
      const int j = i == 0 ? 1 : 0, k = i <= 1 ? 2 : 1, l = i <= 2 ? 3 : 2;
      const double minor =
          x[j] * (y[k] * w[l] - y[l] * w[k]) - x[k] * (y[j] * w[l] - y[l] * w[j]) + x[l] * (y[j] * w[k] - y[k] * w[j]);
      point[i] = i % 2 ? -minor : minor;
    }
    // A viewer at infinity is where depth falls.
    if (glm::dot(scaled_row(to_clip, 2), point) > 0) point = -point;
    const double distance = glm::length(glm::dvec3(point));
    if (std::abs(point.w) > 1e-12 * distance) return point / point.w;
    return distance > 0 ? point / distance : glm::dvec4(0, 0, 1, 0);
  }

  // A row without its scale, so that products of several rows stay within the range of doubles.
  static glm::dvec4 scaled_row(const glm::dmat4& matrix, int row) {
    const glm::dvec4 values(matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]);
    const glm::dvec4 sizes = glm::abs(values);
    const double largest = std::max({sizes.x, sizes.y, sizes.z, sizes.w});
    return largest > 0 && std::isfinite(largest) ? values / largest : glm::dvec4(0.0);
  }
};

// The screen of one draw.
struct DrawScreen {
  const DrawPlacement& placement;
  VertexTransform transform;
  bool is_cut;  // to a rectangle, or to depths that are flattened
  ClipPlanes planes;
  bool mirrored;

  DrawScreen(const View& view, const Draw& draw, const DrawPlacement& of_draw)
      : placement(of_draw),
        transform{elements_of(placed(view.to_clip, of_draw) * draw.transform), view.width, view.height},
        is_cut(has_limits(of_draw) || !of_draw.clips_depth),
        planes(is_cut ? clip_planes(view.width, view.height, limits_of(of_draw)) : view.planes),
        mirrored(view.mirrored != of_draw.mirrors()) {}

 private:
  static glm::dmat4 placed(const glm::dmat4& to_clip, const DrawPlacement& placement) {
    const bool moves =
        placement.x_scale != 1 || placement.x_offset != 0 || placement.y_scale != 1 || placement.y_offset != 0;
    if (!moves) return to_clip;
    glm::dmat4 to_frame(1.0);
    to_frame[0][0] = placement.x_scale, to_frame[3][0] = placement.x_offset;
    to_frame[1][1] = placement.y_scale, to_frame[3][1] = placement.y_offset;
    return to_frame * to_clip;
  }

  static bool has_limits(const DrawPlacement& placement) {
    constexpr std::int32_t kNone = DrawPlacement::kNoSide;
    return placement.left > -kNone || placement.top > -kNone || placement.right < kNone || placement.bottom < kNone;
  }

  static ScreenLimits limits_of(const DrawPlacement& placement) {
    constexpr double kUnit = 1.0 / kSubpixelUnits;
    return {placement.left * kUnit, placement.top * kUnit, placement.right * kUnit, placement.bottom * kUnit};
  }
};

// In object space. Homogeneous positions are divided by w, unless that is 0.
glm::dvec3 position_of(const Mesh& mesh, std::size_t vertex) {
  const glm::dvec3 position(mesh.positions[vertex]);
  const double w = mesh.ws.empty() ? 1.0 : mesh.ws[vertex];
  return w == 1 || w == 0 ? position : position / w;
}

// The material of a triangle; kNoMaterial: it is flat.
std::uint32_t material_of(const Draw& draw, const Mesh& mesh, std::size_t triangle) {
  if (draw.kd || draw.program) return kNoMaterial;
  if (draw.material) return *draw.material;
  return mesh.materials.empty() ? kNoMaterial : mesh.materials[triangle];
}

// Is the colour the same everywhere, whatever the light?
bool is_flat(const Material& material, const Mesh& mesh) {
  return material.unlit && !material.base_texture && mesh.vertex_colors.empty() &&
         material.alpha_mode == AlphaMode::opaque;
}

// Runs the vertex shader on the attributes that a material may read.
class VertexShader {
 public:
  VertexShader(const View& view, const Draw& draw, const Mesh& mesh)
      : view_(view),
        mesh_(mesh),
        to_world_(draw.transform),
        normal_to_world_(normal_matrix(glm::dmat3(draw.transform))),
        handedness_(glm::determinant(glm::dmat3(draw.transform)) < 0 ? -1.0f : 1.0f) {}

  glm::dvec3 world(std::uint32_t vertex) const {
    return glm::dvec3(to_world_ * glm::dvec4(position_of(mesh_, vertex), 1.0));
  }

  SurfaceVertex operator()(std::uint32_t i) const {
    SurfaceVertex vertex;
    vertex.to_eye = numbers_of<3>(limited(glm::dvec3(view_.eye) - view_.eye.w * world(i)));
    if (!mesh_.normals.empty()) vertex.normal = numbers_of<3>(unit(normal_to_world_ * glm::dvec3(mesh_.normals[i])));
    if (!mesh_.tangents.empty()) {
      const glm::dvec3 tangent = glm::dmat3(to_world_) * glm::dvec3(mesh_.tangents[i]);
      vertex.tangent = numbers_of<3>(unit(tangent));
      vertex.tangent_sign = mesh_.tangents[i].w * handedness_;
    }
    for (std::size_t set = 0; set < 2; ++set)
      if (!mesh_.uvs[set].empty()) vertex.uvs[set] = numbers_of<2>(mesh_.uvs[set][i]);
    if (!mesh_.vertex_colors.empty()) vertex.color = numbers_of<4>(mesh_.vertex_colors[i]);
    return vertex;
  }

 private:
  // The inverse transpose times the determinant's magnitude, which transforms that flatten a mesh have too.
  static glm::dmat3 normal_matrix(const glm::dmat3& m) {
    const double sign = glm::determinant(m) < 0 ? -1.0 : 1.0;
    return sign * glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  }

  template <int Size, class Vector>
  static std::array<float, Size> numbers_of(const Vector& vector) {
    return std::bit_cast<std::array<float, Size>>(glm::vec<Size, float>(vector));
  }

  // No longer than floats can square.
  static glm::dvec3 limited(const glm::dvec3& v) {
    constexpr double kMost = 1e18;
    const double length = glm::length(v);
    return length > kMost ? kMost * unit(v) : v;
  }

  // 0 stays 0, and what has no finite length becomes 0.
  static glm::dvec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
  }

  const View& view_;
  const Mesh& mesh_;
  glm::dmat4 to_world_;
  glm::dmat3 normal_to_world_;
  float handedness_;  // -1: the transform mirrors
};

// The direction of u in world space; w: sign of the bitangent. 0 if the texture coordinates span no area.
glm::vec4 triangle_tangent(const std::array<glm::dvec3, 3>& p, const std::array<glm::dvec2, 3>& uv) {
  const glm::dvec3 a = p[1] - p[0], b = p[2] - p[0];
  const glm::dvec2 s = uv[1] - uv[0], t = uv[2] - uv[0];
  const double area = s.x * t.y - t.x * s.y;
  const glm::dvec3 tangent = (a * t.y - b * s.y) * (area < 0 ? -1.0 : 1.0);
  const double length = glm::length(tangent);
  if (area == 0 || !(length > 0) || std::isinf(length)) return glm::vec4(0.0f);
  // v points down in the image, and the bitangent up.
  return glm::vec4(glm::vec3(tangent / length), area < 0 ? 1.0f : -1.0f);
}

ClippedVertex corner(const ProjectedVertex& vertex, double second, double third) {
  return {vertex.clip, second, third};
}

// A vertex on the screen, and the weights of its triangle's vertices in it.
struct ScreenCorner {
  const ProjectedVertex& vertex;
  double second, third;
};

// On the screen, in pixels.
using CornerPlaces = std::array<glm::dvec2, 3>;

CornerPlaces snapped_places(const std::array<ScreenCorner, 3>& corners) {
  CornerPlaces places;
  for (std::size_t k = 0; k < 3; ++k) places[k] = {corners[k].vertex.screen.x, corners[k].vertex.screen.y};
  return places;
}

// As they were before they were snapped, unless they then have less area than any that were snapped.
CornerPlaces unsnapped_places(const std::array<ScreenCorner, 3>& corners, const VertexTransform& transform) {
  CornerPlaces places;
  for (std::size_t k = 0; k < 3; ++k) {
    const ScreenVertex<double> at = project<double>(corners[k].vertex.clip, transform.width, transform.height);
    places[k] = {at.x, at.y};
  }
  const double area2 =
      doubled_area<double>({places[0].x, places[1].x, places[2].x}, {places[0].y, places[1].y, places[2].y});
  constexpr double kLeast = 1.0 / (kSubpixelUnits * kSubpixelUnits);
  return std::abs(area2) >= kLeast ? places : snapped_places(corners);
}

// The planes have the first corner's snapped place as their anchor.
BarycentricPlanes<float> barycentric_planes(const std::array<ScreenCorner, 3>& corners, const CornerPlaces& places) {
  const double w = std::min({corners[0].vertex.clip.w, corners[1].vertex.clip.w, corners[2].vertex.clip.w});
  const ScreenVertex<double>& anchor = corners[0].vertex.screen;
  // From the values of a plane at the corners, times w of the corner.
  const auto plane = [&](const std::array<double, 3>& values) {
    std::array<ScreenVertex<double>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = {places[k].x, places[k].y, values[k] * (w / corners[k].vertex.clip.w)};
    const Slopes<double> slopes = depth_slopes(p[0], p[1], p[2]);
    return ScreenPlane<float>{static_cast<float>(value_beside(p[0], slopes, anchor.x, anchor.y)),
                              static_cast<float>(slopes.dzdx), static_cast<float>(slopes.dzdy)};
  };
  return {plane({1, 1, 1}), plane({corners[0].second, corners[1].second, corners[2].second}),
          plane({corners[0].third, corners[1].third, corners[2].third})};
}

constexpr std::uint32_t kNoVertices = ~0u;  // of frames whose triangles are all flat

// A draw to set up.
struct DrawJob {
  const View& view;
  const Trace& trace;
  const Draw& draw;
  const DrawPlacement& placement;
  std::uint32_t index;         // of the draw in the frame
  std::uint32_t first_vertex;  // where its vertices start in SetupTriangles::vertices, or kNoVertices
  bool numbers_triangles;
  DrawOrder order;
};

// Sets up triangles of one draw and appends them to `out`. Depth planes and normals are found for a block of triangles
// at once.
class TriangleSetup {
 public:
  TriangleSetup(const DrawJob& job, const DrawScreen& screen, const ProjectedVertex* vertices, SetupTriangles& out)
      : view_(job.view),
        screen_(screen),
        is_placed_(screen.placement != DrawPlacement{}),
        materials_(job.trace.materials),
        mesh_(job.trace.meshes[job.draw.mesh]),
        draw_(job.draw),
        program_mode_(job.draw.program ? program_alpha_mode(job.trace, job.draw, job.order) : AlphaMode::opaque),
        first_vertex_(job.first_vertex),
        transform_mirrors_(glm::determinant(glm::dmat3(job.draw.transform)) < 0),
        to_world_(elements_of(job.draw.transform)),
        draw_index_(job.index),
        numbers_triangles_(job.numbers_triangles),
        order_(job.order),
        vertices_(vertices),
        out_(out) {}

  // Triangles [first, end) of the draw's mesh.
  SetupWork add(std::size_t first, std::size_t end) {
    for (std::size_t t = first; t < end; ++t) add(t);
    finish_block();
    return std::exchange(work_, {});
  }

 private:
  void add(std::size_t t) {
    const glm::uvec3& index = mesh_.triangles[t];
    const std::array<const ProjectedVertex*, 3> v = {&vertices_[index.x], &vertices_[index.y], &vertices_[index.z]};
    if (screen_.is_cut) {
      add_cut(t, v);
    } else if (v[0]->in_view && v[1]->in_view && v[2]->in_view) {
      add_on_screen(t, {*v[0], 0, 0}, {*v[1], 1, 0}, {*v[2], 0, 1});
    } else if (v[0]->finite && v[1]->finite && v[2]->finite) {
      ++work_.outside_tests;
      if (!outside_view<double>({v[0]->clip, v[1]->clip, v[2]->clip}))
        add_clipped(t, {corner(*v[0], 0, 0), corner(*v[1], 1, 0), corner(*v[2], 0, 1)});
    }
  }

  // Triangles on the screen that are set up together.
  struct Block {
    struct Triangle {
      std::size_t number;  // in the mesh
      std::uint32_t material;
      bool front;
      std::array<const ProjectedVertex*, 3> corners;  // in the order of SetupTriangle
    };

    std::size_t count = 0;
    std::array<Triangle, kSetupBlock> triangles;
    ScreenCorners screen{};
    MeshCorners mesh{};
    DepthPlaneColumns planes;
    NormalColumns normals;
  };

  // After the last triangle, when a block is full, or before its corners go.
  void finish_block() {
    if (block_.count == 0) return;
    const std::size_t first = out_.triangles.size(), end = first + block_.count;
    out_.triangles.resize(end), out_.attributes.resize(end);
    add_triangles(out_.triangles.data() + first);
    add_attributes(out_.attributes.data() + first);
    out_.draws.resize(end, draw_index_);
    if (numbers_triangles_)
      for (std::size_t i = 0; i < block_.count; ++i)
        out_.trace_triangles.push_back(static_cast<std::uint32_t>(block_.triangles[i].number));
    block_.count = 0;
  }

  void add_triangles(SetupTriangle* out) {
    ScreenCorners& screen = block_.screen;
    for (std::size_t i = 0; i < block_.count; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const ScreenVertex<double>& vertex = block_.triangles[i].corners[k]->screen;
        screen.x[k][i] = vertex.x, screen.y[k][i] = vertex.y, screen.z[k][i] = vertex.z;
      }
    }
    if (is_placed_) place_depths();
    depth_planes(screen, block_.count, block_.planes);
    const DepthPlaneColumns& planes = block_.planes;
    for (std::size_t i = 0; i < block_.count; ++i) {
      SetupTriangle& triangle = out[i];
      for (std::size_t k = 0; k < 3; ++k) {
        const ProjectedVertex& corner = *block_.triangles[i].corners[k];
        triangle.x[k] = corner.x, triangle.y[k] = corner.y;
        triangle.vertex_z[k] = static_cast<float>(screen.z[k][i]);
      }
      triangle.depth = {planes.z[i], planes.dzdx[i], planes.dzdy[i], planes.anchor_x[i], planes.anchor_y[i]};
      triangle.front = block_.triangles[i].front;
      if (screen_.placement.has_bias()) add_bias(triangle);
    }
  }

  // A triangle of a draw whose state says where it is cut.
  void add_cut(std::size_t t, const std::array<const ProjectedVertex*, 3>& v) {
    if (!(v[0]->finite && v[1]->finite && v[2]->finite)) return;
    ++work_.outside_tests;
    if (screen_.placement.clips_depth && outside_view<double>({v[0]->clip, v[1]->clip, v[2]->clip})) return;
    bool is_inside = true;
    for (std::size_t i = 0; i < kPlanes; ++i) {
      int outside = 0;
      for (const ProjectedVertex* vertex : v) outside += plane_distance<double>(screen_.planes[i], vertex->clip) < 0;
      work_.plane_tests += v.size();
      if (outside == 3 && (i >= kDepthPlanes || screen_.placement.clips_depth)) return;
      is_inside &= outside == 0;
    }
    if (is_inside && v[0]->in_view && v[1]->in_view && v[2]->in_view) {
      add_on_screen(t, {*v[0], 0, 0}, {*v[1], 1, 0}, {*v[2], 0, 1});
      return;
    }
    Polygon polygon = {corner(*v[0], 0, 0), corner(*v[1], 1, 0), corner(*v[2], 0, 1)};
    for (std::size_t i = 0; !is_inside && i < kDepthPlanes; ++i) {
      work_.plane_tests += polygon.size();
      Polygon beyond;
      polygon = clip_to_plane(polygon, screen_.planes[i], work_.crossings, &beyond);
      if (!screen_.placement.clips_depth) add_clipped_to(kDepthPlanes, t, std::move(beyond), i == 0 ? -1.0 : 0.0);
    }
    add_clipped_to(is_inside ? kPlanes : kDepthPlanes, t, std::move(polygon));
  }

  void add_clipped(std::size_t t, Polygon polygon) {
    bool clipped = false;
    for (const auto& plane : screen_.planes)
      for (const ClippedVertex& p : polygon) clipped |= plane_distance<double>(plane, p) < 0;
    work_.plane_tests += screen_.planes.size() * polygon.size();
    add_clipped_to(clipped ? 0 : kPlanes, t, std::move(polygon));
  }

  // Clips to the planes from number `first` on, and cuts what is left into triangles. `flat_z`: the depth of all of it.
  void add_clipped_to(std::size_t first, std::size_t t, Polygon polygon, std::optional<double> flat_z = {}) {
    for (std::size_t i = first; i < screen_.planes.size(); ++i) {
      work_.plane_tests += polygon.size();
      polygon = clip_to_plane(polygon, screen_.planes[i], work_.crossings);
    }
    std::vector<ProjectedVertex> vertices(polygon.size());
    const auto on_screen = [&](std::size_t i) -> ScreenCorner {
      vertices[i] = {};
      vertices[i].clip = polygon[i];
      place_on_screen(screen_.transform, vertices[i]);
      if (screen_.is_cut) limit(vertices[i]);
      if (flat_z) vertices[i].screen.z = *flat_z;
      ++work_.projected;
      return {vertices[i], polygon[i].second, polygon[i].third};
    };
    work_.fans += polygon.size() < 3 ? 0 : polygon.size() - 2;
    for (std::size_t i = 2; i < polygon.size(); ++i)
      if (polygon[0].w > 0 && polygon[i - 1].w > 0 && polygon[i].w > 0)
        add_on_screen(t, on_screen(0), on_screen(i - 1), on_screen(i));
    finish_block();
  }

  // A crossing point may be beyond its plane by a rounding error.
  void limit(ProjectedVertex& vertex) const {
    const DrawPlacement& to = screen_.placement;
    vertex.x = std::clamp(vertex.x, to.left, to.right), vertex.y = std::clamp(vertex.y, to.top, to.bottom);
    vertex.screen.x = vertex.x * (1.0 / kSubpixelUnits), vertex.screen.y = vertex.y * (1.0 / kSubpixelUnits);
  }

  void add_on_screen(std::size_t t, const ScreenCorner& first, const ScreenCorner& second, const ScreenCorner& third) {
    const ProjectedVertex &a = first.vertex, &b = second.vertex, &c = third.vertex;
    const std::uint32_t material = material_of(draw_, mesh_, t);
    ++work_.areas;
    const std::int64_t area2 = doubled_area<std::int64_t>({a.x, b.x, c.x}, {a.y, b.y, c.y});
    if (area2 == 0) return;
    const bool front = area2 < 0;  // counter-clockwise with y up
    if (draw_.cull == (front != draw_.state.front_is_clockwise ? Cull::front : Cull::back)) return;
    if (material != kNoMaterial && !materials_[material].double_sided && shows_back(front)) return;
    block_.triangles[block_.count] = {t, material, front, {&a, front ? &c : &b, front ? &b : &c}};
    if (has_surfaces()) out_.surfaces.push_back(surface(t, material, front, {first, second, third}));
    if (++block_.count == kSetupBlock) finish_block();
  }

  // From the draw's own depth, -1..0, to the frame's.
  void place_depths() {
    const DrawPlacement& to = screen_.placement;
    for (std::size_t i = 0; i < block_.count; ++i) {
      const double offset = to.depth_offset - to.layer_step * static_cast<double>(block_.triangles[i].number);
      for (auto& z : block_.screen.z) z[i] = to.depth_scale * z[i] + offset;
    }
    work_.placed += block_.count;
  }

  // Limited, so that draws stay in their interval of depths.
  void add_bias(SetupTriangle& triangle) {
    const DrawPlacement& to = screen_.placement;
    const auto [nearest, farthest] = std::minmax({triangle.vertex_z[0], triangle.vertex_z[1], triangle.vertex_z[2]});
    double bias = depth_bias<double>({to.bias_constant, to.bias_slope, to.bias_clamp, to.window_scale},
                                     triangle.depth.dzdx, triangle.depth.dzdy);
    // In the API's order, depths are limited where they are tested.
    if (order_ == DrawOrder::by_depth)
      bias = limited_bias<double>(bias, nearest, farthest, to.window_offset, to.window_scale);
    triangle.depth.z += bias;
    for (float& z : triangle.vertex_z) z = static_cast<float>(z + bias);
    ++work_.biased;
  }

  // Does the viewer see the back: the side from which the mesh's vertices are clockwise, or else the state's front is?
  bool shows_back(bool front) const {
    return ((front == screen_.mirrored) != transform_mirrors_) != draw_.state.front_is_clockwise;
  }

  bool has_surfaces() const { return first_vertex_ != kNoVertices; }

  SetupSurface surface(std::size_t t, std::uint32_t material, bool front, const std::array<ScreenCorner, 3>& corners) {
    SetupSurface surface;
    const bool has_program = draw_.program.has_value();
    if (!has_program && (material == kNoMaterial || is_flat(materials_[material], mesh_))) return surface;
    ++work_.surfaces;
    const glm::uvec3& index = mesh_.triangles[t];
    surface.material = has_program ? kProgramSurface : material;
    surface.trace_triangle = static_cast<std::uint32_t>(t);
    const AlphaMode mode = has_program ? program_mode_ : materials_[material].alpha_mode;
    surface.is_opaque = mode == AlphaMode::opaque || (mode == AlphaMode::blend && screen_.placement.is_opaque);
    surface.is_blended = !has_program && mode == AlphaMode::blend;
    for (int k = 0; k < 3; ++k) surface.vertices[static_cast<std::size_t>(k)] = first_vertex_ + index[k];
    surface.turned = shows_back(front);
    surface.has_own_normal = mesh_.normals.empty();
    const std::optional<Texture> texture = has_program ? std::nullopt : materials_[material].normal_texture;
    if (texture && mesh_.tangents.empty()) {
      ++work_.tangents;
      const VertexShader shader(view_, draw_, mesh_);
      const std::vector<glm::vec2>& uvs = mesh_.uvs[texture->uv_set];
      surface.tangent = triangle_tangent({shader.world(index.x), shader.world(index.y), shader.world(index.z)},
                                         {uvs[index.x], uvs[index.y], uvs[index.z]});
      if (transform_mirrors_) surface.tangent.w = -surface.tangent.w;
    }
    surface.anchor_x = static_cast<float>(corners[0].vertex.screen.x);
    surface.anchor_y = static_cast<float>(corners[0].vertex.screen.y);
    work_.unsnapped += has_program;
    surface.planes = barycentric_planes(
        corners, has_program ? unsnapped_places(corners, screen_.transform) : snapped_places(corners));
    return surface;
  }

  void add_attributes(FlatAttributes* out) {
    std::size_t lit = 0;
    for (std::size_t i = 0; i < block_.count; ++i) {
      const auto& [t, material, front, corners] = block_.triangles[i];
      FlatAttributes& flat = out[i];
      flat.lit = draw_.shading == Shading::lambert;
      flat.normal = glm::vec3(0);
      if (material == kNoMaterial) {
        flat.kd = draw_.kd.value_or(mesh_.colors[t]);
      } else {
        flat.kd = glm::vec3(materials_[material].base_color);
        flat.lit = !materials_[material].unlit && mesh_.normals.empty();
      }
      if (!flat.lit) continue;
      const glm::uvec3& index = mesh_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p = position_of(mesh_, index[k]);
        block_.mesh.x[k][i] = p.x, block_.mesh.y[k][i] = p.y, block_.mesh.z[k][i] = p.z;
      }
      block_.mesh.side[i] = front != screen_.mirrored ? 1.0 : -1.0;
      ++lit;
    }
    work_.normals += lit;
    if (lit == 0) return;
    unit_normals(to_world_, block_.mesh, block_.count, block_.normals);
    const NormalColumns& normals = block_.normals;
    for (std::size_t i = 0; i < block_.count; ++i)
      if (out[i].lit) out[i].normal = {normals.x[i], normals.y[i], normals.z[i]};
  }

  const View& view_;
  const DrawScreen& screen_;
  bool is_placed_;
  const std::vector<Material>& materials_;
  const Mesh& mesh_;
  const Draw& draw_;
  AlphaMode program_mode_;  // of draws with a program
  std::uint32_t first_vertex_;
  bool transform_mirrors_;
  std::array<double, 16> to_world_;
  std::uint32_t draw_index_;
  bool numbers_triangles_;
  DrawOrder order_;
  const ProjectedVertex* vertices_;
  SetupTriangles& out_;
  Block block_;
  SetupWork work_;
};

void append(const SetupTriangles& part, SetupTriangles& whole) {
  whole.triangles.insert(whole.triangles.end(), part.triangles.begin(), part.triangles.end());
  whole.attributes.insert(whole.attributes.end(), part.attributes.begin(), part.attributes.end());
  whole.draws.insert(whole.draws.end(), part.draws.begin(), part.draws.end());
  whole.surfaces.insert(whole.surfaces.end(), part.surfaces.begin(), part.surfaces.end());
  whole.trace_triangles.insert(whole.trace_triangles.end(), part.trace_triangles.begin(), part.trace_triangles.end());
}

constexpr std::size_t kChunk = 1024;  // vertices or triangles per task

std::size_t chunks_of(std::size_t count) { return (count + kChunk - 1) / kChunk; }

// Calls work(first, end) for chunks of [0, count), in parallel.
template <class ChunkWork>
void for_each_chunk(std::size_t count, ChunkWork&& work) {
  tbb::parallel_for(std::size_t{0}, chunks_of(count),
                    [&](std::size_t chunk) { work(chunk * kChunk, std::min(count, (chunk + 1) * kChunk)); });
}

// Appends the draw's triangles to `out`.
SetupWork add_draw(const DrawJob& job, SetupTriangles& out) {
  const Mesh& mesh = job.trace.meshes[job.draw.mesh];
  const DrawScreen screen(job.view, job.draw, job.placement);
  const std::size_t vertex_count = mesh.positions.size();
  const auto vertices = std::make_unique_for_overwrite<ProjectedVertex[]>(vertex_count);
  std::vector<std::size_t> in_view(chunks_of(vertex_count));
  for_each_chunk(vertex_count, [&](std::size_t first, std::size_t end) {
    in_view[first / kChunk] =
        transform_vertices(&mesh.positions[first].x, end - first, screen.transform, vertices.get() + first,
                           mesh.ws.empty() ? nullptr : mesh.ws.data() + first);
  });
  SetupWork work;
  (mesh.ws.empty() ? work.transformed : work.transformed_homogeneous) = vertex_count;
  for (const std::size_t of_chunk : in_view) work.projected += of_chunk;
  const auto set_up = [&](std::size_t first, std::size_t end, SetupTriangles& to) {
    TriangleSetup setup(job, screen, vertices.get(), to);
    return setup.add(first, end);
  };
  if (tbb::this_task_arena::max_concurrency() == 1) {  // nothing to put together
    work += set_up(0, mesh.triangles.size(), out);
    return work;
  }
  // Parts are appended before they leave the caches, and their memory is used again: new pages would take longer than
  // the triangles in them.
  const std::size_t count = mesh.triangles.size(), chunks = chunks_of(count);
  const std::size_t at_once = 4 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  std::vector<SetupTriangles> parts(std::min(at_once, chunks));
  std::vector<SetupWork> part_work(parts.size());
  for (std::size_t first = 0; first < chunks; first += at_once) {
    const std::size_t end = std::min(first + at_once, chunks);
    tbb::parallel_for(first, end, [&](std::size_t chunk) {
      SetupTriangles& part = parts[chunk - first];
      part.clear();
      part.reserve(kChunk);
      part_work[chunk - first] = set_up(chunk * kChunk, std::min(count, (chunk + 1) * kChunk), part);
    });
    for (std::size_t i = 0; i < end - first; ++i) {
      append(parts[i], out);
      work += part_work[i];
    }
  }
  return work;
}

// Or a program.
bool has_material(const Draw& draw, const Mesh& mesh) {
  return draw.program || (!draw.kd && (draw.material || !mesh.materials.empty()));
}

std::uint64_t attribute_bytes(const Mesh& mesh) {
  return (mesh.normals.empty() ? 0u : 12u) + (mesh.tangents.empty() ? 0u : 16u) + (mesh.uvs[0].empty() ? 0u : 8u) +
         (mesh.uvs[1].empty() ? 0u : 8u) + (mesh.vertex_colors.empty() ? 0u : 16u) +
         (mesh.varyings.empty() ? 0u : sizeof(std::uint32_t) * mesh.varyings.size() / mesh.positions.size());
}

// Runs the vertex shader on the attributes of a draw. Returns the bytes that it reads and writes.
void shade_vertices(const View& view, const Draw& draw, const Mesh& mesh, StageCounters& counters,
                    std::vector<SurfaceVertex>& out) {
  const std::size_t first = out.size(), count = mesh.positions.size();
  const VertexShader shader(view, draw, mesh);
  out.resize(first + count);
  for_each_chunk(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[first + i] = shader(static_cast<std::uint32_t>(i));
  });
  const std::uint64_t attributes = attribute_bytes(mesh);
  counters.bytes_read += count * attributes;
  counters.bytes_written += count * (sizeof(glm::vec3) + attributes);
}

// Puts the opaque triangles of draws that win at equal depth first, the last one first.
void put_winners_first(const Trace& trace, const Frame& frame, SetupTriangles& all) {
  const auto is_blended = [&](std::uint32_t i) {
    if (all.is_opaque(i)) return false;
    const std::uint32_t material = all.surfaces[i].material;
    return (material == kProgramSurface ? program_alpha_mode(trace, frame.draws[all.draws[i]], all.order)
                                        : trace.materials[material].alpha_mode) == AlphaMode::blend;
  };
  const auto wins = [&](std::uint32_t i) { return all.placements[all.draws[i]].last_wins && !is_blended(i); };
  std::vector<std::uint32_t> order;
  order.reserve(all.triangles.size());
  for (auto i = static_cast<std::uint32_t>(all.triangles.size()); i-- > 0;)
    if (wins(i)) order.push_back(i);
  if (order.empty()) return;
  for (std::uint32_t i = 0; i < all.triangles.size(); ++i)
    if (!wins(i)) order.push_back(i);
  const auto reorder = [&](auto& values) {
    if (values.empty()) return;
    auto reordered = values;
    for (std::size_t i = 0; i < order.size(); ++i) reordered[i] = values[order[i]];
    values = std::move(reordered);
  };
  reorder(all.triangles), reorder(all.attributes), reorder(all.draws), reorder(all.surfaces);
  reorder(all.trace_triangles);
}

}  // namespace

SetupTriangles vertex_setup(const Trace& trace, const Frame& frame, StageCounters& counters, bool numbers_triangles,
                            DrawOrder order) {
  SetupTriangles out;
  const View view(frame);
  SetupWork work;
  counters.stage = StageId::vertex_setup;
  out.placements = plan_draws(trace, frame, order).placements;
  out.order = order;
  constexpr DrawPlacement kDefault{};
  const auto placement_of = [&](std::size_t i) -> const DrawPlacement& {
    return out.placements.empty() ? kDefault : out.placements[i];
  };
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < frame.draws.size(); ++i)
    if (placement_of(i).is_drawn) triangles += trace.meshes[frame.draws[i].mesh].triangles.size();
  out.reserve(triangles);  // once, for all triangles, culled or not: pages that are never written take no memory
  counters.items_in += triangles;
  const bool has_materials = std::any_of(frame.draws.begin(), frame.draws.end(),
                                         [&](const Draw& draw) { return has_material(draw, trace.meshes[draw.mesh]); });
  for (std::uint32_t i = 0; i < frame.draws.size(); ++i) {
    const Draw& draw = frame.draws[i];
    const Mesh& mesh = trace.meshes[draw.mesh];
    if (!placement_of(i).is_drawn) continue;
    const auto first_vertex = static_cast<std::uint32_t>(out.vertices.size());
    work += add_draw({.view = view,
                      .trace = trace,
                      .draw = draw,
                      .placement = placement_of(i),
                      .index = i,
                      .first_vertex = has_materials ? first_vertex : kNoVertices,
                      .numbers_triangles = numbers_triangles,
                      .order = order},
                     out);
    if (has_material(draw, mesh)) {
      work.shaded_vertices += mesh.positions.size();
      work.vertex_vectors += mesh.positions.size() * (std::size_t{!mesh.normals.empty()} + !mesh.tangents.empty());
      shade_vertices(view, draw, mesh, counters, out.vertices);
    }
    counters.bytes_read += mesh.triangles.size() * sizeof(glm::uvec3) + mesh.positions.size() * sizeof(glm::vec3) +
                           mesh.ws.size() * sizeof(float);
  }
  if (!out.placements.empty()) put_winners_first(trace, frame, out);
  work.triangles = out.triangles.size();
  counters.items_out = out.triangles.size();
  charge(work, counters);
  counters.bytes_written += out.triangles.size() * (sizeof(SetupTriangle) + sizeof(FlatAttributes)) +
                            out.trace_triangles.size() * sizeof(std::uint32_t);
  counters.bytes_written += work.surfaces * kSurfaceBytes + work.tangents * sizeof(glm::vec4);
  return out;
}

bool has_varying_surfaces(const Trace& trace, const Frame& frame) {
  return std::any_of(frame.draws.begin(), frame.draws.end(), [&](const Draw& draw) {
    const Mesh& mesh = trace.meshes[draw.mesh];
    if (draw.program) return true;
    for (std::size_t t = 0; has_material(draw, mesh) && t < mesh.triangles.size(); ++t) {
      const std::uint32_t material = material_of(draw, mesh, t);
      if (material != kNoMaterial && !is_flat(trace.materials[material], mesh)) return true;
    }
    return false;
  });
}

}  // namespace beampipe

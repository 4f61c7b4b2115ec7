#include "stages/temporal/motion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "simd/scalar.h"
#include "stages/data/half_bits.h"
#include "stages/data/mix_bits.h"
#include "stages/temporal/motion_cost.h"
#include "stages/temporal/temporal_formulas.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kHashStart = 0x9e3779b9u;  // not 0, because mix_bits maps 0 to 0

std::uint32_t hash(std::uint32_t state, const glm::vec3& color) {
  for (int c = 0; c < 3; ++c) state = mix_bits(state ^ std::bit_cast<std::uint32_t>(color[c]));
  return state;
}

// The draw that sample i shows; for the background, the number of draws.
std::size_t draw_at(const SampleTile& surface, std::size_t i, const MovingTile& in) {
  const std::uint32_t triangle = surface.triangle[i];
  return triangle == kNoTriangle ? in.frame.draws.size() : in.draws[triangle];
}

const Deformation* deformation_of(const MovingTile& in, std::size_t draw) {
  const bool has_any = in.deformed && draw < in.deformed->draws.size();
  return has_any && in.deformed->draws[draw] ? &*in.deformed->draws[draw] : nullptr;
}

glm::vec2 stored(const Movement<double>& moved) {
  if (!moved.in_front) return glm::vec2(std::numeric_limits<float>::infinity());
  return {nearest_half(static_cast<float>(moved.dx)), nearest_half(static_cast<float>(moved.dy))};
}

void project(const Mesh& mesh, const glm::dmat4& to_clip, const glm::uvec3& triangle, ClipPoint<double> corners[3]) {
  double m[16];
  for (int i = 0; i < 16; ++i) m[i] = to_clip[i / 4][i % 4];
  for (int k = 0; k < 3; ++k) {
    const glm::vec3& at = mesh.positions[triangle[k]];
    corners[k] = in_clip<double>(m, at.x, at.y, at.z);
  }
}

// Of a triangle of a deformed draw.
glm::vec2 triangle_motion(const MovingTile& in, const Deformation& draw, std::uint32_t triangle, double center_x,
                          double center_y) {
  const glm::uvec3& vertices = draw.now->triangles[in.deformed->trace_triangles[triangle]];
  ClipPoint<double> now[3], before[3];
  project(*draw.now, draw.to_screen, vertices, now);
  project(*draw.before, draw.to_last_screen, vertices, before);
  return stored(vertex_movement<double>(now, before, in.frame.width, in.frame.height, center_x, center_y));
}

// Of what `draw` shows with this setup triangle. The background's depth is beyond the far plane, and it moves as the
// far plane does.
glm::vec2 pixel_motion(const MovingTile& in, std::size_t draw, std::uint32_t triangle, double center_x, double center_y,
                       float depth) {
  if (const Deformation* const deformed = deformation_of(in, draw))
    return triangle_motion(in, *deformed, triangle, center_x, center_y);
  const Frame& frame = in.frame;
  const glm::dmat4& to_last = in.to_last[draw];
  const double farthest = draw == frame.draws.size() ? 0.0 : std::numeric_limits<double>::infinity();
  Reprojection<double> reprojection{{}, static_cast<double>(frame.width), static_cast<double>(frame.height)};
  for (int i = 0; i < 16; ++i) reprojection.m[i] = to_last[i / 4][i % 4];
  return stored(movement<double>(reprojection, center_x, center_y, depth, farthest));
}

// From the draw's clip space to the frame's; z is not needed there.
glm::dmat4 to_frame(const DrawPlacement& placement) {
  glm::dmat4 matrix(1.0);
  matrix[0][0] = placement.x_scale, matrix[3][0] = placement.x_offset;
  matrix[1][1] = placement.y_scale, matrix[3][1] = placement.y_offset;
  return matrix;
}

// From normalized device coordinates of the frame, where z is 2 depth + 1, to those of the draw.
glm::dmat4 from_frame(const DrawPlacement& placement) {
  glm::dmat4 matrix(1.0);
  matrix[0][0] = 1 / placement.x_scale, matrix[3][0] = -placement.x_offset / placement.x_scale;
  matrix[1][1] = 1 / placement.y_scale, matrix[3][1] = -placement.y_offset / placement.y_scale;
  const bool is_flat = placement.depth_scale == 0;
  matrix[2][2] = is_flat ? 0.0 : 1 / placement.depth_scale;
  matrix[3][2] = is_flat ? (placement.depth_offset < -1 ? -1.0 : 1.0)
                         : 1 - (1 + 2 * placement.depth_offset) / placement.depth_scale;
  return matrix;
}

// Calls visit(x, y, sample) for each pixel of the tile, row by row, with the index of its nearest sample.
template <class Visit>
void each_nearest(const SampleTile& surface, const Tile& tile, Visit&& visit) {
  const std::size_t samples = surface.samples_per_pixel;
  auto first = surface.depth.begin();
  for (std::int32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      const auto end = first + static_cast<std::ptrdiff_t>(samples);
      visit(x, y, static_cast<std::size_t>(std::min_element(first, end) - surface.depth.begin()));
      first = end;
    }
  }
}

}  // namespace

Poses poses_of(const Frame& frame, const std::vector<DrawPlacement>& placements) {
  Poses poses{frame.projection * frame.view, {}};
  for (std::size_t i = 0; i < frame.draws.size(); ++i) {
    const Draw& draw = frame.draws[i];
    poses.draws.push_back({draw.mesh, draw.transform, placements.empty() ? DrawPlacement{} : placements[i]});
  }
  return poses;
}

std::vector<const Mesh*> meshes_before(const Trace& trace, const Poses& now, const Poses& before) {
  std::vector<const Mesh*> meshes(now.draws.size());
  bool has_any = false;
  for (std::size_t i = 0; i < std::min(now.draws.size(), before.draws.size()); ++i) {
    if (now.draws[i].mesh == before.draws[i].mesh) continue;
    const Mesh &to = trace.meshes[now.draws[i].mesh], &from = trace.meshes[before.draws[i].mesh];
    const bool same_vertices = to.positions.size() == from.positions.size() && to.ws.empty() && from.ws.empty();
    if (same_vertices && to.triangles == from.triangles) meshes[i] = &from, has_any = true;
  }
  return has_any ? meshes : std::vector<const Mesh*>{};
}

Deformations deformations(const Trace& trace, const Poses& now, const Poses& before,
                          const std::vector<std::uint32_t>& trace_triangles) {
  Deformations found{{}, trace_triangles};
  const std::vector<const Mesh*> meshes = meshes_before(trace, now, before);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto to_screen = [&](const Poses& poses) {
      return to_frame(poses.draws[i].placement) * poses.view_projection * poses.draws[i].transform;
    };
    found.draws.push_back(meshes[i] ? std::optional<Deformation>({&trace.meshes[now.draws[i].mesh], meshes[i],
                                                                  to_screen(now), to_screen(before)})
                                    : std::nullopt);
  }
  return found;
}

std::uint64_t deformed_pixels(const SampleTile& surface, const MovingTile& in) {
  std::uint64_t pixels = 0;
  if (in.deformed && !in.deformed->draws.empty())
    each_nearest(surface, in.tile, [&](std::int32_t, std::int32_t, std::size_t at) {
      pixels += deformation_of(in, draw_at(surface, at, in)) != nullptr;
    });
  return pixels;
}

std::vector<glm::dmat4> to_last_frame(const Poses& now, const Poses& before) {
  const glm::dmat4 to_world = glm::inverse(now.view_projection), still = before.view_projection * to_world;
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < now.draws.size(); ++i) {
    const Poses::Pose& pose = now.draws[i];
    const bool known = i < before.draws.size() && before.draws[i].mesh == pose.mesh;
    const bool moved = known && before.draws[i].transform != pose.transform;
    matrices.push_back(
        moved ? before.view_projection * before.draws[i].transform * glm::inverse(pose.transform) * to_world : still);
    const DrawPlacement& placement_before = known ? before.draws[i].placement : pose.placement;
    if (pose.placement == DrawPlacement{} && placement_before == DrawPlacement{}) continue;
    matrices.back() = to_frame(placement_before) * matrices.back() * from_frame(pose.placement);
  }
  matrices.push_back(still);
  return matrices;
}

std::vector<glm::vec2> motion(const SampleTile& surface, const MovingTile& in, StageCounters& counters,
                              MotionFrom from) {
  std::vector<glm::vec2> vectors;
  vectors.reserve(in.tile.pixels());
  each_nearest(surface, in.tile, [&](std::int32_t x, std::int32_t y, std::size_t at) {
    vectors.push_back(
        pixel_motion(in, draw_at(surface, at, in), surface.triangle[at], x + 0.5, y + 0.5, surface.depth[at]));
  });
  charge_motion(vectors.size(), surface.samples_per_pixel, from, counters);
  charge_deformed(deformed_pixels(surface, in), counters);
  return vectors;
}

std::vector<std::uint32_t> looks_of(const Frame& frame) {
  std::vector<std::uint32_t> looks;
  for (const Draw& draw : frame.draws) {
    std::uint32_t look = mix_bits(mix_bits(kHashStart + static_cast<std::uint32_t>(looks.size())) ^ draw.mesh);
    if (draw.kd) look = hash(look, *draw.kd);
    if (draw.shading == Shading::lambert) {
      for (const Light& light : frame.lighting.lights) look = hash(hash(look, light.direction), light.color);
      for (int axis = 0; axis < 3; ++axis) look = hash(look, glm::vec3(draw.transform[axis]));
    }
    looks.push_back(look);
  }
  looks.push_back(hash(mix_bits(~kHashStart), frame.background));
  return looks;
}

PixelContents contents(const SampleTile& surface, const MovingTile& in, const std::vector<std::uint32_t>& looks,
                       StageCounters& counters) {
  const Tile& tile = in.tile;
  const std::size_t samples = surface.samples_per_pixel;
  PixelContents found;
  std::uint64_t shown = 0, deformed = 0;  // draws, in all pixels together
  std::vector<std::size_t> here;
  for (std::int32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      here.clear();
      std::uint32_t look = 0;
      float fastest = 0;
      for (std::size_t i = found.looks.size() * samples, end = i + samples; i < end; ++i) {
        const std::size_t draw = draw_at(surface, i, in);
        if (std::find(here.begin(), here.end(), draw) != here.end()) continue;
        here.push_back(draw);
        look ^= looks[draw];
        deformed += deformation_of(in, draw) != nullptr;
        const glm::vec2 moves = pixel_motion(in, draw, surface.triangle[i], x + 0.5, y + 0.5, surface.depth[i]);
        fastest = greater(fastest, square_length(moves.x, moves.y));
      }
      found.looks.push_back(look);
      found.speeds.push_back(nearest_half(std::sqrt(fastest)));
      shown += here.size();
    }
  }
  charge_contents(found.looks.size(), samples, shown, counters);
  charge_deformed(deformed, counters);
  return found;
}

std::vector<float> camera_speeds(const SampleTile& surface, const MovingTile& in, StageCounters& counters) {
  std::vector<float> speeds;
  speeds.reserve(in.tile.pixels());
  each_nearest(surface, in.tile, [&](std::int32_t x, std::int32_t y, std::size_t at) {
    const glm::vec2 moves = pixel_motion(in, in.frame.draws.size(), kNoTriangle, x + 0.5, y + 0.5, surface.depth[at]);
    speeds.push_back(nearest_half(std::sqrt(square_length(moves.x, moves.y))));
  });
  charge_camera_speeds(speeds.size(), counters);
  return speeds;
}

}  // namespace beampipe

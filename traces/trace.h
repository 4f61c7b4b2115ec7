// A trace: a recorded draw stream. Frames, each with a camera and draws of meshes.
//
// Conventions, everywhere in beampipe:
//   - matrices are column-major and multiply column vectors; clip space is OpenGL's (-w <= x, y, z <= w, y up);
//   - colours are linear RGB, unbounded above, 0 and up;
//   - images have row 0 on top.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace beampipe {

enum class Cull { none, back, front };  // front faces are counter-clockwise in clip space (y up)
enum class Shading { unlit, lambert };

// Indexed triangles; `colors` has one linear RGB (the OBJ's Kd) per triangle.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;  // indices into positions
  std::vector<glm::vec3> colors;      // same length as triangles
};

struct Draw {
  std::uint32_t mesh = 0;  // index into Trace::meshes
  glm::dmat4 transform{1.0};
  std::optional<glm::vec3> kd;  // replaces the mesh's colours
  Cull cull = Cull::none;
  Shading shading = Shading::unlit;
};

// A pinhole camera. Lengths in scene units, 0 < near < far; fovy is the full vertical angle, in degrees, 0 < fovy <
// 180.
struct Camera {
  glm::dvec3 eye, target, up;
  double fovy_deg = 0;
  double near = 0, far = 0;
};

struct Frame {
  std::uint32_t width = 0, height = 0;  // pixels, each 1..16384
  glm::vec3 background{0.0f};
  std::optional<Camera> camera;  // where `view` and `projection` came from, when the trace names a camera
  glm::dmat4 view{1.0}, projection{1.0};
  std::optional<glm::vec3> light_direction;  // world space, the way the light travels; normalised
  std::vector<Draw> draws;
};

struct Trace {
  std::vector<Mesh> meshes;
  std::vector<Frame> frames;
};

// Sets frame.camera, frame.view (right-handed look-at) and frame.projection (perspective, aspect = width / height).
// frame.width and frame.height must be set before.
void set_camera(Frame& frame, const Camera& camera);

// Makes `frames` frames of the trace's first: its camera goes around its target, about `up`, by `degrees` in all, at
// even steps; the light stays. Throws std::invalid_argument when there is no such frame or it names no camera.
void orbit_camera(Trace& trace, std::uint32_t frames, double degrees);

// Makes `frames` frames of the trace's first: its picture moves by (x, y) pixels per frame, x to the right and y down,
// as if the film were shifted, so that nothing but the sampling changes. The frames name no camera. Throws
// std::invalid_argument when there is no frame.
void pan_picture(Trace& trace, std::uint32_t frames, double x, double y);

}  // namespace beampipe

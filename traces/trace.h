// A trace is a recorded draw stream: frames, each with a camera and draws of meshes.
//
// Conventions, everywhere in beampipe:
//   - matrices are column-major and multiply column vectors; clip space is OpenGL's (-w <= x, y, z <= w, y up);
//   - colours and lights are linear RGB, each channel 0..kMostColor;
//   - pictures and images have row 0 on top.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "traces/capture_record.h"
#include "traces/draw_state.h"
#include "traces/material.h"
#include "traces/program.h"

namespace beampipe {

// Front faces are counter-clockwise in the picture, unless a draw says otherwise.
enum class Cull { none, back, front };
enum class Shading { unlit, lambert };

inline constexpr std::uint32_t kNoMaterial = ~0u;
inline constexpr glm::vec3 kDefaultColor{0.8f};  // of flat triangles to which nothing gives a colour

// Indexed triangles. Each is either flat, with one colour, or has a material, whose inputs vary over the triangle.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<float> ws;              // w of each position, which is homogeneous; empty: 1
  std::vector<glm::uvec3> triangles;  // indices into positions
  std::vector<glm::vec3> colors;      // one per triangle, linear RGB (the OBJ's Kd); of flat triangles

  // One per triangle: index into Trace::materials, or kNoMaterial if the triangle is flat. Empty: all are flat.
  std::vector<std::uint32_t> materials;

  // One per vertex, or empty. Only triangles with a material use them.
  std::vector<glm::vec3> normals;        // unit length; empty: the triangles' own normals
  std::vector<glm::vec4> tangents;       // unit length, towards u; w is the sign of the bitangent, as in glTF
  std::vector<glm::vec2> uvs[2];         // texture coordinates
  std::vector<glm::vec4> vertex_colors;  // linear RGB and alpha 0..1; times the material's base colour

  // Bits of what the fragment shaders of draws with a program read, for each vertex as ShaderProgram::inputs lists it.
  std::vector<std::uint32_t> varyings;
};

struct Draw {
  std::uint32_t mesh = 0;  // index into Trace::meshes
  glm::dmat4 transform{1.0};
  std::optional<glm::vec3> kd = {};  // replaces the mesh's colours; its triangles are flat
  Cull cull = Cull::none;
  Shading shading = Shading::unlit;  // of flat triangles
  std::optional<std::uint32_t> material =
      {};  // replaces the mesh's materials: index into Trace::materials; not with kd
  DrawState state{};
  std::optional<ProgramUse> program{};  // a shader of its own; not with kd or material, and in place of the mesh's
};

// What is stored of a shader's output: its code as sRGB; the number itself, 0..1; or any number, which is a linear
// colour.
enum class ColorTarget { srgb, unorm, floats };

// A pinhole camera. Lengths in scene units, 0 < near < far; fovy is the full vertical angle, in degrees, 0 < fovy <
// 180.
struct Camera {
  glm::dvec3 eye, target, up;
  double fovy_deg = 0;
  double near = 0, far = 0;
};

// Infinitely far away.
struct Light {
  glm::vec3 direction{0.0f, 0.0f, -1.0f};  // in which the light travels, in world space; normalised
  glm::vec3 color{1.0f};                   // linear RGB: what a white diffuse surface that faces the light reflects
};

// Light from all around: a surface that faces `up` receives `sky`, one that faces down `ground`, others a mix.
struct Ambient {
  glm::vec3 sky{0.0f}, ground{0.0f};  // linear RGB
  glm::vec3 up{0.0f, 1.0f, 0.0f};     // world space, normalised
};

struct Lighting {
  std::vector<Light> lights;  // at most kMostLights
  std::optional<Ambient> ambient;
};
inline constexpr std::size_t kMostLights = 16;

struct Frame {
  std::uint32_t width = 0, height = 0;  // pixels, each 1..16384
  glm::vec3 background{0.0f};
  float background_alpha = 1;    // what blend functions read of the destination's alpha where nothing was drawn
  std::optional<Camera> camera;  // if the trace names one; `view` and `projection` are made from it
  glm::dmat4 view{1.0}, projection{1.0};
  Lighting lighting;
  std::vector<Draw> draws;
  ColorTarget target = ColorTarget::srgb;
  CaptureRecord capture{};
};

struct Trace {
  std::optional<Source> source{};  // of a trace that was captured
  std::vector<TextureImage> images;
  std::vector<ProgramImage> program_images;
  std::vector<ProgramSampler> program_samplers;
  std::vector<ShaderProgram> programs;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Frame> frames;
};

// Sets frame.camera, frame.view (right-handed look-at) and frame.projection (perspective, aspect = width / height).
// frame.width and frame.height must be set already.
void set_camera(Frame& frame, const Camera& camera);

// Replaces the trace's frames by `frames` copies of the first one, whose camera turns about `up` around its target, in
// even steps, by `degrees` in all. The light stays where it is. Throws std::invalid_argument if the trace has no frame,
// if its first frame names no camera, or if `frames` is 0.
void orbit_camera(Trace& trace, std::uint32_t frames, double degrees);

// Replaces the trace's frames by `frames` copies of the first one, in which the picture moves by (x, y) pixels per
// frame, x to the right and y down. This shifts the film and not the camera, so that only the sampling changes. The
// frames name no camera. Throws std::invalid_argument if the trace has no frame, or if `frames` is 0.
void pan_picture(Trace& trace, std::uint32_t frames, double x, double y);

}  // namespace beampipe

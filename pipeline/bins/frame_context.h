// What all bins of a frame have in common: the triangles, set up and shaded, and how the frame is to be rendered.
#pragma once

#include <optional>

#include "pipeline/technique.h"
#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/rop/rop_rules.h"
#include "stages/surface/surface_shader.h"
#include "traces/trace.h"

namespace beampipe {

struct FrameContext {
  const Trace& trace;
  const Frame& frame;
  const FrameInput& run;
  const FrameSinks sinks;
  StageCounters setup;          // of one run of vertex_setup over the whole frame
  glm::vec3 background;         // as SurfaceShader has colours
  SetupTriangles triangles;     // in primitive order
  std::uint64_t surface_bytes;  // of planes, vertices and sheets of triangles with materials, in the modelled machine
  std::optional<TextureSet> own_textures;
  SurfaceShader shader;
  std::optional<TextureLayout> texture_layout;  // if memory is modelled and triangles have textures
  std::optional<RopRules> rop;                  // if draws are drawn in the API's order

  // Runs vertex_setup and the flat triangles' shader, and if the rules take positions, all that alpha_mask needs.
  // `order`: in which the technique can draw; it matters only to frames that need the API's. The job's trace, frame and
  // `run` must outlive it.
  explicit FrameContext(const FrameJob& job, const ShadingRules& rules = {}, DrawOrder order = DrawOrder::by_depth);
  FrameContext(const FrameContext&) = delete;
  FrameContext& operator=(const FrameContext&) = delete;

  // Does a triangle let through what lies behind it, somewhere? In the API's order, only what shaders cut out does.
  bool has_alpha() const { return has_cutouts_ || has_blending_; }
  bool has_cutouts() const { return has_cutouts_; }
  bool has_blending() const { return has_blending_; }
  bool has_textures() const { return has_textures_; }

 private:
  // Tests the alpha of cutouts and numbers sheets, for techniques whose fragments have mask positions.
  void prepare_alpha_mask();

  bool has_cutouts_ = false, has_blending_ = false, has_textures_ = false;
};

}  // namespace beampipe

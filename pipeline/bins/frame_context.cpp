#include "pipeline/bins/frame_context.h"

#include "pipeline/bins/timeline.h"
#include "stages/geometry/draw_plan.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/surface/sheets.h"
#include "stages/surface/sheets_cost.h"
#include "stages/temporal/motion.h"
#include "traces/srgb.h"

namespace beampipe {
namespace {

ShadingRules with_input(ShadingRules rules, const FrameInput& run) {
  rules.colors = run.colors;
  rules.texture_taps = run.texture_taps;
  return rules;
}

// The background as the frame's target has it.
glm::vec3 stored(const Frame& frame) {
  glm::vec3 color = frame.background;
  for (int c = 0; frame.target == ColorTarget::unorm && c < 3; ++c)
    color[c] = static_cast<float>(encoded_as_srgb(color[c]));
  return color;
}

const SetupTriangles& without_refused(SetupTriangles& triangles, const Frame& frame, const TextureSet* shared,
                                      const std::optional<TextureSet>& own) {
  return shared || own ? without_refused(triangles, frame, (shared ? *shared : *own).programs()) : triangles;
}

DrawOrder order_for(const FrameJob& job, DrawOrder possible) {
  return possible == DrawOrder::of_api && needs_api_order(job.trace, job.frame) ? possible : DrawOrder::by_depth;
}

// Are there draws whose vertices have moved within their mesh since the last frame?
bool has_deformed_draws(const FrameJob& job) {
  return job.run.history && job.run.history->frames > 0 &&
         !meshes_before(job.trace, poses_of(job.frame), job.run.history->poses).empty();
}

}  // namespace

FrameContext::FrameContext(const FrameJob& job, const ShadingRules& rules, DrawOrder order)
    : trace(job.trace),
      frame(job.frame),
      run(job.run),
      sinks(job.sinks),
      background(stored(job.frame)),
      triangles(vertex_setup(trace, frame, StageTimer(sinks.timeline)(setup), has_deformed_draws(job),
                             order_for(job, order))),
      surface_bytes(setup.bytes_written -
                    triangles.triangles.size() * (sizeof(SetupTriangle) + sizeof(FlatAttributes))),
      own_textures(run.textures || triangles.surfaces.empty() ? std::nullopt
                                                              : std::make_optional<TextureSet>(job.trace)),
      shader(without_refused(triangles, frame, run.textures, own_textures), job.trace, frame,
             run.textures   ? run.textures
             : own_textures ? &*own_textures
                            : nullptr,
             with_input(rules, run)) {
  for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i) {
    if (triangles.is_opaque(i)) continue;
    if (shader.is_cutout(i) || shader.has_verdict(i)) {
      has_cutouts_ = true;
    } else if (triangles.order == DrawOrder::by_depth) {
      has_blending_ = true;
    }
  }
  if (triangles.order == DrawOrder::of_api) rop.emplace(trace, frame, background);
  if (rules.takes_positions && has_alpha()) prepare_alpha_mask();
  has_textures_ = !shader.is_flat() && !(job.trace.images.empty() && job.trace.program_images.empty());
  if (has_textures_ && run.memory.modelled)
    texture_layout.emplace(run.textures ? *run.textures : *own_textures, job.trace.program_images);
}

void FrameContext::prepare_alpha_mask() {
  const TextureSet& textures = run.textures ? *run.textures : *own_textures;
  std::vector<bool> materials(trace.materials.size());
  for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i) {
    if (triangles.is_opaque(i)) continue;
    surface_bytes += kSheetNumberBytes;
    if (triangles.surfaces[i].material != kProgramSurface) materials[triangles.surfaces[i].material] = true;
  }
  textures.test_alphas(trace, materials);
  shader.set_sheets(number_sheets(triangles, frame, StageTimer(sinks.timeline)(setup)));
}

}  // namespace beampipe

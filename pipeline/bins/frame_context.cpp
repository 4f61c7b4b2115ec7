#include "pipeline/bins/frame_context.h"

#include "pipeline/bins/timeline.h"
#include "stages/geometry/vertex_setup.h"

namespace beampipe {
namespace {

ShadingRules with_colors(ShadingRules rules, SurfaceColors colors) {
  rules.colors = colors;
  return rules;
}

}  // namespace

FrameContext::FrameContext(const Trace& trace, const Frame& rendered, const RunOptions& options,
                           const ShadingRules& rules)
    : frame(rendered),
      run(options),
      triangles(vertex_setup(trace, frame, StageTimer(run.timeline)(setup))),
      own_textures(run.textures || triangles.surfaces.empty() ? std::nullopt : std::make_optional<TextureSet>(trace)),
      shader(triangles, trace, frame,
             run.textures   ? run.textures
             : own_textures ? &*own_textures
                            : nullptr,
             with_colors(rules, run.colors)) {
  for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i) {
    if (triangles.is_opaque(i)) continue;
    (shader.is_cutout(i) ? has_cutouts_ : has_blending_) = true;
  }
  has_textures_ = !shader.is_flat() && !trace.images.empty();
  if (has_textures_ && run.memory.modelled) texture_layout.emplace(run.textures ? *run.textures : *own_textures);
}

}  // namespace beampipe

#include "tools/cli/trace_notes.h"

#include <algorithm>
#include <map>
#include <optional>

#include "pipeline/spec.h"
#include "stages/temporal/motion.h"
#include "traces/files/json.h"

namespace beampipe {
namespace {

bool needs_light(const Material& material) { return !material.unlit && material.emissive == glm::vec3(0.0f); }

// The materials of meshes and draws that are black without light.
class Dark {
 public:
  explicit Dark(const Trace& trace) : trace_(trace) {}

  // The first such material of the draw's triangles.
  const Material* material_of(const Draw& draw) {
    if (draw.kd || trace_.meshes[draw.mesh].triangles.empty()) return nullptr;
    if (draw.material) return dark(*draw.material);
    const auto [found, is_new] = of_meshes_.try_emplace(draw.mesh, nullptr);
    if (!is_new) return found->second;
    for (const std::uint32_t material : trace_.meshes[draw.mesh].materials) {
      if (material == kNoMaterial || !dark(material)) continue;
      return found->second = dark(material);
    }
    return nullptr;
  }

 private:
  const Material* dark(std::uint32_t material) const {
    return needs_light(trace_.materials[material]) ? &trace_.materials[material] : nullptr;
  }

  const Trace& trace_;
  std::map<std::uint32_t, const Material*> of_meshes_;
};

}  // namespace

std::string note_on_darkness(const Trace& trace, const std::vector<std::size_t>& frames, const std::string& file) {
  Dark dark(trace);
  std::optional<std::size_t> first;
  const Material* black = nullptr;
  std::size_t others = 0;
  for (const std::size_t index : frames) {
    const Frame& frame = trace.frames[index];
    if (!frame.lighting.lights.empty() || frame.lighting.ambient) continue;
    const Material* found = nullptr;
    for (std::size_t i = 0; i < frame.draws.size() && !found; ++i) found = dark.material_of(frame.draws[i]);
    if (!found) continue;
    if (first) {
      ++others;
    } else {
      first = index, black = found;
    }
  }
  if (!first) return "";
  return file + ": frame " + std::to_string(*first) +
         (others > 0 ? " and " + std::to_string(others) + (others > 1 ? " others have" : " other have") : " has") +
         " neither lights nor ambient light, so surfaces of material " + in_quotes(black->name) + " are black";
}

std::string note_on_motion(const Trace& trace, const std::vector<std::size_t>& frames,
                           const std::vector<std::string>& specs, const std::string& file) {
  std::size_t draws = 0, changed = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Poses before = poses_of(trace.frames[frames[i - 1]]), now = poses_of(trace.frames[frames[i]]);
    draws += now.draws.size();
    if (now.draws.size() != before.draws.size()) continue;
    const std::vector<const Mesh*> followed = meshes_before(trace, now, before);
    for (std::size_t d = 0; d < now.draws.size(); ++d)
      changed += before.draws[d].mesh != now.draws[d].mesh && (followed.empty() || !followed[d]);
  }
  if (changed == 0 || specs.empty()) return "";
  return file + ": " + std::to_string(changed) + " of " + std::to_string(draws) +
         " draws show another mesh than in the frame before, whose motion is unknown to " + list_of(specs, "and");
}

}  // namespace beampipe

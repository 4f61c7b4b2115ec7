#include "tools/sweep/trace_shelf.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "pipeline/technique.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/files/digest.h"
#include "traces/trace_io.h"

namespace beampipe {
namespace {

std::string text_of(const PictureSize& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

std::uint64_t bytes_of(const Trace& trace) {
  std::uint64_t bytes = 0;
  for (const TextureImage& image : trace.images) bytes += image.texels.size() * sizeof image.texels[0];
  for (const Mesh& mesh : trace.meshes)
    bytes += mesh.positions.size() * (sizeof(glm::vec3) * 2 + sizeof(glm::vec4) * 2 + sizeof(glm::vec2) * 2) +
             mesh.triangles.size() * (sizeof(glm::uvec3) + sizeof(glm::vec3) + sizeof(std::uint32_t));
  return bytes;
}

bool has_viewport(const Frame& frame) {
  return std::any_of(frame.draws.begin(), frame.draws.end(),
                     [](const Draw& draw) { return draw.state.viewport || draw.state.scissor; });
}

std::vector<std::size_t> frames_of(const SweepPlan& plan, const Trace& trace, const std::string& name) {
  std::vector<std::size_t> frames = plan.frames;
  if (frames.empty()) {
    frames.resize(trace.frames.size());
    std::iota(frames.begin(), frames.end(), 0);
  }
  if (frames.back() >= trace.frames.size())
    throw std::runtime_error(plan.file + ": /frames: expected frames of " + name + ", 0 to " +
                             std::to_string(trace.frames.size() - 1) + ", found " + std::to_string(frames.back()));
  return frames;
}

}  // namespace

void resize(Trace& trace, const PictureSize& size, const std::string& name) {
  if (size == PictureSize{}) return;
  for (Frame& frame : trace.frames) {
    const bool same_ratio = std::uint64_t{frame.width} * size.height == std::uint64_t{frame.height} * size.width;
    if (trace.source || has_viewport(frame) || (!frame.camera && !same_ratio))
      throw std::runtime_error(name + ": cannot be " + text_of(size) +
                               " pixels: expected frames that name a camera, or have this ratio of width to height, "
                               "without viewports and not captured");
    frame.width = size.width, frame.height = size.height;
    if (frame.camera) set_camera(frame, Camera(*frame.camera));
  }
}

const TraceInfo& TraceShelf::info(std::size_t trace, std::size_t size) {
  const std::lock_guard lock(mutex_);
  if (const auto found = infos_.find({trace, size}); found != infos_.end()) return found->second;
  const std::string name = file_beside_plan(plan_, plan_.traces[trace]);
  Trace read = read_trace(name, {.allow_outside = allow_outside_});
  const std::vector<Frame> frames = read.frames;
  for (std::size_t each = 0; each < plan_.sizes.size(); ++each) {  // reading takes longer than all sizes do
    read.frames = frames;
    const bool is_wanted = each == size;
    try {
      resize(read, plan_.sizes[each], name);
    } catch (const std::runtime_error&) {
      if (is_wanted) throw;
      continue;  // nobody may want this trace in this size
    }
    TraceInfo info{.digest = digest_of(read),
                   .size = {read.frames.front().width, read.frames.front().height},
                   .frames = frames_of(plan_, read, name),
                   .bytes = bytes_of(read),
                   .needs = {}};
    for (const std::string& spec : plan_.techniques) {
      std::uint64_t& most = info.needs.emplace_back(0);
      const std::uint32_t bytes_per_pixel = parse_technique(spec).working_bytes_per_pixel;
      for (const std::size_t frame : info.frames) {
        if (is_wanted)
          require_memory(read, read.frames[frame], bytes_per_pixel,
                         name + ", frame " + std::to_string(frame) + " with " + spec, machine_memory());
        most = std::max(most, frame_memory(read, read.frames[frame], bytes_per_pixel));
      }
    }
    infos_.emplace(Key{trace, each}, std::move(info));
  }
  return infos_.at({trace, size});
}

std::shared_ptr<const LoadedTrace> TraceShelf::load(std::size_t trace, std::size_t size) {
  const std::lock_guard lock(mutex_);
  std::weak_ptr<const LoadedTrace>& kept = loaded_[{trace, size}];
  if (auto loaded = kept.lock()) return loaded;
  const std::string name = file_beside_plan(plan_, plan_.traces[trace]);
  auto loaded = std::make_shared<LoadedTrace>();
  loaded->trace = read_trace(name, {.allow_outside = allow_outside_});
  resize(loaded->trace, plan_.sizes[size], name);
  loaded->textures = std::make_unique<const TextureSet>(loaded->trace, name);
  kept = loaded;
  return loaded;
}

}  // namespace beampipe

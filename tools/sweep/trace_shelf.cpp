#include "tools/sweep/trace_shelf.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "pipeline/technique.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/files/digest.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

std::uint64_t bytes_of(const Trace& trace) {
  std::uint64_t bytes = 0;
  for (const TextureImage& image : trace.images) bytes += image.texels.size() * sizeof image.texels[0];
  for (const Mesh& mesh : trace.meshes)
    bytes += mesh.positions.size() * (sizeof(glm::vec3) * 2 + sizeof(glm::vec4) * 2 + sizeof(glm::vec2) * 2) +
             mesh.triangles.size() * (sizeof(glm::uvec3) + sizeof(glm::vec3) + sizeof(std::uint32_t));
  return bytes;
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

TraceShelf::Entry TraceShelf::look_at(Trace& trace, const PictureSize& size, const std::string& name) const {
  Entry entry;
  try {
    TraceInfo& info = entry.info;
    info.frames = frames_of(plan_, trace, name);
    resize(trace, info.frames, size, name);
    info.digest = digest_of(trace);
    const Frame& first = trace.frames[info.frames.front()];
    info.size = {first.width, first.height};
    info.bytes = bytes_of(trace);
    for (const std::string& spec : plan_.techniques) {
      std::uint64_t& most = info.needs.emplace_back(0);
      const std::uint32_t bytes_per_pixel = parse_technique(spec).working_bytes_per_pixel;
      for (const std::size_t frame : info.frames) {
        require_memory(trace, trace.frames[frame], bytes_per_pixel,
                       name + ", frame " + std::to_string(frame) + " with " + spec, machine_memory());
        most = std::max(most, frame_memory(trace, trace.frames[frame], bytes_per_pixel));
      }
    }
  } catch (const std::exception&) {
    entry.error = std::current_exception();
  }
  return entry;
}

const TraceInfo& TraceShelf::info(std::size_t trace, std::size_t size) {
  const std::lock_guard lock(mutex_);
  if (!entries_.contains({trace, size})) {
    const std::string name = file_beside_plan(plan_, plan_.traces[trace]);
    Trace read = read_trace(name, {.allow_outside = allow_outside_});
    const std::vector<Frame> frames = read.frames;
    for (std::size_t each = 0; each < plan_.sizes.size(); ++each) {  // reading takes longer than all sizes do
      read.frames = frames;
      entries_[{trace, each}] = look_at(read, plan_.sizes[each], name);
    }
  }
  const Entry& entry = entries_.at({trace, size});
  if (entry.error) std::rethrow_exception(entry.error);
  return entry.info;
}

std::shared_ptr<const LoadedTrace> TraceShelf::load(std::size_t trace, std::size_t size) {
  const std::lock_guard lock(mutex_);
  std::weak_ptr<const LoadedTrace>& kept = loaded_[{trace, size}];
  if (auto loaded = kept.lock()) return recent_ = loaded;
  recent_.reset();
  const std::string name = file_beside_plan(plan_, plan_.traces[trace]);
  auto loaded = std::make_shared<LoadedTrace>();
  loaded->trace = read_trace(name, {.allow_outside = allow_outside_});
  resize(loaded->trace, frames_of(plan_, loaded->trace, name), plan_.sizes[size], name);
  loaded->textures = std::make_unique<const TextureSet>(loaded->trace, name);
  kept = loaded;
  return recent_ = loaded;
}

}  // namespace beampipe

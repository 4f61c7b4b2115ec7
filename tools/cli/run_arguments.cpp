#include "tools/cli/run_arguments.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <map>
#include <numeric>
#include <thread>

#include "simd/target.h"
#include "tools/cli/trace_notes.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/evaluate/memory_system.h"
#include "tools/evaluate/results.h"
#include "tools/files/output.h"
#include "traces/files/trace_io.h"
#include "traces/scenes.h"

namespace beampipe {

namespace {

// A scene's name is not its trace. If the trace follows -t, it is taken for a technique; the message then says so.
void require_trace(const RunArguments& arguments) {
  const auto is_it = [&](const SceneKind& kind) { return kind.name == arguments.trace; };
  const bool is_scene = std::any_of(scene_kinds().begin(), scene_kinds().end(), is_it);
  if (std::error_code ignored; is_scene && !std::filesystem::exists(arguments.trace, ignored))
    throw UsageError(arguments.trace + " is a scene: expected its trace, which `beampipe make " + arguments.trace +
                     " -o " + arguments.trace + ".json` makes");
  if (!arguments.trace.empty()) return;
  std::string hint;
  if (std::error_code ignored; !arguments.specs.empty() && std::filesystem::exists(arguments.specs.back(), ignored))
    hint = ": " + arguments.specs.back() + " was taken for a technique; write the trace before -t";
  throw UsageError("TRACE is missing" + hint);
}

// That of the hardware, as options change it.
MemoryParameters memory_of(const RunArguments& arguments, const Hardware& hardware) {
  MemoryParameters memory = hardware.memory;
  memory.modelled = !arguments.no_memory_model;
  if (arguments.framebuffer == kByTechnique) memory.framebuffer.reset();
  if (arguments.framebuffer == kOnChip) memory.framebuffer = Place::on_chip;
  if (arguments.framebuffer == kInMemory) memory.framebuffer = Place::in_memory;
  if (arguments.on_chip_bytes > 0) memory.on_chip_bytes = static_cast<std::uint32_t>(arguments.on_chip_bytes);
  return memory;
}

}  // namespace

void add_run_arguments(Command& command, RunArguments& arguments) {
  command.add("TRACE", arguments.trace, "the trace to render, a JSON file (`beampipe make` makes one)");
  command
      .add("-t,--technique", arguments.specs,
           "one or more techniques, from the list below; this option may be repeated")
      .required();
  command
      .add("-o,--output", arguments.output,
           "the folder for pictures and report.json; it is created if necessary, and earlier results of the "
           "same trace in it are replaced")
      .required();
  command.add("--frames", arguments.frames,
              "render only frames A-B of the trace, or frame A; the first frame is 0 (default: all)");
  command
      .add("--measure-from", arguments.measure_from,
           "of these, draw the first N only with techniques that keep a history, and measure the others (default: 0)")
      .between(0, 1000000);
  add_trace_view_options(command, arguments.view);
  command.add("--threads", arguments.threads, "the number of threads (default: one per processor core)")
      .between(1, 1024);
  command
      .add("--simd", arguments.simd, "the instruction set; results do not depend on it (default: the first one here)")
      .one_of(simd_targets());
  command
      .add("--memory-limit", arguments.memory_limit,
           "the most memory for data of triangles and pixels, such as 512MB; larger frames are rendered in bands, with "
           "the same results (default: half of the machine's memory)")
      .bytes(std::uint64_t{1} << 20, std::uint64_t{1} << 50, "512MB");
  command
      .add("--repeat", arguments.repeat,
           "render each frame N times and report the median time (default: 1); above 1, memory is modelled in one "
           "additional run that is not timed")
      .between(1, 1000000);
  command.add_flag("--resume", arguments.resume,
                   "continue a stopped run: keep the finished frames that the same command left in the folder");
  command.add_flag("--force", arguments.force,
                   "overwrite results of another trace, size or camera; `run` also overwrites results of `compare`");
  add_hardware_options(command, arguments.hardware);
  command.add(
      "--trace-events", arguments.trace_events,
      "write a timeline of the stages, by tile and thread, to this file outside the output folder; ui.perfetto.dev "
      "shows it");
  command.add_flag(
      "--no-memory-model", arguments.no_memory_model,
      "do not model caches and DRAM: rendering is faster, and sector_bytes, l2_bytes and dram_bytes are 0");
  command
      .add("--framebuffer", arguments.framebuffer,
           "where the pixels of a bin are kept: on chip, as in tile-based rendering; in memory, behind caches; or as "
           "each technique is designed (default: as the hardware does, which on desktop GPUs is by-technique)")
      .one_of({kByTechnique, kOnChip, kInMemory});
  command
      .add("--on-chip-memory", arguments.on_chip_bytes,
           "what a core has on chip for the pixels of bins, such as 64KB, at least 1KB, in place of what the hardware "
           "has. Bins are made so small that as many fit as a core works on; if not even one of 8 x 8 fits, pixels are "
           "in memory")
      .bytes(1024, std::uint64_t{1} << 31, "64KB");
  command.add_flag("--allow-outside", arguments.allow_outside, "allow the trace to name files outside its own folder");
}

RunPlan make_plan(const RunArguments& arguments) {
  require_trace(arguments);
  RunPlan plan;
  plan.trace_file = arguments.trace;
  plan.command_line = arguments.command_line;
  plan.techniques = parse_techniques(arguments.specs);
  plan.repeat = arguments.repeat;
  plan.options.threads = arguments.threads > 0 ? arguments.threads : std::max(1u, std::thread::hardware_concurrency());
  plan.hardware = read_hardware(arguments.hardware);
  plan.shading_options = shading_options(arguments.hardware);
  plan.options.memory = plan.hardware.memory = memory_of(arguments, plan.hardware);
  if (const auto conflict = find_conflict(plan.options.memory))
    throw UsageError("--" + std::string(conflict->name) + " " + conflict->found + ": expected " + conflict->expected);
  for (const Technique& technique : plan.techniques)
    if (lacks_bins(plan.options.memory, technique))
      throw UsageError("-t " + technique.spec +
                       ": expected techniques that work without bins, such as msaa:8, because " + plan.hardware.named +
                       " has none");
  for (const Technique& technique : plan.techniques)
    if (const std::string reason = no_room_text(plan.options.memory, technique.framebuffer);
        !reason.empty() && !is_reference(technique.spec))
      std::cerr << "beampipe: note: " << technique.spec << ": pixels in memory: " << reason << "\n";
  plan.options.memory_limit = arguments.memory_limit > 0 ? arguments.memory_limit : machine_memory() / 2;
  if (!arguments.simd.empty()) use_simd_target(arguments.simd);
  plan.trace = read_trace(arguments.trace, {.allow_outside = arguments.allow_outside});
  plan.frames = parse_frame_range(arguments.frames, plan.trace.frames.size());
  apply(arguments.view, plan.frames, arguments.trace, plan.trace);
  for (const std::size_t frame : plan.frames)
    for (const Technique& technique : plan.techniques)
      require_memory(plan.trace, plan.trace.frames[frame], technique.working_bytes_per_pixel,
                     "frame " + std::to_string(frame) + " with " + technique.spec, machine_memory());
  if (arguments.measure_from >= plan.frames.size())
    throw UsageError("--measure-from " + std::to_string(arguments.measure_from) + ": expected fewer than the " +
                     std::to_string(plan.frames.size()) + " frames");
  const auto measured = plan.frames.begin() + static_cast<std::ptrdiff_t>(arguments.measure_from);
  plan.unmeasured.assign(plan.frames.begin(), measured);
  plan.frames.erase(plan.frames.begin(), measured);
  plan.textures = std::make_shared<TextureSet>(plan.trace, arguments.trace);
  plan.options.textures = plan.textures.get();
  if (const std::string note = note_on_darkness(plan.trace, plan.frames, arguments.trace); !note.empty())
    std::cerr << "beampipe: " << note << "\n";
  std::vector<std::string> with_history;
  for (const Technique& technique : plan.techniques)
    if (technique.keeps_history) with_history.push_back(technique.spec);
  if (plan.frames.size() == 1 && plan.unmeasured.empty())
    for (const std::string& spec : with_history)
      std::cerr << "beampipe: note: " << spec << " works over several frames; the first one has no history\n";
  if (const std::string note = note_on_motion(plan.trace, plan.frames, with_history, arguments.trace); !note.empty())
    std::cerr << "beampipe: note: " << note << "\n";
  plan.notes = notes_of(plan.trace, plan.frames, plan.textures->programs(), drawing_by_depth(plan.techniques));
  return plan;
}

std::filesystem::path file_beside_output(const std::string& option, const std::string& file,
                                         const RunArguments& arguments) {
  namespace fs = std::filesystem;
  const fs::path absolute = fs::absolute(file);
  require_writable_file(absolute);
  const fs::path found = fs::weakly_canonical(absolute.parent_path()) / absolute.filename();
  if (std::error_code none; fs::equivalent(found, arguments.trace, none))
    throw UsageError(option + " is the trace itself");
  const fs::path from_output = found.lexically_relative(fs::weakly_canonical(fs::current_path() / arguments.output));
  if (*from_output.begin() != "..") throw UsageError(option + " is in the output folder: expected a file outside it");
  return found;
}

std::vector<std::size_t> parse_frame_range(const std::string& text, std::size_t frames) {
  if (frames == 0) throw UsageError("the trace has no frames");
  std::size_t first = 0, last = frames - 1;
  if (!text.empty()) {
    const char* const end = text.data() + text.size();
    auto parsed = std::from_chars(text.data(), end, first);
    last = first;
    if (parsed.ec == std::errc() && parsed.ptr != end && *parsed.ptr == '-') {
      parsed = std::from_chars(parsed.ptr + 1, end, last);
    }
    if (parsed.ec != std::errc() || parsed.ptr != end || first > last || last >= frames) {
      throw UsageError("--frames " + text + ": expected A-B or A with frames from 0 to " + std::to_string(frames - 1));
    }
  }
  std::vector<std::size_t> range(last - first + 1);
  std::iota(range.begin(), range.end(), first);
  return range;
}

std::vector<std::string> expand_specs(const std::vector<std::string>& specs) {
  const std::string prefix = std::string(kMsaaName) + ":";
  std::vector<std::string> expanded;
  for (const std::string& spec : specs) {
    const bool is_list = spec.starts_with(prefix) && spec.find_first_not_of("0123456789,", prefix.size()) == spec.npos;
    if (!is_list) {
      expanded.push_back(spec);
      continue;
    }
    for (std::size_t at = prefix.size(), comma; at <= spec.size(); at = comma + 1) {
      comma = std::min(spec.find(',', at), spec.size());
      expanded.push_back(prefix + spec.substr(at, comma - at));
    }
  }
  return expanded;
}

std::vector<Technique> parse_techniques(const std::vector<std::string>& specs) {
  std::vector<Technique> techniques;
  std::map<std::string, std::string> spec_of_folder;
  for (const std::string& spec : expand_specs(specs)) {
    techniques.push_back(parse_technique(spec));
    const auto [other, is_new] = spec_of_folder.emplace(spec_folder(spec), spec);
    if (is_new) continue;
    if (other->second == spec) throw UsageError("technique " + spec + " is given twice");
    throw UsageError("techniques " + other->second + " and " + spec + " would both write to folder " + other->first);
  }
  return techniques;
}

}  // namespace beampipe

#include "tools/evaluate/render.h"

#include <chrono>
#include <cstdio>

#include "pipeline/bins/threads.h"
#include "pipeline/bins/timeline.h"
#include "simd/target.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/resume.h"
#include "tools/files/image_io.h"

namespace beampipe {
namespace {

// "frame 7 (3 of 5): ", or "" if there is only one frame.
std::string frame_text(const RunPlan& plan, std::size_t frame) {
  if (plan.frames.size() == 1) return "";
  return "frame " + std::to_string(frame) + " (" + std::to_string(frame - plan.frames.front() + 1) + " of " +
         std::to_string(plan.frames.size()) + "): ";
}

// One run of a technique.
struct Rendering {
  const Technique& technique;
  std::size_t frame = 0;
  bool models_memory = false;
  History* history = nullptr;  // as in FrameInput
  SurfaceColors colors = SurfaceColors::by_place;
};

struct TimedResult {
  FrameResult result;
  double milliseconds = 0;  // wall time
};

TimedResult render_timed(const RunPlan& plan, const Rendering& run, Progress& progress) {
  FrameInput options = plan.options;
  options.history = run.history;
  options.memory.modelled = run.models_memory;
  options.colors = run.colors;
  const std::string name = run.technique.spec + (run.colors == SurfaceColors::by_pixel ? ", for visibility" : "");
  FrameSinks sinks = plan.sinks;
  sinks.completion = &progress.show(frame_text(plan, run.frame) + name);
  const auto start = std::chrono::steady_clock::now();
  FrameResult result = run.technique.render(plan.trace, run.frame, options, sinks);
  const auto end = std::chrono::steady_clock::now();
  if (plan.sinks.timeline)
    plan.sinks.timeline->add(
        {name + ", frame " + std::to_string(run.frame), std::this_thread::get_id(), {}, start, end});
  return {std::move(result), std::chrono::duration<double, std::milli>(end - start).count()};
}

FrameContent content_of(const Trace& trace, std::size_t index) {
  const Frame& frame = trace.frames[index];
  FrameContent content{.index = index,
                       .width = frame.width,
                       .height = frame.height,
                       .draws = frame.draws.size(),
                       .lights = frame.lighting.lights.size()};
  for (const Draw& draw : frame.draws) content.triangles += trace.meshes[draw.mesh].triangles.size();
  return content;
}

}  // namespace

void add_counters(const FrameResult& result, FrameReport& report) {
  report.a_buffer_peak_bytes = result.a_buffer_peak_bytes;
  report.buffers = result.buffers;
  report.stages = result.stages;
  report.pixels = std::uint64_t{result.image.width} * result.image.height;
  report.bin_pixels = result.bin_pixels;
  report.bin_operations = result.bin_operations;
  report.bin_invocations = result.bin_invocations;
  report.dram_arrays = result.dram_arrays;
  report.stopped = result.stopped;
}

std::vector<WallTime> render_frame(const RunPlan& plan, std::size_t frame, Progress& progress,
                                   std::vector<History>& histories,
                                   const std::function<void(std::size_t, FrameResult&&)>& use) {
  const bool model = plan.options.memory.modelled, one_more = model && plan.repeat > 1;
  const int runs = plan.repeat + one_more;
  std::vector<std::vector<double>> milliseconds(plan.techniques.size(), std::vector<double>(runs));
  for (int run = 0; run < runs; ++run) {
    for (std::size_t i = 0; i < plan.techniques.size(); ++i) {
      History history = histories[i];
      TimedResult timed = render_timed(
          plan,
          {.technique = plan.techniques[i], .frame = frame, .models_memory = model && run == 0, .history = &history},
          progress);
      milliseconds[i][run] = timed.milliseconds;
      if (run == 0) use(i, std::move(timed.result));
      if (run + 1 == runs) histories[i] = std::move(history);
    }
  }
  std::vector<WallTime> times;
  for (const std::vector<double>& of_runs : milliseconds) {
    WallTime& time = times.emplace_back(wall_time({of_runs.begin() + one_more, of_runs.end()}));
    time.with_memory_model = model && !one_more;
    if (one_more) time.modelling_run = of_runs.front();
  }
  return times;
}

std::vector<History> rebuild_histories(const RunPlan& plan, std::size_t frames, Progress& progress,
                                       SurfaceColors colors) {
  std::vector<History> histories(plan.techniques.size());
  for (std::size_t i = 0; i < plan.techniques.size(); ++i) {
    if (!plan.techniques[i].keeps_history) continue;
    std::vector<std::size_t> earlier = plan.unmeasured;
    earlier.insert(earlier.end(), plan.frames.begin(), plan.frames.begin() + static_cast<std::ptrdiff_t>(frames));
    for (const std::size_t frame : earlier)
      render_picture(plan.techniques[i], plan, frame, progress, colors, &histories[i]);
  }
  return histories;
}

namespace {

KeptPicture kept_or_rendered(const Rendering& run, const RunPlan& plan, Progress& progress) {
  const std::string& spec = run.technique.spec;
  if (plan.pictures)
    if (std::optional<KeptPicture> found = plan.pictures->find(spec, run.frame, run.colors)) {
      found->report.wall_ms.kept = true;
      return std::move(*found);
    }
  TimedResult timed = render_timed(plan, run, progress);
  KeptPicture rendered{std::move(timed.result.image), {}};
  FrameReport& report = rendered.report;
  report.index = run.frame;
  report.wall_ms = wall_time({timed.milliseconds});
  report.wall_ms.with_memory_model = run.models_memory;
  add_counters(timed.result, report);
  if (plan.pictures) plan.pictures->keep(spec, run.frame, run.colors, rendered);
  return rendered;
}

}  // namespace

FrameResult render_kept(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress,
                        WallTime* time) {
  KeptPicture kept = kept_or_rendered(
      {.technique = technique, .frame = frame, .models_memory = plan.options.memory.modelled}, plan, progress);
  if (time) *time = kept.report.wall_ms;
  FrameResult result;
  result.image = std::move(kept.image);
  result.stages = std::move(kept.report.stages);
  result.a_buffer_peak_bytes = kept.report.a_buffer_peak_bytes;
  result.buffers = std::move(kept.report.buffers);
  result.bin_pixels = static_cast<std::uint32_t>(kept.report.bin_pixels);
  result.bin_operations = std::move(kept.report.bin_operations);
  result.bin_invocations = std::move(kept.report.bin_invocations);
  result.dram_arrays = std::move(kept.report.dram_arrays);
  result.stopped = std::move(kept.report.stopped);
  return result;
}

Image kept_picture(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress,
                   SurfaceColors colors) {
  return kept_or_rendered({.technique = technique, .frame = frame, .colors = colors}, plan, progress).image;
}

Image render_picture(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress,
                     SurfaceColors colors, History* history) {
  return render_timed(plan, {.technique = technique, .frame = frame, .history = history, .colors = colors}, progress)
      .result.image;
}

ErrorStats measure_named_error(const std::string& spec, std::size_t frame, const Image& image, const Image& reference,
                               std::optional<double> pixels_per_degree) {
  try {
    return pixels_per_degree ? measure_all(image, reference, *pixels_per_degree) : measure_error(image, reference);
  } catch (const std::exception& error) {
    throw std::runtime_error(spec + ", frame " + std::to_string(frame) + ": " + error.what());
  }
}

FrameReport write_frame(OutputFolder& output, const RunPlan& plan, const Json& made_by, const RenderedFrame& frame) {
  const auto& [spec, index, result, reference, pixels_per_degree] = frame;
  const Labels labels = {{"beampipe.trace", std::filesystem::path(plan.trace_file).filename().string()},
                         {"beampipe.trace_digest", made_by.at("trace").get<std::string>()},
                         {"beampipe.technique", spec},
                         {"beampipe.frame", std::to_string(index)},
                         {"beampipe.version", made_by.at("version").get<std::string>()}};
  const std::string stem = frame_stem(spec, index);
  FrameReport report;
  report.index = index;
  report.image = stem + ".exr";
  report.picture = stem + ".png";
  add_counters(result, report);
  Planes counters{result.image.width, result.image.height, result.pixel_counters};
  if (reference) {
    report.error = on_threads(plan.options.threads, [&] {
      return measure_named_error(frame.spec, frame.index, frame.result.image, *frame.reference,
                                 frame.pixels_per_degree);
    });
    counters.channels["error"] = pixel_errors(result.image, *reference);
  }
  for (const auto& [name, values] : counters.channels) report.pixel_counters[name] = measure_counter(values);
  // An older report or record would describe pictures that no longer exist.
  output.write(report.image, encode_exr(result.image, labels), {"report.json", frame_record_name(index)});
  output.write(report.picture, encode_png(result.image));
  if (!counters.channels.empty()) {
    report.counters = stem + "_counters.exr";
    output.write(report.counters, encode_exr(counters, labels));
  }
  return report;
}

void require_writable_folders(const OutputFolder& output, const std::vector<Technique>& techniques) {
  require_writable_folder(output.path());
  for (const Technique& technique : techniques) require_writable_folder(output.path() / spec_folder(technique.spec));
  require_writable_folder((output.path() / frame_record_name(0)).parent_path());
  require_writable_file(output.path() / "report.json");
}

Report new_report(const RunPlan& plan, const Json& made_by) {
  Report report{.trace = plan.trace_file,
                .version = program_version(),
                .simd = simd_target(),
                .command_line = plan.command_line,
                .threads = plan.options.threads,
                .memory = plan.options.memory,
                .hardware = plan.hardware,
                .notes = plan.notes,
                .made_by = made_by,
                .trace_frames = plan.trace.frames.size()};
  for (const std::size_t frame : plan.frames) report.frames.push_back(content_of(plan.trace, frame));
  return report;
}

}  // namespace beampipe

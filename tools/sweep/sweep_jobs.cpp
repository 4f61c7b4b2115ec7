#include "tools/sweep/sweep_jobs.h"

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "pipeline/bins/threads.h"
#include "pipeline/technique.h"
#include "tools/evaluate/blocks.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/memory_system.h"
#include "tools/evaluate/msaa_ladder.h"
#include "tools/evaluate/picture_cache.h"
#include "tools/evaluate/progress.h"
#include "tools/evaluate/render.h"

namespace beampipe {
namespace {

MemoryParameters without_cache_sizes(MemoryParameters memory) {
  for (CacheParameters* cache : {&memory.rop, &memory.l1, &memory.l2}) cache->bytes = cache->ways = 0;
  return memory;
}

FrameInput options_of(const LoadedTrace& loaded, const MemoryParameters& memory, const JobLimits& limits) {
  FrameInput options;
  options.threads = limits.threads;
  options.memory = memory;
  options.memory_limit = limits.memory_limit;
  options.textures = loaded.textures.get();
  return options;
}

CountedCell render_cell(const SweepPlan& plan, const SweepCell& cell, const LoadedTrace& loaded,
                        const std::vector<std::size_t>& frames, const JobLimits& limits) {
  const Technique technique = parse_technique(plan.techniques[cell.technique]);
  FrameInput options = options_of(loaded, plan.memory[cell.memory], limits);
  History history;
  options.history = &history;
  CountedCell counts;
  counts.report = new_technique_report(technique, options.memory);
  for (const std::size_t frame : frames) {
    const FrameResult result = technique.render(loaded.trace, frame, options);
    counts.reach.add(result.cache_reach);
    FrameReport report;
    report.index = frame;
    add_counters(result, report);
    counts.report.frames.push_back(std::move(report));
  }
  return counts;
}

void run_cells(const SweepPlan& plan, const SweepJob& job, TraceShelf& shelf, SweepResults& results,
               const JobLimits& limits, const std::function<void(CellSource)>& finished) {
  std::vector<std::pair<const MemoryParameters*, CountedCell>> known;
  std::shared_ptr<const LoadedTrace> loaded;
  for (const std::size_t number : job.cells) {
    const SweepCell& cell = plan.cells[number];
    const MemoryParameters& memory = plan.memory[cell.memory];
    if (std::optional<CountedCell> stored = results.counts(cell)) {
      known.emplace_back(&memory, std::move(*stored));
      finished(CellSource::stored);
      continue;
    }
    const auto same = std::find_if(known.begin(), known.end(), [&](const auto& each) {
      return counts_the_same(memory, *each.first, each.second.reach);
    });
    if (same != known.end()) {
      results.write(cell, same->second);
      finished(CellSource::shared);
      continue;
    }
    if (!loaded) loaded = shelf.load(job.trace, job.size);
    known.emplace_back(&memory, render_cell(plan, cell, *loaded, shelf.info(job.trace, job.size).frames, limits));
    results.write(cell, known.back().second);
    finished(CellSource::rendered);
  }
}

// The pictures of one variant, frame after frame.
struct VariantPictures {
  Technique technique;
  MemoryParameters memory;
  ErrorAccumulator errors;
  MeasurePool measures = {};
  BlockSquares blocks = {};
  History history = {};
};

void run_errors(const SweepPlan& plan, const SweepJob& job, TraceShelf& shelf, SweepResults& results,
                const JobLimits& limits) {
  const std::shared_ptr<const LoadedTrace> loaded = shelf.load(job.trace, job.size);
  RunPlan ladder_plan;  // without techniques, so that the ladder is that of a comparison of any one technique
  ladder_plan.trace = loaded->trace;
  ladder_plan.frames = shelf.info(job.trace, job.size).frames;
  ladder_plan.options = options_of(*loaded, {}, limits);
  if (!limits.pictures.empty()) ladder_plan.pictures = std::make_shared<PictureCache>(limits.pictures, loaded->trace);
  std::uint64_t pixels = 0;
  for (const std::size_t frame : ladder_plan.frames)
    pixels += std::uint64_t{loaded->trace.frames[frame].width} * loaded->trace.frames[frame].height;
  std::vector<VariantPictures> pictures;
  for (const PictureVariant& variant : results.variants(job.trace, job.size)) {
    MemoryParameters memory = variant.memory();
    memory.modelled = false;
    pictures.push_back({parse_technique(plan.techniques[variant.technique]), memory, ErrorAccumulator(pixels)});
  }

  Progress silent(false);
  MsaaLadder ladder({});
  const Technique reference = parse_technique(kReferenceSpec);
  std::map<std::size_t, Image> references;
  for (const std::size_t frame : ladder_plan.frames) {
    const Image& truth = references.emplace(frame, kept_picture(reference, ladder_plan, frame, silent)).first->second;
    ladder.add(ladder_plan, frame, truth, silent);
    for (VariantPictures& each : pictures) {
      FrameInput options = options_of(*loaded, each.memory, limits);
      options.history = &each.history;
      const Image image = each.technique.render(loaded->trace, frame, options).image;
      each.errors.add(image, truth);
      each.measures.add(on_threads(limits.threads, [&] { return measure_all(image, truth); }),
                        std::uint64_t{image.width} * image.height);
      add_block_squares(image, truth, each.blocks);
    }
  }

  // Only techniques other than msaa:N need rungs above 256.
  std::vector<MetricErrors> measured;
  for (const VariantPictures& each : pictures) {
    if (is_rung(each.technique)) continue;
    ladder_plan.techniques.push_back(each.technique);
    const double rmse = each.errors.stats().rmse;
    measured.push_back({rmse, rmse, each.blocks});
  }
  const MsaaLadder::Rungs rungs = ladder.rungs(
      ladder_plan, measured, [&](std::size_t frame) { return references.at(frame); }, silent);
  std::vector<std::uint32_t> samples;
  for (const LadderRung& rung : rungs.rmse) samples.push_back(rung.samples);
  std::vector<PictureErrors> errors;
  for (const VariantPictures& each : pictures) {
    ErrorStats stats = each.errors.stats();
    each.measures.finish(stats);
    errors.push_back({stats, is_rung(each.technique)
                                 ? EquivalentMsaa{static_cast<double>(each.technique.samples), false, false}
                                 : limited_equivalent_msaa(stats.rmse, rungs.rmse,
                                                           {resampled_range(each.blocks, samples, rungs.blocks)})});
  }
  results.write(job.trace, job.size, errors);
}

}  // namespace

std::vector<SweepJob> jobs_of(const SweepPlan& plan) {
  std::vector<SweepJob> jobs;
  std::map<std::tuple<std::size_t, std::size_t, std::size_t, std::string>, std::size_t> numbers;
  std::map<std::pair<std::size_t, std::size_t>, bool> has_errors;
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    const SweepCell& cell = plan.cells[i];
    if (plan.errors && !has_errors[{cell.trace, cell.size}]) {
      has_errors[{cell.trace, cell.size}] = true;
      jobs.push_back({cell.trace, cell.size, std::nullopt, {}});
    }
    const std::string rest = parameters_json(without_cache_sizes(plan.memory[cell.memory])).dump();
    const auto [found, is_new] = numbers.try_emplace({cell.trace, cell.size, cell.technique, rest}, jobs.size());
    if (is_new) jobs.push_back({cell.trace, cell.size, cell.technique, {}});
    jobs[found->second].cells.push_back(i);
  }
  const auto held = [&](std::size_t cell) {
    const MemoryParameters& memory = plan.memory[plan.cells[cell].memory];
    return std::tuple(memory.l2.held_bytes(), memory.l1.held_bytes(), memory.rop.held_bytes());
  };
  for (SweepJob& job : jobs)
    std::stable_sort(job.cells.begin(), job.cells.end(), [&](auto a, auto b) { return held(a) > held(b); });
  return jobs;
}

std::uint64_t memory_of(const SweepPlan& plan, const SweepJob& job, TraceShelf& shelf) {
  const TraceInfo& info = shelf.info(job.trace, job.size);
  std::uint64_t most = 0;
  for (std::size_t technique = 0; technique < plan.techniques.size(); ++technique)
    if (!job.technique || *job.technique == technique) most = std::max(most, info.needs[technique]);
  const std::uint64_t pixels = std::uint64_t{info.size.width} * info.size.height;
  // Errors need the trace a second time, and the pictures of the reference.
  return job.technique ? most + info.bytes : most + 2 * info.bytes + info.frames.size() * pixels * sizeof(glm::vec4);
}

bool is_finished(const SweepPlan& plan, const SweepJob& job, const SweepResults& results) {
  if (!job.technique) return results.errors(job.trace, job.size).has_value();
  return std::all_of(job.cells.begin(), job.cells.end(),
                     [&](std::size_t cell) { return results.counts(plan.cells[cell]).has_value(); });
}

void run_job(const SweepPlan& plan, const SweepJob& job, TraceShelf& shelf, SweepResults& results,
             const JobLimits& limits, const std::function<void(CellSource)>& finished) {
  if (job.technique) return run_cells(plan, job, shelf, results, limits, finished);
  const bool stored = results.errors(job.trace, job.size).has_value();
  if (!stored) run_errors(plan, job, shelf, results, limits);
  finished(stored ? CellSource::stored : CellSource::rendered);
}

}  // namespace beampipe

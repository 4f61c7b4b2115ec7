// beampipe sweep: a table of a grid of traces, techniques, sizes, memory systems and hardware.

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

#include "tools/cli/commands.h"
#include "tools/cli/metric_options.h"
#include "tools/evaluate/picture_cache.h"
#include "tools/files/output.h"
#include "tools/report/gnuplot.h"
#include "tools/sweep/slurm.h"
#include "tools/sweep/sqlite_table.h"
#include "tools/sweep/sweep_plot.h"
#include "tools/sweep/sweep_run.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostTasks = 256;  // that --slurm submits; Slurm allows 1000 by default

constexpr const char* kSweepFooter =
    R"(PLAN is a JSON file. Each list of values is an axis of a grid; the table has a row for every combination:

  {"beampipe_sweep": 1,
   "traces": ["fence.json", "classroom.json"],
   "techniques": ["beam", "msaa:8"],
   "memory_system.l2_bytes": [65536, 1048576, 4718592],
   "hardware": ["titan_v", "mali_g710"]}

Axes: traces, techniques, sizes ("320x180"), hardware (names or files), hardware.NAME (rates), memory_system.NAME (in
place of the hardware's), implementations. "errors": true compares pictures with the reference; "frames": [0, 1] renders these
alone; "points" is a list of smaller grids in place of the one. Files are relative to the plan's folder, and
`beampipe schema sweep` describes every key.

Rows that must have the same counts share one rendering: rows that differ in hardware alone, and rows whose caches
never evict a line. After a stop the same command continues. The folder gets table.csv and table.sqlite; the table
`columns` in the latter explains the columns. A plan may have 100,000 rows.

Examples:
  beampipe sweep plan.json -o out --plot memory_system.l2_bytes,dram_bytes,technique
  beampipe sweep plan.json -o out --slurm --sbatch time=2:00:00 cpus-per-task=8)";

struct SweepArguments {
  std::string plan, output, part, reference_cache;
  int jobs = 0, threads = 0;
  std::vector<std::string> start, plots, sbatch;
  bool slurm = false, dry_run = false, merge = false, allow_outside = false;
};

// A sweep as the command line asks for it.
struct Sweep {
  const SweepArguments& arguments;
  SweepPlan plan;
  OutputFolder output;
  SweepStore store;
  TraceShelf shelf;
  SweepResults results;
  std::vector<SweepJob> jobs;

  Sweep(const SweepArguments& given, InterruptGate& gate)
      : arguments(given),
        plan(read_sweep_plan(given.plan)),
        output(fs::absolute(given.output).lexically_normal(), gate),
        store(output),
        shelf(plan, given.allow_outside),
        results(plan, shelf, store),
        jobs(jobs_of(plan)) {}
};

// Of --part I/N.
struct Part {
  std::size_t index = 0, count = 1;
};

Part parse_part(const std::string& text) {
  Part part;
  const char* const end = text.data() + text.size();
  auto parsed = std::from_chars(text.data(), end, part.index);
  const bool has_slash = parsed.ec == std::errc() && parsed.ptr != end && *parsed.ptr == '/';
  if (has_slash) parsed = std::from_chars(parsed.ptr + 1, end, part.count);
  if (!has_slash || parsed.ec != std::errc() || parsed.ptr != end || part.index >= part.count)
    throw UsageError("--part " + text + ": expected I/N with I from 0 to N - 1");
  return part;
}

// The jobs of a part: neighbours, which share traces.
std::vector<SweepJob> jobs_in(const std::vector<SweepJob>& jobs, const Part& part) {
  const auto at = [&](std::size_t index) {
    return jobs.begin() + static_cast<std::ptrdiff_t>(jobs.size() * index / part.count);
  };
  return {at(part.index), at(part.index + 1)};
}

// Reads every trace once, so that mistakes show before anything is rendered.
void check_traces(Sweep& sweep) {
  for (const SweepJob& job : sweep.jobs) sweep.shelf.info(job.trace, job.size);
}

std::vector<PlotColumns> parse_plots(const Sweep& sweep) {
  std::vector<PlotColumns> plots;
  for (const std::string& text : sweep.arguments.plots)
    plots.push_back(parse_plot_columns(text, columns_of(sweep.plan)));
  return plots;
}

void merge(Sweep& sweep, const std::vector<PlotColumns>& plots) {
  const SweepTable table = make_table(sweep.plan, sweep.shelf, sweep.results);
  const auto write = [&](const fs::path& name, const std::string& bytes, const char* what) {
    sweep.output.write(name, bytes);
    sweep.output.keep();
    std::cout << what << (sweep.arguments.output / name).string() << "\n";
  };
  write("table.csv", csv_text(table), "table: ");
  write("table.sqlite", sqlite_bytes(table), "table: ");
  for (const PlotColumns& columns : plots)
    for (const ScatterPlot& plot : sweep_plots(table, columns)) {
      for (const std::string& note : plot.notes) std::cerr << "beampipe: note: " << note << "\n";
      write(plot.name + ".svg", draw(plot, PlotFormat::svg), "plot: ");
    }
  if (table.missing > 0)
    throw std::runtime_error(sweep.arguments.output + ": " + std::to_string(table.missing) + " of " +
                             std::to_string(sweep.plan.rows.size()) +
                             " rows are missing; the command that started this sweep makes what is missing");
}

void run(Sweep& sweep, const std::vector<SweepJob>& jobs, InterruptGate& gate) {
  const SweepOutcome outcome = run_jobs(
      sweep.plan, jobs, sweep.shelf, sweep.results,
      {sweep.arguments.jobs, sweep.arguments.threads, picture_cache_folder(sweep.arguments.reference_cache)}, gate);
  std::cout << "results: " << outcome.rendered << " rendered, " << outcome.shared << " the same as one of these, "
            << outcome.stored << " kept from earlier" << std::endl;
  for (const std::string& failure : outcome.failures) std::cerr << "beampipe: failed: " << failure << "\n";
}

// The numbers of the parts that have something to do.
std::vector<std::size_t> unfinished_parts(const Sweep& sweep, std::size_t count) {
  std::vector<std::size_t> parts;
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<SweepJob> jobs = jobs_in(sweep.jobs, {i, count});
    if (!std::all_of(jobs.begin(), jobs.end(),
                     [&](const SweepJob& job) { return is_finished(sweep.plan, job, sweep.results); }))
      parts.push_back(i);
  }
  return parts;
}

void submit(Sweep& sweep, const std::vector<PlotColumns>& plots) {
  const SweepArguments& arguments = sweep.arguments;
  SlurmRequest request;
  request.all_parts = std::min(sweep.jobs.size(), kMostTasks);
  request.parts = unfinished_parts(sweep, request.all_parts);
  if (request.parts.empty()) return merge(sweep, plots);
  request.command =
      arguments.start.empty() ? std::vector{fs::read_symlink("/proc/self/exe").string()} : arguments.start;
  request.command.insert(request.command.end(),
                         {"sweep", fs::absolute(arguments.plan).string(), "-o", sweep.output.path().string()});
  if (arguments.allow_outside) request.command.push_back("--allow-outside");
  if (const std::string& named = arguments.reference_cache; !named.empty()) {
    const fs::path pictures = picture_cache_folder(named);
    request.command.insert(request.command.end(),
                           {"--reference-cache", pictures.empty() ? named : fs::absolute(pictures).string()});
  }
  for (const std::string& plot : arguments.plots) {
    request.merge.push_back("--plot");
    request.merge.push_back(plot);
  }
  request.options = arguments.sbatch;
  if (arguments.dry_run) {
    write_scripts(request, sweep.output);
    std::cout << "nothing was submitted; these commands do it, with the number of the first job in place of JOB:\n"
              << "sbatch " << array_arguments(request, sweep.output) << "\nsbatch "
              << merge_arguments("JOB", sweep.output) << "\n";
    return;
  }
  const SlurmJobs jobs = submit(request, sweep.output);
  std::cout << "submitted: job " << jobs.array << ", " << request.parts.size() << " of " << request.all_parts
            << " tasks, and job " << jobs.merge
            << ", which then makes the table\nlogs: " << (arguments.output / fs::path("slurm")).string()
            << "\nThe same command submits what is missing, if a task fails.\n";
}

void check(const SweepArguments& arguments) {
  if (arguments.slurm + arguments.merge + !arguments.part.empty() > 1)
    throw UsageError("--slurm, --merge and --part exclude each other");
  if (arguments.dry_run && !arguments.slurm) throw UsageError("--dry-run: expected --slurm beside it");
  for (const std::string& option : arguments.sbatch) {
    const std::string name = option.substr(0, option.find('='));
    const bool is_name = !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == name.npos;
    if (!is_name || name.front() == '-' || option.find_first_of("\r\n") != option.npos)
      throw UsageError("--sbatch " + option + ": expected NAME=VALUE or NAME, an option of sbatch without its dashes");
    if (std::set<std::string>{"array", "dependency", "output", "parsable"}.contains(name))
      throw UsageError("--sbatch " + option + ": is set by the sweep");
  }
}

void sweep(const SweepArguments& arguments, InterruptGate& gate) {
  check(arguments);
  Sweep sweep(arguments, gate);
  const std::vector<PlotColumns> plots = parse_plots(sweep);
  require_writable_folder(sweep.output.path());
  if (!arguments.part.empty()) return run(sweep, jobs_in(sweep.jobs, parse_part(arguments.part)), gate);
  check_traces(sweep);
  if (arguments.slurm) return submit(sweep, plots);
  if (!arguments.merge) {
    sweep.output.lock();
    run(sweep, sweep.jobs, gate);
  }
  merge(sweep, plots);
}

}  // namespace

void add_sweep_command(CommandLine& line, const std::vector<std::string>& start, InterruptGate& gate) {
  const auto arguments = std::make_shared<SweepArguments>();
  arguments->start = start;
  Command command =
      line.add_command("sweep", "Vary techniques, caches and hardware, and make one table of the results");
  command.add("PLAN", arguments->plan, "what is varied: a JSON file, see below").required();
  command.add("-o,--output", arguments->output, "the folder for the results; it is created if necessary").required();
  command
      .add("--jobs", arguments->jobs,
           "render N cells at a time, or fewer if they need more than half of the memory (default: one per processor "
           "core)")
      .between(1, 1024);
  command.add("--threads", arguments->threads, "threads per cell (default: the cores, shared among the cells)")
      .between(1, 1024);
  command.add("--plot", arguments->plots,
              "X,Y,BY: draw column Y of the table against column X as SVG, with a line for each value of column BY, "
              "as means over traces and sizes; one plot for each combination of what else is varied. Both axes are "
              "logarithmic. May be repeated. Needs the program gnuplot");
  add_reference_cache(command, arguments->reference_cache);
  command.add_flag("--allow-outside", arguments->allow_outside, "allow traces to name files outside their own folder");
  Command cluster = command.add_group("On several machines, which share the output folder");
  cluster.add_flag("--slurm", arguments->slurm,
                   "submit the sweep to Slurm: an array of tasks, one for each group of cells that share a rendering "
                   "but at most 256, and a job that waits for them and makes the table");
  cluster.add_flag("--dry-run", arguments->dry_run,
                   "with --slurm: write the scripts, and print the commands that would submit them");
  cluster.add("--sbatch", arguments->sbatch, "options of sbatch for these jobs, without their dashes: time=2:00:00");
  cluster.add("--part", arguments->part, "I/N: do part I of N alone (I from 0), and make no table");
  cluster.add_flag("--merge", arguments->merge, "render nothing, and make the table of the results that are there");
  command.footer(kSweepFooter);
  command.set_work([arguments, &gate] { sweep(*arguments, gate); });
}

}  // namespace beampipe

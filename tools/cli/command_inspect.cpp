// beampipe inspect: what happened in a pixel, and why it is wrong.

#include <langinfo.h>
#include <locale.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <memory>

#include "pipeline/spec.h"
#include "tools/cli/commands.h"
#include "tools/cli/record_inspections.h"
#include "tools/cli/run_arguments.h"
#include "tools/cli/trace_view.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/evaluate/results.h"
#include "tools/files/output.h"
#include "tools/inspect/inspection.h"
#include "tools/inspect/inspection_json.h"
#include "tools/inspect/inspection_picture.h"
#include "tools/inspect/inspection_text.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

constexpr const char* kInspectFooter =
    R"(Prints the history of a pixel:
  Fragments   the triangles that touch it, in the technique's order: exact area, depths (-1 near to 0 far), the mask
              positions or samples that each covers, takes and loses
  Positions   or Samples: a picture of who has which part of the pixel, and of what each fragment covers
  Steps       what the technique did: merges, and surfaces that retire
  Weights     the part of the pixel that each triangle has, and should have by the reference
  Where the area went   which surface gained or lost how much, by the causes of `beampipe compare --causes`
Triangles are numbered as `beampipe export-soup` writes them. Weights times colours, plus what formats and limits
changed, are the bits of the picture that `beampipe run` writes. Captured frames store sRGB: there they are the bits of
what is stored. Where draws keep the API's order, weights are what each has put into the pixel in the end; there are none
of the reference, and no causes.

Examples:
  beampipe inspect fence.json --pixel 160,90 -t beam msaa:8
  beampipe inspect fence.json --worst 3 -t beam -o worst.svg      (the three worst pixels as a picture)
  beampipe inspect fence.json --pixel 160,90 -t beam --json

Techniques: )";

struct InspectArguments {
  std::string trace, output;
  TraceView view;
  std::vector<std::string> pixels, specs;
  std::uint32_t worst = 0;
  std::size_t frame = 0;
  int threads = 0;
  bool json = false, allow_outside = false;
};

bool is_picture(const std::string& file, const char* ending) { return std::string_view(file).ends_with(ending); }

// Does standard output go to a terminal that shows UTF-8?
bool shows_unicode() {
  if (!isatty(STDOUT_FILENO)) return false;
  const locale_t locale = newlocale(LC_CTYPE_MASK, "", locale_t{});
  if (!locale) return false;
  const bool is_utf8 = std::strcmp(nl_langinfo_l(CODESET, locale), "UTF-8") == 0;
  freelocale(locale);
  return is_utf8;
}

std::vector<PixelInspection> inspect_all(const InspectArguments& arguments, const Trace& trace,
                                         const std::vector<Technique>& techniques) {
  const Frame& frame = trace.frames[arguments.frame];
  std::vector<PixelAddress> pixels;
  for (const std::string& text : arguments.pixels) pixels.push_back(parse_pixel("--pixel", text, frame));
  const TextureSet textures(trace, arguments.trace);
  tell_notes(notes_of(trace, {arguments.frame}, textures.programs(), drawing_by_depth(techniques)));
  FrameInput run;
  run.threads = arguments.threads;
  run.memory.modelled = false;
  run.memory_limit = machine_memory() / 2;
  run.textures = &textures;
  Image reference;
  if (arguments.worst > 0) reference = parse_technique(kReferenceSpec).render(trace, arguments.frame, run).image;
  std::vector<PixelInspection> inspections;
  for (const Technique& technique : techniques) {
    if (arguments.worst > 0)
      pixels = worst_pixels(technique.render(trace, arguments.frame, run).image, reference, arguments.worst);
    for (PixelInspection& each : inspect(trace, arguments.frame, technique, pixels, run))
      inspections.push_back(std::move(each));
  }
  return inspections;
}

void print_json(const std::vector<PixelInspection>& inspections, const InspectArguments& arguments) {
  Json json = {{"beampipe_inspect", 1},
               {"version", program_version()},
               {"trace", arguments.trace},
               {"frame", arguments.frame},
               {"pixels", Json::array()}};
  for (const PixelInspection& each : inspections) json["pixels"].push_back(to_json(each));
  std::cout << json_text(json);
}

void run_inspection(const InspectArguments& arguments, InterruptGate& gate) {
  if (arguments.pixels.empty() == (arguments.worst == 0))
    throw UsageError("expected either --pixel X,Y or --worst N (see beampipe inspect --help)");
  const std::vector<Technique> techniques = parse_techniques(arguments.specs);
  for (const Technique& technique : techniques) require_inspectable(technique);
  const bool is_svg = is_picture(arguments.output, ".svg"), is_page = is_picture(arguments.output, ".html");
  std::filesystem::path file;
  if (!arguments.output.empty()) {
    if (!is_svg && !is_page)
      throw UsageError("-o " + arguments.output + ": expected a name that ends in .svg or .html");
    file = std::filesystem::absolute(arguments.output);
    require_writable_file(file);
  }
  Trace trace = read_trace(arguments.trace, {.allow_outside = arguments.allow_outside});
  if (arguments.frame >= trace.frames.size())
    throw UsageError("--frame: expected 0 to " + std::to_string(trace.frames.size() - 1) + ", found " +
                     std::to_string(arguments.frame));
  apply(arguments.view, {arguments.frame}, arguments.trace, trace);
  for (const Technique& technique : techniques)
    require_memory(trace, trace.frames[arguments.frame], technique.working_bytes_per_pixel,
                   "frame " + std::to_string(arguments.frame) + " with " + technique.spec, machine_memory());
  const std::vector<PixelInspection> inspections = inspect_all(arguments, trace, techniques);
  if (arguments.json) {
    print_json(inspections, arguments);
  } else {
    for (std::size_t i = 0; i < inspections.size(); ++i)
      std::cout << (i > 0 ? "\n" : "") << inspection_text(inspections[i], arguments.trace, shows_unicode());
  }
  if (arguments.output.empty()) return;
  const std::string name = std::filesystem::path(arguments.trace).filename().string();
  OutputFolder output(file.parent_path(), gate);
  output.write(file.filename(), is_svg ? inspections_svg(inspections, name) : inspections_html(inspections, name));
  output.keep();
}

}  // namespace

void add_inspect_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<InspectArguments>();
  Command command =
      line.add_command("inspect", "Explain a pixel: its triangles, what became of each, and why the pixel is wrong");
  command.add("TRACE", arguments->trace, "the trace, a JSON file").required();
  command.add("-t,--technique", arguments->specs, "one or more techniques; this option may be repeated").required();
  command.add("--pixel", arguments->pixels, "X,Y of one or more pixels; 0,0 is the upper left one");
  command.add("--worst", arguments->worst, "in place of --pixel: the N pixels that are farthest from the reference")
      .between(1, 1000);
  command.add("--frame", arguments->frame, "the frame; the first one is 0 (default: 0)");
  add_trace_view_options(command, arguments->view);
  command.add("-o,--output", arguments->output,
              "also write one picture (.svg), or one page with the text as well (.html)");
  command.add_flag("--json", arguments->json, "print the result as JSON");
  command.add("--threads", arguments->threads, "the number of threads (default: one per processor core)")
      .between(1, 1024);
  command.add_flag("--allow-outside", arguments->allow_outside, "allow the trace to name files outside its own folder");
  command.footer(kInspectFooter + list_of(inspectable_names(), "and") + " can be inspected.\n\n");
  command.set_work([arguments, &gate] { run_inspection(*arguments, gate); });
}

}  // namespace beampipe

// beampipe check-capture: compares the depths of a captured trace's frames with those of the program itself.

#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "tools/cli/commands.h"
#include "tools/cli/run_arguments.h"
#include "tools/evaluate/captured_check.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/files/image_io.h"
#include "tools/files/output.h"
#include "tools/report/report_text.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

constexpr std::size_t kShownDraws = 10;

struct CheckArguments {
  std::string trace, output, frames;
  bool json = false, allow_outside = false;
};

std::string name_of(const DrawDifference& draw) {
  return draw.draw == kNoDraw ? "none (only in the program)" : std::to_string(draw.draw);
}

Json to_json(std::size_t frame, const CapturedCheck& check) {
  Json json = {{"index", frame},
               {"covered_here", check.here},
               {"covered_in_program", check.there},
               {"covered_in_both", check.both},
               {"coverage", check.coverage()},
               {"depths_within_1e-4", check.close_part()},
               {"depths_within_1e-6", check.equal_part()},
               {"largest_difference", check.largest},
               {"draws", Json::array()}};
  for (const DrawDifference& draw : check.draws) {
    json["draws"].push_back({{"draw", draw.draw == kNoDraw ? Json() : Json(draw.draw)},
                             {"pixels", draw.pixels},
                             {"differing_pixels", draw.differing},
                             {"largest_difference", draw.largest}});
  }
  return json;
}

std::string text_of(std::size_t frame, const CapturedCheck& check) {
  char line[256];
  std::snprintf(line, sizeof line,
                "frame %zu: %llu pixels are covered, %.3f %% of them in both; depth within 1e-6: %.3f %%, within 1e-4: "
                "%.3f %%, largest difference %.3g\n",
                frame, static_cast<unsigned long long>(check.here + check.there - check.both), 100 * check.coverage(),
                100 * check.equal_part(), 100 * check.close_part(), check.largest);
  if (check.draws.empty()) return line;
  std::vector<std::vector<std::string>> rows = {{"draw", "pixels", "differ", "by up to"}};
  for (std::size_t i = 0; i < check.draws.size() && i < kShownDraws; ++i) {
    const DrawDifference& draw = check.draws[i];
    char largest[32];
    std::snprintf(largest, sizeof largest, "%.3g", draw.largest);
    rows.push_back({name_of(draw), std::to_string(draw.pixels), std::to_string(draw.differing), largest});
  }
  return line + align_columns(rows, {0});
}

void check_capture(const CheckArguments& arguments, InterruptGate& gate) {
  Trace trace = read_trace(arguments.trace, {.allow_outside = arguments.allow_outside});
  ignore_blending(trace);
  const std::vector<std::size_t> frames = parse_frame_range(arguments.frames, trace.frames.size());
  std::optional<OutputFolder> output;
  if (!arguments.output.empty()) {
    require_writable_folder(arguments.output);
    output.emplace(arguments.output, gate);
  }
  const TextureSet textures(trace);
  const std::vector<DrawNote> notes = notes_of(trace, frames, textures.programs());
  tell_notes(notes);
  Json json = {{"beampipe_check_capture", 1}, {"trace", arguments.trace}, {"frames", Json::array()}};
  if (!notes.empty()) json["notes"] = notes_form().write(notes);
  std::string text;
  for (const std::size_t i : frames) {
    const Frame& frame = trace.frames[i];
    if (frame.capture.pictures.depth.empty()) {
      text += "frame " + std::to_string(i) + ": the trace has no captured depth\n";
      continue;
    }
    // A pixel's depths, and what is rasterized at a time.
    require_memory(trace, frame, 64, "frame " + std::to_string(i), machine_memory());
    const CentreDepths found = centre_depths(trace, frame, &textures);
    const CapturedCheck check = check_captured(frame, found);
    json["frames"].push_back(to_json(i, check));
    text += text_of(i, check);
    if (!output) continue;
    char name[48];
    std::snprintf(name, sizeof name, "frame_%04zu_depth.png", i);
    output->write(name, encode_png(frame.width, frame.height, difference_picture(frame, found)));
    output->keep();
  }
  std::cout << (arguments.json ? json_text(json) : text);
}

}  // namespace

void add_check_capture_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<CheckArguments>();
  Command command =
      line.add_command("check-capture", "Compare the depths of a captured trace with those of the captured program");
  command.add("TRACE", arguments->trace, "a trace that was captured from a program, a JSON file").required();
  command.add("-o,--output", arguments->output, "the folder for pictures of where depths differ");
  command.add("--frames", arguments->frames,
              "check only frames A-B of the trace, or frame A; the first frame is 0 (default: all)");
  command.add_flag("--json", arguments->json, "print the result as JSON");
  command.add_flag("--allow-outside", arguments->allow_outside, "allow the trace to name files outside its own folder");
  command.footer(
      "Draws what writes depth, with one sample at each pixel's centre, and compares it with the depth buffer in the\n"
      "trace. Prints the share of covered pixels that both cover, the share of those whose depths agree to 1e-6 and "
      "to\n"
      "1e-4, and the ten draws with the most pixels that differ by more. In the pictures, green pixels are equal, "
      "yellow\n"
      "ones close and red ones different; blue pixels are covered only here, magenta ones only in the program. The "
      "exit\n"
      "code is 0 even if depths differ.");
  command.set_work([arguments, &gate] { check_capture(*arguments, gate); });
}

}  // namespace beampipe

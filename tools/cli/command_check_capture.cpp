// beampipe check-capture: compares the depths and the pictures of a captured trace's frames with those of the program
// itself.

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "tools/cli/commands.h"
#include "tools/cli/run_arguments.h"
#include "tools/evaluate/captured_check.h"
#include "tools/evaluate/captured_colors.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/files/output.h"
#include "tools/report/report_text.h"
#include "traces/files/image_file.h"
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

// The technique that draws as many samples of each pixel as the program.
Technique technique_of(const Frame& frame) {
  return parse_technique("msaa:" + std::to_string(frame.capture.pictures.samples));
}

Json to_json(const std::vector<DrawDifference>& draws) {
  Json json = Json::array();
  for (const DrawDifference& draw : draws) {
    json.push_back({{"draw", draw.draw == kNoDraw ? Json() : Json(draw.draw)},
                    {"pixels", draw.pixels},
                    {"differing_pixels", draw.differing},
                    {"largest_difference", draw.largest}});
  }
  return json;
}

Json to_json(const CapturedCheck& check) {
  return {{"covered_here", check.here},
          {"covered_in_program", check.there},
          {"covered_in_both", check.both},
          {"coverage", check.coverage()},
          {"depths_within_1e-4", check.close_part()},
          {"depths_within_1e-6", check.equal_part()},
          {"largest_difference", check.largest},
          {"draws", to_json(check.draws)}};
}

Json to_json(const Technique& technique, const ColorCheck& check) {
  return {{"technique", technique.spec},
          {"pixels", check.pixels},
          {"within_2_codes", check.close_part()},
          {"largest_difference", check.largest},
          {"draws", to_json(check.draws)}};
}

std::string text_of(const std::vector<DrawDifference>& draws) {
  if (draws.empty()) return "";
  std::vector<std::vector<std::string>> rows = {{"draw", "pixels", "differ", "by up to"}};
  for (std::size_t i = 0; i < draws.size() && i < kShownDraws; ++i) {
    char largest[32];
    std::snprintf(largest, sizeof largest, "%.3g", draws[i].largest);
    rows.push_back({name_of(draws[i]), std::to_string(draws[i].pixels), std::to_string(draws[i].differing), largest});
  }
  return align_columns(rows, {0});
}

std::string text_of(const CapturedCheck& check) {
  char line[256];
  std::snprintf(line, sizeof line,
                "%llu pixels are covered, %.3f %% of them in both; depth within 1e-6: %.3f %%, within 1e-4: %.3f %%, "
                "largest difference %.3g\n",
                static_cast<unsigned long long>(check.here + check.there - check.both), 100 * check.coverage(),
                100 * check.equal_part(), 100 * check.close_part(), check.largest);
  return line + text_of(check.draws);
}

std::string text_of(const Technique& technique, const ColorCheck& check) {
  char line[256];
  std::snprintf(line, sizeof line, "%s: %.3f %% of %llu pixels within 2/255 in all channels, largest difference %d\n",
                technique.spec.c_str(), 100 * check.close_part(), static_cast<unsigned long long>(check.pixels),
                check.largest);
  return line + text_of(check.draws);
}

bool is_captured(const Frame& frame) { return !frame.capture.pictures.depth.empty() || frame.capture.pictures.color; }

// One frame's check.
class FrameCheck {
 public:
  // Adds to `notes` what the picture shows.
  FrameCheck(const Trace& trace, std::size_t number, const TextureSet& textures, std::vector<DrawNote>& notes,
             OutputFolder* output)
      : trace_(trace),
        number_(number),
        frame_(trace.frames[number]),
        textures_(textures),
        notes_(notes),
        output_(output) {
    // A pixel's depths, and what is rasterized at a time.
    require_memory(trace, frame_, 64, "frame " + std::to_string(number), machine_memory());
    found_ = sampled_depths(trace, frame_, &textures);
    if (frame_.capture.pictures.depth.empty())
      text_ += name() + "the trace has no captured depth\n";
    else
      check_depths();
    json_["index"] = number;
    if (frame_.capture.pictures.color) check_picture();
  }

  const Json& json() const { return json_; }
  const std::string& text() const { return text_; }

 private:
  std::string name() const { return "frame " + std::to_string(number_) + ": "; }

  void check_depths() {
    const CapturedCheck check = check_captured(frame_, found_);
    json_ = to_json(check);
    text_ += name() + text_of(check);
    write("depth", difference_picture(frame_, found_));
  }

  void check_picture() {
    const Technique technique = technique_of(frame_);
    FrameInput options;
    options.memory.modelled = false;
    options.memory_limit = machine_memory() / 2;
    options.textures = &textures_;
    const FrameResult result = technique.render(trace_, number_, options);
    add_stopped(trace_, number_, technique.spec, result.stopped, notes_);
    const ColorCheck check = check_colors(trace_, frame_, result.image, found_.draw);
    json_["colors"] = to_json(technique, check);
    text_ += name() + text_of(technique, check);
    write("colors", color_difference_picture(trace_, frame_, result.image));
  }

  void write(const char* what, const std::vector<std::uint8_t>& picture) const {
    if (output_ == nullptr) return;
    char file[48];
    std::snprintf(file, sizeof file, "frame_%04zu_%s.png", number_, what);
    output_->write(file, encode_png(frame_.width, frame_.height, picture));
    output_->keep();
  }

  const Trace& trace_;
  std::size_t number_;
  const Frame& frame_;
  const TextureSet& textures_;
  std::vector<DrawNote>& notes_;
  OutputFolder* output_;
  SampledDepths found_;
  Json json_;
  std::string text_;
};

void check_capture(const CheckArguments& arguments, InterruptGate& gate) {
  const Trace trace = read_trace(arguments.trace, {.allow_outside = arguments.allow_outside});
  const std::vector<std::size_t> frames = parse_frame_range(arguments.frames, trace.frames.size());
  std::optional<OutputFolder> output;
  if (!arguments.output.empty()) {
    require_writable_folder(arguments.output);
    output.emplace(arguments.output, gate);
  }
  if (std::ranges::none_of(frames, [&](std::size_t i) { return is_captured(trace.frames[i]); }))
    throw std::runtime_error(arguments.trace +
                             ": expected the captured program's depths or picture, which `beampipe capture` records, "
                             "found none");
  const TextureSet textures(trace);
  std::vector<DrawNote> notes = notes_of(trace, frames, textures.programs(), "");
  Json json = {{"beampipe_check_capture", 1}, {"trace", arguments.trace}, {"frames", Json::array()}};
  std::string text;
  for (const std::size_t i : frames) {
    const FrameCheck check(trace, i, textures, notes, output ? &*output : nullptr);
    json["frames"].push_back(check.json());
    text += check.text();
  }
  tell_notes(notes);
  if (!notes.empty()) json["notes"] = notes_form().write(notes);
  std::cout << (arguments.json ? json_text(json) : text);
}

}  // namespace

void add_check_capture_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<CheckArguments>();
  Command command = line.add_command("check-capture",
                                     "Compare the depths and pictures of a captured trace with the captured program's");
  command.add("TRACE", arguments->trace, "a trace that was captured from a program, a JSON file").required();
  command.add("-o,--output", arguments->output, "the folder for pictures of where depths and colours differ");
  command.add("--frames", arguments->frames,
              "check only frames A-B of the trace, or frame A; the first frame is 0 (default: all)");
  command.add_flag("--json", arguments->json, "print the result as JSON");
  command.add_flag("--allow-outside", arguments->allow_outside, "allow the trace to name files outside its own folder");
  command.footer(
      "Depth: draws what writes depth, at the first of each pixel's samples, and compares it with the depth buffer in\n"
      "the trace. Prints the share of covered pixels that both cover, the share of those whose depths agree to 1e-6\n"
      "and to 1e-4, and the ten draws with the most pixels that differ by more. In the pictures, green pixels are\n"
      "equal, yellow ones close and red ones different; blue pixels are covered only here, magenta ones only in the\n"
      "program.\n"
      "Colour: draws the frame with as many samples as the program had, and compares it with the picture in the "
      "trace,\n"
      "as codes of 8 bits. Prints the share of pixels that differ by at most 2 in all channels, and the ten draws "
      "with\n"
      "the most that differ by more. The pictures show eight times the difference.\n"
      "The exit code is 0 even if frames differ.");
  command.set_work([arguments, &gate] { check_capture(*arguments, gate); });
}

}  // namespace beampipe

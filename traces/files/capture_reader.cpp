#include "traces/files/capture_reader.h"

#include <bit>
#include <limits>

#include "traces/size_text.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kMostSamples = 16;  // whose places are a standard

Form<RenderPass> pass_form() {
  const Form<std::uint32_t> count = form::integer(0, kMost);
  return ObjectForm<RenderPass>()
      .required("name", &RenderPass::name, form::text(), "What the targets are called.")
      .optional("width", &RenderPass::width, count, "Size of the target, in pixels.")
      .optional("height", &RenderPass::height, count, "Size of the target, in pixels.")
      .optional("draws", &RenderPass::draws, count, "How many there are.")
      .optional("triangles", &RenderPass::triangles, count, "How many they have together.")
      .required("kept", &RenderPass::kept, form::boolean(), "Whether the trace has its draws.")
      .optional("reason", &RenderPass::reason, form::text(), "Why it was kept or not.");
}

Form<LeftOut> left_out_form() {
  const Form<std::uint32_t> count = form::integer(0, kMost);
  return ObjectForm<LeftOut>()
      .required("reason", &LeftOut::reason, form::text(), "Why they are left out.")
      .optional("draws", &LeftOut::draws, count, "How many there are.")
      .optional("primitives", &LeftOut::primitives, count, "How many they have together.");
}

// A trace's pictures have its size, which is known when they are read.
Form<Frame> captured_form(const std::vector<TextureImage>& images, const NameIndex& names, const ArrayReader& arrays) {
  const auto read_color = [&images, &names](const JsonCursor& at, Frame& frame) {
    const std::uint32_t number = read_name(at, names, "the name of an image in /images");
    frame.capture.pictures.color = number;
    if (images[number].width != frame.width || images[number].height != frame.height)
      at.fail("an image of the frame's size, " + size_text(frame.width, frame.height),
              size_text(images[number].width, images[number].height));
  };
  const auto read_depth = [&arrays](const JsonCursor& at, Frame& frame) {
    frame.capture.pictures.depth = arrays.numbers(at);
    const std::vector<float>& depth = frame.capture.pictures.depth;
    if (depth.size() != std::size_t{frame.width} * frame.height)
      at.fail("a depth for each pixel of " + size_text(frame.width, frame.height), std::to_string(depth.size()));
    for (const float value : depth)
      if (!(value >= 0 && value <= 1)) at.fail("depths 0..1", std::to_string(value));
  };
  return ObjectForm<Frame>()
      .add({"color", "The name of one of `images`, of the frame's size.", false, form::text().schema, read_color})
      .add({"depth", "The window depth of each pixel, 0..1, row by row; row 0 is on top.", false,
            numbers_schema(form::number().schema), read_depth})
      .optional(
          "clear_depth", [](auto& frame) -> auto& { return frame.capture.pictures.clear_depth; }, form::fraction(),
          "The window depth where nothing was drawn.")
      .add({"samples", "How many samples of each pixel the program drew: 1, 2, 4, 8 or 16; 1 when left out.", false,
            form::integer(1, kMostSamples).schema, [](const JsonCursor& at, Frame& frame) {
              frame.capture.pictures.samples = at.integer(1, kMostSamples);
              if (!std::has_single_bit(frame.capture.pictures.samples)) at.fail("1, 2, 4, 8 or 16");
            }});
}

}  // namespace

Form<Source> source_form() {
  const Form<std::string> text = form::text();
  return ObjectForm<Source>()
      .optional("program", &Source::program, text, "The program that was captured.")
      .optional("api", &Source::api, text, "What it draws with, such as OpenGL.")
      .optional("driver", &Source::driver, text, "The driver and device.")
      .optional("date", &Source::date, text, "The day of the capture.")
      .optional("tool", &Source::tool, text, "What captured it.")
      .optional("shading", &Source::shading, text, "Where the colours come from.")
      .optional("frame", &Source::frame, form::integer(0, kMost), "The number of the first frame.");
}

void add_capture(ObjectForm<Frame>& frame, const std::vector<TextureImage>& images, const NameIndex& names,
                 const ArrayReader& arrays) {
  const Form<Frame> captured = captured_form(images, names, arrays);
  frame
      .optional(
          "passes", [](auto& each) -> auto& { return each.capture.passes; }, form::list(pass_form()),
          "Draws of a frame into the same targets; for information.")
      .optional(
          "left_out", [](auto& each) -> auto& { return each.capture.left_out; }, form::list(left_out_form()),
          "What the program drew and the trace lacks; for information.")
      .add({"captured",
            "The pictures that the program itself made of the frame; `beampipe check-capture` compares with them.",
            false, captured.schema, captured.read});
}

}  // namespace beampipe

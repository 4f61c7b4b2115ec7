#include "traces/files/capture_reader.h"

#include <limits>

namespace beampipe {
namespace {

constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();

void read_text(const JsonCursor& at, const char* key, std::string& result) {
  if (const auto found = at.find(key)) result = found->string();
}

void read_count(const JsonCursor& at, const char* key, std::uint32_t& result) {
  if (const auto found = at.find(key)) result = found->integer(0, kMost);
}

RenderPass read_pass(const JsonCursor& at) {
  at.expect_keys({"name", "width", "height", "draws", "triangles", "kept", "reason"});
  RenderPass pass;
  pass.name = at["name"].string();
  read_count(at, "width", pass.width);
  read_count(at, "height", pass.height);
  read_count(at, "draws", pass.draws);
  read_count(at, "triangles", pass.triangles);
  pass.kept = at["kept"].boolean();
  read_text(at, "reason", pass.reason);
  return pass;
}

LeftOut read_left_out(const JsonCursor& at) {
  at.expect_keys({"reason", "draws", "primitives"});
  LeftOut left_out;
  left_out.reason = at["reason"].string();
  read_count(at, "draws", left_out.draws);
  read_count(at, "primitives", left_out.primitives);
  return left_out;
}

CapturedPictures read_pictures(const JsonCursor& at, const Frame& frame, const std::vector<TextureImage>& images,
                               const NameIndex& image_names, const ArrayReader& arrays) {
  at.expect_keys({"color", "depth", "clear_depth"});
  CapturedPictures pictures;
  const std::string size = std::to_string(frame.width) + " x " + std::to_string(frame.height);
  if (const auto color = at.find("color")) {
    pictures.color = read_name(*color, image_names, "the name of an image in /images");
    const TextureImage& image = images[*pictures.color];
    if (image.width != frame.width || image.height != frame.height) {
      color->fail("an image of the frame's size, " + size,
                  std::to_string(image.width) + " x " + std::to_string(image.height));
    }
  }
  if (const auto depth = at.find("depth")) {
    pictures.depth = arrays.numbers(*depth);
    if (pictures.depth.size() != std::size_t{frame.width} * frame.height) {
      depth->fail("a depth for each pixel of " + size, std::to_string(pictures.depth.size()));
    }
    for (const float value : pictures.depth)
      if (!(value >= 0 && value <= 1)) depth->fail("depths 0..1", std::to_string(value));
  }
  if (const auto clear = at.find("clear_depth")) pictures.clear_depth = clear->fraction();
  return pictures;
}

}  // namespace

Source read_source(const JsonCursor& at) {
  at.expect_keys({"program", "api", "driver", "date", "tool", "shading", "frame"});
  Source source;
  read_text(at, "program", source.program);
  read_text(at, "api", source.api);
  read_text(at, "driver", source.driver);
  read_text(at, "date", source.date);
  read_text(at, "tool", source.tool);
  read_text(at, "shading", source.shading);
  if (const auto frame = at.find("frame")) source.frame = frame->integer(0, kMost);
  return source;
}

CaptureRecord read_capture_record(const JsonCursor& at, const Frame& frame, const std::vector<TextureImage>& images,
                                  const NameIndex& image_names, const ArrayReader& arrays) {
  CaptureRecord record;
  if (const auto passes = at.find("passes"))
    for (const JsonCursor& pass : passes->elements()) record.passes.push_back(read_pass(pass));
  if (const auto left_out = at.find("left_out"))
    for (const JsonCursor& item : left_out->elements()) record.left_out.push_back(read_left_out(item));
  if (const auto captured = at.find("captured"))
    record.pictures = read_pictures(*captured, frame, images, image_names, arrays);
  return record;
}

}  // namespace beampipe

#include "traces/files/capture_writer.h"

namespace beampipe {
namespace {

void write_pass(TraceText& text, const RenderPass& pass) {
  text.open_object();
  text.put_key("name");
  text.put_text("a pass's name", pass.name);
  text.put_member("width", pass.width, 0u);
  text.put_member("height", pass.height, 0u);
  text.put_member("draws", pass.draws, 0u);
  text.put_member("triangles", pass.triangles, 0u);
  text.put_key("kept");
  text.put(pass.kept ? "true" : "false");
  text.put_member("reason", pass.reason);
  text.close_object();
}

void write_left_out(TraceText& text, const LeftOut& left_out) {
  text.open_object();
  text.put_key("reason");
  text.put_text("a reason", left_out.reason);
  text.put_member("draws", left_out.draws, 0u);
  text.put_member("primitives", left_out.primitives, 0u);
  text.close_object();
}

}  // namespace

void write_source(TraceText& text, const Source& source) {
  text.put(",\n\"source\": ");
  text.open_object();
  text.put_member("program", source.program);
  text.put_member("api", source.api);
  text.put_member("driver", source.driver);
  text.put_member("date", source.date);
  text.put_member("tool", source.tool);
  text.put_member("shading", source.shading);
  if (source.frame) {
    text.put_key("frame");
    text.put_number(*source.frame);
  }
  text.close_object();
}

void write_capture_record(TraceText& text, const CaptureRecord& record, const Trace& trace) {
  if (!record.passes.empty()) {
    text.put(",\n\"passes\": [");
    text.list(record.passes, [&](const RenderPass& pass) { write_pass(text, pass); });
    text.put("]");
  }
  if (!record.left_out.empty()) {
    text.put(",\n\"left_out\": [");
    text.list(record.left_out, [&](const LeftOut& left_out) { write_left_out(text, left_out); });
    text.put("]");
  }
  if (record.pictures == CapturedPictures{}) return;
  text.put(",\n\"captured\": ");
  text.open_object();
  if (record.pictures.color) {
    text.put_key("color");
    text.put_name("an image", trace.images[*record.pictures.color].name);
  }
  if (!record.pictures.depth.empty()) {
    text.put_key("depth");
    text.put_numbers("", record.pictures.depth);
  }
  text.put_member("clear_depth", record.pictures.clear_depth, 1.0f);
  text.put_member("samples", record.pictures.samples, 1u);
  text.close_object();
}

}  // namespace beampipe

#include <charconv>
#include <cmath>
#include <set>
#include <string_view>

#include "traces/atomic_file.h"
#include "traces/json.h"
#include "traces/trace_io.h"

namespace beampipe {
namespace {

constexpr std::size_t kChunk = 1 << 20;  // bytes that are written at once

class TraceWriter {
 public:
  explicit TraceWriter(const std::filesystem::path& file) : name_(file.string()), file_(file) {}

  void write(const Trace& trace) {
    check(trace);
    put("{\"beampipe_trace\": 1,\n\"meshes\": {");
    list(trace.meshes, [&](const Mesh& mesh) { write_mesh(mesh); });
    put("},\n\"frames\": [");
    list(trace.frames, [&](const Frame& frame) { write_frame(frame, trace.meshes); });
    put("]}\n");
    file_.write(buffer_);
    file_.commit();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(name_ + ": cannot write the trace: " + what);
  }

  void check(const Trace& trace) const {
    if (trace.frames.empty()) fail("it has no frame");
    std::set<std::string> names;
    for (const Mesh& mesh : trace.meshes) {
      if (!names.insert(mesh.name).second) fail("two meshes are named " + in_quotes(mesh.name));
      if (mesh.colors.size() != mesh.triangles.size()) fail("mesh " + in_quotes(mesh.name) + " lacks colours");
    }
    for (const Frame& frame : trace.frames) {
      for (const Draw& draw : frame.draws) {
        if (draw.mesh >= trace.meshes.size()) fail("a draw names no mesh");
      }
    }
  }

  void put(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() < kChunk) return;
    file_.write(buffer_);
    buffer_.clear();
  }

  void put_string(const std::string& text) {
    try {
      put(json_string(text));
    } catch (const JsonError&) {
      fail("a mesh's name is not UTF-8");
    }
  }

  // The shortest text that a reader turns into the same bits.
  void put_number(double value) {
    if (!std::isfinite(value)) fail("a number in it is not finite");
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    put({text, end});
    if (value == 0 && std::signbit(value)) put(".0");  // a reader takes "-0" for an integer, which loses the sign
  }

  void put_number(float value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    double read = 0;
    std::from_chars(text, end, read);  // a reader rounds to double and then to float, which may give another float
    const bool same = std::isfinite(value) && value != 0 && static_cast<float>(read) == value;
    same ? put({text, end}) : put_number(static_cast<double>(value));
  }

  void put_number(std::uint32_t value) { put(std::to_string(value)); }

  template <typename Items, typename PutItem>
  void list(const Items& items, PutItem put_item) {
    const char* separator = "\n";
    for (const auto& item : items) {
      put(separator);
      put_item(item);
      separator = ",\n";
    }
  }

  template <typename Vector>
  void put_components(const Vector& vector) {
    for (int i = 0; i < Vector::length(); ++i) {
      if (i > 0) put(",");
      put_number(vector[i]);
    }
  }

  template <typename Vector>
  void put_array(const Vector& vector) {
    put("[");
    put_components(vector);
    put("]");
  }

  template <typename Vector>
  void put_array(const std::vector<Vector>& vectors) {
    put("[");
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      if (i > 0) put(",");
      put_components(vectors[i]);
    }
    put("]");
  }

  void put_array(const glm::dmat4& matrix) {
    put_array(std::vector<glm::dvec4>{matrix[0], matrix[1], matrix[2], matrix[3]});
  }

  template <typename Vector>
  void put_array(std::string_view key, const Vector& vector) {
    put(key);
    put_array(vector);
  }

  void write_mesh(const Mesh& mesh) {
    put_string(mesh.name);
    put_array(": {\"positions\": ", mesh.positions);
    put_array(",\n\"indices\": ", mesh.triangles);
    put_array(",\n\"colors\": ", mesh.colors);
    put("}");
  }

  void write_frame(const Frame& frame, const std::vector<Mesh>& meshes) {
    put("{\"width\": " + std::to_string(frame.width) + ", \"height\": " + std::to_string(frame.height));
    put_array(", \"background\": ", frame.background);
    if (frame.camera) {
      write_camera(*frame.camera);
    } else {
      put_array(",\n\"view\": ", frame.view);
      put_array(",\n\"projection\": ", frame.projection);
    }
    if (!frame.lighting.lights.empty()) {
      put_array(",\n\"light\": {\"direction\": ", frame.lighting.lights[0].direction);
      put("}");
    }
    put(",\n\"draws\": [");
    list(frame.draws, [&](const Draw& draw) { write_draw(draw, meshes[draw.mesh].name); });
    put("]}");
  }

  void write_camera(const Camera& camera) {
    put_array(",\n\"camera\": {\"eye\": ", camera.eye);
    put_array(", \"target\": ", camera.target);
    put_array(", \"up\": ", camera.up);
    put(", \"fovy_deg\": ");
    put_number(camera.fovy_deg);
    put(", \"near\": ");
    put_number(camera.near);
    put(", \"far\": ");
    put_number(camera.far);
    put("}");
  }

  void write_draw(const Draw& draw, const std::string& mesh) {
    put("{\"mesh\": ");
    put_string(mesh);
    if (draw.transform != glm::dmat4(1.0)) put_array(", \"transform\": ", draw.transform);
    if (draw.kd) put_array(", \"kd\": ", *draw.kd);
    if (draw.cull != Cull::none) put(draw.cull == Cull::back ? ", \"cull\": \"back\"" : ", \"cull\": \"front\"");
    if (draw.shading == Shading::lambert) put(", \"shading\": \"lambert\"");
    put("}");
  }

  std::string name_;
  AtomicFile file_;
  std::string buffer_;
};

}  // namespace

void write_trace(const Trace& trace, const std::filesystem::path& file) { TraceWriter(file).write(trace); }

}  // namespace beampipe

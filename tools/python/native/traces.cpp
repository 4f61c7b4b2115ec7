// Traces: from files, from scenes, and from arrays.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include "tools/python/native/bindings.h"
#include "tools/python/native/interruptible.h"
#include "tools/python/native/trace_handle.h"
#include "traces/files/model_import.h"
#include "traces/files/trace_io.h"
#include "traces/scenes.h"

namespace beampipe {

TraceHandle TraceHandle::resized(const PictureSize& size) const {
  if (size == PictureSize{}) return *this;
  Trace changed = *trace_;
  std::vector<std::size_t> frames(changed.frames.size());
  std::iota(frames.begin(), frames.end(), std::size_t{0});
  resize(changed, frames, size, name_);
  return {std::move(changed), name_};
}

const Frame& frame_of(const TraceHandle& trace, std::size_t frame) {
  const std::vector<Frame>& frames = trace.trace().frames;
  if (frame >= frames.size())
    throw std::runtime_error(trace.name() + ": expected a frame from 0 to " + std::to_string(frames.size() - 1) +
                             ", found " + std::to_string(frame));
  return frames[frame];
}

namespace {

namespace py = pybind11;

using IndexArray = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using MatrixArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error("trace: " + what); }

// The rows of an array of N x 3.
template <class Vector, class Array>
std::vector<Vector> rows_of(const Array& array, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != 3) fail(std::string(name) + ": expected an array of N x 3 numbers");
  std::vector<Vector> rows(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = {array.data()[3 * i], array.data()[3 * i + 1], array.data()[3 * i + 2]};
  return rows;
}

bool is_color(const glm::vec3& color) {
  return color.r >= 0 && color.g >= 0 && color.b >= 0 && std::max({color.r, color.g, color.b}) <= kMostColor;
}

std::vector<glm::vec3> colors_of(const FloatArray& array, const char* name) {
  std::vector<glm::vec3> colors = rows_of<glm::vec3>(array, name);
  if (!std::ranges::all_of(colors, is_color)) fail(std::string(name) + ": expected linear RGB from 0 to 65504");
  return colors;
}

Mesh mesh_of(const FloatArray& positions, const IndexArray& triangles, const FloatArray& colors) {
  Mesh mesh;
  mesh.name = "mesh";
  mesh.positions = rows_of<glm::vec3>(positions, "positions");
  const auto is_finite = [](const glm::vec3& at) {
    return std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z);
  };
  if (!std::ranges::all_of(mesh.positions, is_finite)) fail("positions: expected finite numbers");
  const auto count = static_cast<std::int64_t>(mesh.positions.size());
  const std::int64_t* const end = triangles.data() + triangles.size();
  if (std::any_of(triangles.data(), end, [&](std::int64_t index) { return index < 0 || index >= count; }))
    fail("triangles: expected indices from 0 to " + std::to_string(count - 1));
  mesh.triangles = rows_of<glm::uvec3>(triangles, "triangles");
  mesh.colors = colors_of(colors, "colors");
  if (mesh.colors.size() != mesh.triangles.size())
    fail("colors: expected one for each of " + std::to_string(mesh.triangles.size()) + " triangles, found " +
         std::to_string(mesh.colors.size()));
  return mesh;
}

Frame new_frame(const PictureSize& size, const FloatArray& background) {
  if (std::min(size.width, size.height) < 1 || std::max(size.width, size.height) > kMostPixels)
    fail("width and height: expected 1 to " + std::to_string(kMostPixels) + " pixels");
  if (background.ndim() != 1 || background.size() != 3) fail("background: expected linear RGB, three numbers");
  const glm::vec3 color{background.data()[0], background.data()[1], background.data()[2]};
  if (!is_color(color)) fail("background: expected linear RGB from 0 to 65504");
  Frame frame;
  frame.width = size.width, frame.height = size.height;
  frame.background = color;
  frame.draws.emplace_back();
  return frame;
}

void check(const Camera& camera) {
  if (!(camera.near > 0 && camera.near < camera.far && std::isfinite(camera.far)))
    fail("near and far: expected 0 < near < far");
  if (!(camera.fovy_deg > 0 && camera.fovy_deg < 180)) fail("fovy: expected an angle between 0 and 180 degrees");
  const double turn = glm::length(glm::cross(camera.target - camera.eye, camera.up));
  if (!(turn > 0 && std::isfinite(turn))) fail("eye, target and up: expected an up that is not the line of sight");
}

// Rows and columns as in mathematics: it multiplies column vectors.
glm::dmat4 matrix_of(const MatrixArray& array, const char* name) {
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    fail(std::string(name) + ": expected a matrix of 4 x 4 numbers");
  if (!std::all_of(array.data(), array.data() + 16, [](double number) { return std::isfinite(number); }))
    fail(std::string(name) + ": expected finite numbers");
  glm::dmat4 matrix;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix[column][row] = array.data()[4 * row + column];
  return matrix;
}

TraceHandle new_trace(Mesh mesh, Frame frame) {
  Trace trace;
  trace.meshes.push_back(std::move(mesh));
  trace.frames.push_back(std::move(frame));
  return {std::move(trace), "trace"};
}

TraceHandle make(const std::string& scene, const SceneOptions& options, std::uint32_t frames, double orbit,
                 const std::array<double, 2>& pan) {
  if (is_model_file(scene))
    throw std::runtime_error(scene + " is a model: expected a scene; `beampipe make " + scene + " -o " +
                             std::filesystem::path(scene).stem().string() + ".json` makes its trace, for open_trace()");
  return interruptible([&](const std::atomic<bool>&) {
    Trace trace = make_scene(scene, options);
    if (frames != 1 && pan == std::array<double, 2>{}) orbit_camera(trace, frames, orbit);
    if (frames != 1 && pan != std::array<double, 2>{}) pan_picture(trace, frames, pan[0], pan[1]);
    return TraceHandle(std::move(trace), scene);
  });
}

}  // namespace

void add_traces(py::module_& module) {
  py::class_<TraceHandle>(
      module, "Trace",
      "A recorded draw stream: frames of triangles. make(), open_trace() and trace_from_arrays() give one.")
      .def_property_readonly("name", &TraceHandle::name, "Its file or scene, as errors name it.")
      .def_property_readonly(
          "frames", [](const TraceHandle& self) { return self.trace().frames.size(); }, "The number of frames.")
      .def_property_readonly(
          "triangles",
          [](const TraceHandle& self) {
            std::size_t triangles = 0;
            for (const Mesh& mesh : self.trace().meshes) triangles += mesh.triangles.size();
            return triangles;
          },
          "The number of triangles in all meshes.")
      .def(
          "size",
          [](const TraceHandle& self, std::size_t frame) {
            const Frame& of = frame_of(self, frame);
            return py::make_tuple(of.width, of.height);
          },
          py::arg("frame") = 0, "(width, height) of a frame, in pixels.")
      .def(
          "resized",
          [](const TraceHandle& self, std::uint32_t width, std::uint32_t height) {
            return self.resized({width, height});
          },
          py::arg("width") = 0, py::arg("height") = 0,
          "The trace in this size, in pixels; 0: in proportion to the other side. The vertical angle of view stays.")
      .def(
          "save",
          [](const TraceHandle& self, const std::filesystem::path& file, bool binary) {
            write_trace(self.trace(), file, binary ? ArrayStorage::binary : ArrayStorage::text);
          },
          py::arg("file"), py::arg("binary") = false,
          "Writes the trace as JSON, or with its arrays in a binary file beside it.");
  module.def("open_trace", [](const std::filesystem::path& file, bool allow_outside) {
    return interruptible([&](const std::atomic<bool>&) {
      return TraceHandle(read_trace(file, {.allow_outside = allow_outside}), file.string());
    });
  });
  module.def("make", [](const std::string& scene, std::uint32_t triangles, std::uint64_t seed, std::uint32_t width,
                        std::uint32_t height, std::uint32_t frames, double orbit, const std::array<double, 2>& pan) {
    return make(scene, {triangles, seed, width, height}, frames, orbit, pan);
  });
  module.def("scenes", [] {
    std::vector<std::string> names;
    for (const SceneKind& kind : scene_kinds()) names.emplace_back(kind.name);
    return names;
  });
  using Triple = std::array<double, 3>;
  module.def("trace_with_camera",
             [](const FloatArray& positions, const IndexArray& triangles, const FloatArray& colors,
                const FloatArray& background, std::uint32_t width, std::uint32_t height, const Triple& eye,
                const Triple& target, const Triple& up, double fovy, double near, double far) {
               const auto vector = [](const Triple& of) { return glm::dvec3(of[0], of[1], of[2]); };
               const Camera camera{vector(eye), vector(target), vector(up), fovy, near, far};
               check(camera);
               Frame frame = new_frame({width, height}, background);
               set_camera(frame, camera);
               return new_trace(mesh_of(positions, triangles, colors), std::move(frame));
             });
  module.def("trace_with_matrices", [](const FloatArray& positions, const IndexArray& triangles,
                                       const FloatArray& colors, const FloatArray& background, std::uint32_t width,
                                       std::uint32_t height, const MatrixArray& view, const MatrixArray& projection) {
    Frame frame = new_frame({width, height}, background);
    frame.view = matrix_of(view, "view");
    frame.projection = matrix_of(projection, "projection");
    return new_trace(mesh_of(positions, triangles, colors), std::move(frame));
  });
}

}  // namespace beampipe

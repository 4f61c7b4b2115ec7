// The Python module beampipe._native.
#include <algorithm>
#include <stdexcept>

#include "tools/evaluate/picture_size.h"
#include "tools/evaluate/results.h"
#include "tools/python/native/bindings.h"

namespace beampipe {
namespace {

namespace py = pybind11;

void set_error(const std::exception& error) {
  PyErr_SetString(py::module_::import("beampipe.results").attr("Error").ptr(), error.what());
}

// Errors of beampipe, which are one line, become beampipe.Error. Those of Python and of pybind11 stay what they are.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::runtime_error& error) {
    set_error(error);
  } catch (const std::invalid_argument& error) {
    set_error(error);
  }
}

}  // namespace

Image image_of(const FloatArray& array, const char* name) {
  const bool is_picture = array.ndim() == 3 && (array.shape(2) == 3 || array.shape(2) == 4) && array.size() > 0;
  if (!is_picture || array.shape(0) > kMostPixels || array.shape(1) > kMostPixels)
    throw std::runtime_error(std::string(name) + ": expected an array of height x width x 3 or 4 numbers, found " +
                             py::str(py::tuple(array.attr("shape"))).cast<std::string>());
  const auto channels = static_cast<std::size_t>(array.shape(2));
  Image image{static_cast<std::uint32_t>(array.shape(1)), static_cast<std::uint32_t>(array.shape(0)), {}};
  const std::size_t pixels = std::size_t{image.width} * image.height;
  image.rgba.assign(4 * pixels, 1.0f);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    std::copy_n(array.data() + pixel * channels, channels, image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel));
  return image;
}

py::array_t<float> array_of(const std::vector<float>& values, const std::vector<py::ssize_t>& shape) {
  py::array_t<float> array(shape);
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

}  // namespace beampipe

PYBIND11_MODULE(_native, module) {
  module.doc() = "What the package beampipe calls. Its functions are documented in the package.";
  pybind11::register_local_exception_translator(beampipe::translate);
  module.attr("version") = beampipe::program_version();
  beampipe::add_traces(module);
  beampipe::add_rendering(module);
  beampipe::add_measures(module);
  beampipe::add_own_techniques(module);
}

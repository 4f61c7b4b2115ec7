// The parts of the Python module beampipe._native. Each function adds what its file has. The Python files beside this
// folder are what users call; they check arguments and explain them.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "pipeline/technique.h"

namespace beampipe {

void add_traces(pybind11::module_& module);
void add_rendering(pybind11::module_& module);
void add_measures(pybind11::module_& module);
void add_own_techniques(pybind11::module_& module);

// A contiguous array of floats, converted if it is another one.
using FloatArray = pybind11::array_t<float, pybind11::array::c_style | pybind11::array::forcecast>;

// height x width x 3 or 4 values of linear light; without A, it is 1. Throws std::runtime_error, one line that starts
// with `name`.
Image image_of(const FloatArray& array, const char* name);

// The values of a picture's pixels in an array of this shape.
pybind11::array_t<float> array_of(const std::vector<float>& values, const std::vector<pybind11::ssize_t>& shape);

}  // namespace beampipe

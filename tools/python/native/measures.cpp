// Errors of pictures, and equivalent MSAA rates.
#include "tools/evaluate/measures.h"

#include <pybind11/stl.h>

#include "tools/evaluate/blocks.h"
#include "tools/evaluate/msaa_ladder.h"
#include "tools/python/native/bindings.h"
#include "tools/python/native/interruptible.h"

namespace beampipe {
namespace {

namespace py = pybind11;

std::vector<Image> images_of(const std::vector<FloatArray>& arrays, const char* name) {
  std::vector<Image> images;
  for (const FloatArray& array : arrays) images.push_back(image_of(array, name));
  return images;
}

void check_pixels_per_degree(double value) {
  if (!(value >= 1 && value <= 1000)) throw std::runtime_error("pixels_per_degree: expected a number from 1 to 1000");
}

const Measure& find_measure(const std::string& key) {
  for (const Measure& measure : measures())
    if (measure.key == key) return measure;
  throw std::runtime_error("no measure is called " + key);
}

// The measures that have a value, and what equivalent rates compare: two dictionaries by key. `key` chooses one of
// those that take long; if it is empty, all are measured.
py::tuple measure(const std::vector<FloatArray>& pictures, const std::vector<FloatArray>& references,
                  double pixels_per_degree, const std::string& key) {
  check_pixels_per_degree(pixels_per_degree);
  const std::vector<Image> images = images_of(pictures, "image"), truths = images_of(references, "reference");
  const Measure* const only = key.empty() ? nullptr : key == "psnr" ? &find_metric(key) : &find_measure(key);
  std::vector<PicturePair> pairs;
  for (std::size_t i = 0; i < images.size(); ++i) pairs.push_back({images[i], truths.at(i)});
  const ErrorStats stats =
      interruptible([&](const std::atomic<bool>&) { return measure_frames(pairs, pixels_per_degree, only); });
  py::dict values, errors;
  for (const Measure& each : measures())
    if (const std::optional<double> value = each.value(stats)) values[each.key] = *value;
  for (const std::string& name : metric_names()) {
    const Measure& metric = find_metric(name);
    if (!metric.stored || stats.*metric.stored) errors[name.c_str()] = metric.error(stats);
  }
  return py::make_tuple(values, errors);
}

py::array_t<float> map(const std::string& key, const FloatArray& picture, const FloatArray& reference,
                       double pixels_per_degree) {
  check_pixels_per_degree(pixels_per_degree);
  const Measure& measure = find_measure(key);
  if (!measure.map) throw std::runtime_error(key + " has no map");
  const Image image = image_of(picture, "image"), truth = image_of(reference, "reference");
  const std::vector<float> values =
      interruptible([&](const std::atomic<bool>&) { return measure.map(image, truth, pixels_per_degree); });
  return array_of(values, {static_cast<py::ssize_t>(image.height), static_cast<py::ssize_t>(image.width)});
}

// The squared errors of each block of the pictures.
BlockSquares block_squares(const std::vector<FloatArray>& pictures, const std::vector<FloatArray>& references) {
  const std::vector<Image> images = images_of(pictures, "image"), truths = images_of(references, "reference");
  BlockSquares sums{};
  for (std::size_t i = 0; i < images.size(); ++i) add_block_squares(images[i], truths.at(i), sums);
  return sums;
}

// `blocks`: of the picture and of each rung, if errors are RMSEs. `reference_error`: that of the reference, if
// measured.
py::dict equivalent_rate(double error, const std::vector<std::pair<std::uint32_t, double>>& ladder,
                         const std::optional<std::pair<BlockSquares, std::vector<BlockSquares>>>& blocks,
                         const std::optional<double>& reference_error) {
  std::vector<LadderRung> rungs;
  std::vector<std::uint32_t> samples_of_rungs;
  for (const auto& [samples, rung_error] : ladder) {
    rungs.push_back({samples, rung_error});
    samples_of_rungs.push_back(samples);
  }
  std::vector<EmrRange> ranges;
  if (blocks) ranges.push_back(resampled_range(blocks->first, samples_of_rungs, blocks->second));
  if (reference_error) ranges.push_back(range_by_reference(error, rungs, *reference_error));
  const EquivalentMsaa rate = limited_equivalent_msaa(error, rungs, std::move(ranges));
  py::dict all;
  all["samples"] = rate.samples;
  all["is_lower_bound"] = rate.is_lower_bound;
  all["is_upper_bound"] = rate.is_upper_bound;
  all["does_not_converge"] = rate.does_not_converge;
  all["low"] = rate.low;
  all["high"] = rate.high;
  return all;
}

}  // namespace

void add_measures(py::module_& module) {
  module.attr("pixels_per_degree") = kPixelsPerDegree;
  module.attr("default_rungs") = default_rungs();
  module.attr("more_rungs") = more_rungs();
  module.attr("metric_names") = metric_names();
  module.attr("map_names") = map_names();
  py::dict meanings;
  for (const Measure& each : measures()) meanings[each.key] = py::make_tuple(each.title, each.unit, each.meaning);
  module.attr("meanings") = meanings;
  module.def("measure", &measure);
  module.def("map", &map);
  module.def("block_squares", &block_squares);
  module.def("equivalent_rate", &equivalent_rate);
}

}  // namespace beampipe

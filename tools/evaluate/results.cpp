#include "tools/evaluate/results.h"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "pipeline/technique_table.h"
#include "tools/files/digest.h"

namespace beampipe {

WallTime wall_time(std::vector<double> milliseconds) {
  if (milliseconds.empty()) throw std::invalid_argument("no run was timed");
  std::sort(milliseconds.begin(), milliseconds.end());
  const std::size_t runs = milliseconds.size();
  const double median = (milliseconds[(runs - 1) / 2] + milliseconds[runs / 2]) / 2;
  return {.median = median, .min = milliseconds.front(), .max = milliseconds.back(), .runs = static_cast<int>(runs)};
}

PixelCounterStats measure_counter(const std::vector<float>& values) {
  PixelCounterStats stats;
  for (const float value : values) {
    stats.mean += value / static_cast<double>(values.size());
    stats.max = std::max<double>(stats.max, value);
    stats.share += (value != 0) / static_cast<double>(values.size());
  }
  return stats;
}

std::string program_version() { return BEAMPIPE_VERSION; }

std::string program_digest() {
  Dl_info ignored;
  link_map* loaded = nullptr;
  const bool is_module = dladdr1(reinterpret_cast<const void*>(&program_digest), &ignored,
                                 reinterpret_cast<void**>(&loaded), RTLD_DL_LINKMAP) &&
                         loaded->l_name[0] != '\0';  // the executable's name is empty
  std::string digest = digest_of_file(is_module ? loaded->l_name : "/proc/self/exe");
  for (const TechniqueKind& kind : technique_kinds())
    if (!kind.code.empty()) digest = digest_of(digest + kind.name + " " + kind.code);
  return digest;
}

double TechniqueReport::peak_bytes_per_pixel() const {
  double most = 0;
  for (const FrameReport& frame : frames)
    if (frame.pixels > 0) most = std::max(most, frame.bytes_beside_framebuffer() / static_cast<double>(frame.pixels));
  return framebuffer_bytes_per_pixel + most;
}

double FrameReport::peak_bytes_of(std::string_view name) const {
  const auto found = std::ranges::find(buffers, name, &Buffer::name);
  return found == buffers.end() ? 0 : static_cast<double>(found->peak_bytes);
}

double TechniqueReport::on_chip_bytes_per_pixel() const {
  double most = 0;
  for (const FrameReport& frame : frames) {
    double bytes = 0;
    for (const Buffer& buffer : frame.buffers) bytes += buffer.per_bin ? static_cast<double>(buffer.peak_bytes) : 0.0;
    if (frame.bin_pixels > 0) most = std::max(most, bytes / static_cast<double>(frame.bin_pixels));
  }
  return most;
}

TechniqueReport new_technique_report(const Technique& technique, const MemoryParameters& memory,
                                     std::size_t frames_in_memory) {
  TechniqueReport report;
  report.frames = FrameReports(frames_in_memory);
  report.technique = technique.spec;
  report.framebuffer = technique.framebuffer.in_memory(memory);
  report.pixels_on_chip = technique.framebuffer.is_on_chip(memory);
  report.framebuffer_bytes_per_pixel = technique.framebuffer_bytes_per_pixel(memory);
  return report;
}

std::string spec_folder(std::string_view spec) {
  std::string folder(spec);
  for (char& c : folder) {
    const bool kept =
        (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '=' || c == '-';
    if (!kept) c = '_';
  }
  return folder;
}

std::string frame_stem(std::string_view spec, std::size_t frame) {
  char number[32];
  std::snprintf(number, sizeof number, "/frame_%04zu", frame);
  return spec_folder(spec) + number;
}

}  // namespace beampipe

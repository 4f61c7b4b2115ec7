// Rendering the first frame of a trace, such as those of test_traces.h, and looking at what came out.
#pragma once

#include "pipeline/technique.h"
#include "tests/pipeline/test_traces.h"
#include "tests/test.h"

namespace beampipe {

inline FrameResult render(const std::string& spec, const Trace& trace) {
  return parse_technique(spec).render(trace, 0, {1});
}
inline FrameResult render_with(const std::string& spec, const Trace& trace, const MemoryParameters& memory) {
  FrameInput run{1};
  run.memory = memory;
  return parse_technique(spec).render(trace, 0, run);
}
inline FrameResult render_unmodelled(const std::string& spec, const Trace& trace) {
  MemoryParameters memory;
  memory.modelled = false;
  return render_with(spec, trace, memory);
}
inline Image picture(const std::string& spec, const Trace& trace) { return render(spec, trace).image; }

inline glm::vec4 rgba_at(const Image& image, std::uint32_t x, std::uint32_t y) {
  const float* rgba = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
  return {rgba[0], rgba[1], rgba[2], rgba[3]};
}
inline glm::vec3 pixel(const Image& image, std::uint32_t x, std::uint32_t y) { return rgba_at(image, x, y); }

inline void expect_same(const FrameResult& a, const FrameResult& b, const std::string& what) {
  EXPECT_EQ(a.image.rgba, b.image.rgba) << what;
  EXPECT_EQ(a.pixel_counters, b.pixel_counters) << what;
  EXPECT_EQ(a.stages, b.stages) << what;
  for (std::size_t i = 0; i < a.stages.size() && i < b.stages.size(); ++i)
    EXPECT_EQ(a.stages[i].ops.wide, b.stages[i].ops.wide) << what << ": " << a.stages[i].stage;
  EXPECT_EQ(a.a_buffer_peak_bytes, b.a_buffer_peak_bytes) << what;
  EXPECT_EQ(a.buffers, b.buffers) << what;
  EXPECT_EQ(a.bin_pixels, b.bin_pixels) << what;
}

// Of a buffer, or of the A-buffer; 0 where there is none.
inline std::uint64_t bytes_of(const FrameResult& result, const std::string& name) {
  if (name == "a_buffer") return result.a_buffer_peak_bytes;
  for (const Buffer& buffer : result.buffers)
    if (buffer.name == name) return buffer.peak_bytes;
  return 0;
}

// Over R, G and B of all pixels.
inline double rmse(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (i % 4 != 3) sum += (double(a.rgba[i]) - b.rgba[i]) * (double(a.rgba[i]) - b.rgba[i]);
  return std::sqrt(sum / (0.75 * static_cast<double>(a.rgba.size())));
}

inline double worst_difference(const Image& a, const Image& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) worst = std::max(worst, std::abs(double{a.rgba[i]} - b.rgba[i]));
  return worst;
}

// Throws std::runtime_error when the frame has no such stage.
inline const StageCounters& stage_of(const FrameResult& result, const std::string& name) {
  for (const StageCounters& counters : result.stages)
    if (name_of(counters.stage) == name) return counters;
  throw std::runtime_error("no stage " + name);
}
inline StageCounters stage_of(FrameResult&& result, const std::string& name) {
  return stage_of(static_cast<const FrameResult&>(result), name);
}

// The stage in the depth pre-pass and in the other pass together.
inline StageCounters both_passes(const FrameResult& result, const std::string& name) {
  StageCounters sum = stage_of(result, name);
  return sum += stage_of(result, "prepass_" + name);
}

// The sum of a counter over all pixels.
inline double sum_of(const FrameResult& result, const std::string& counter) {
  const std::vector<float>& values = result.pixel_counters.at(counter);
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace beampipe

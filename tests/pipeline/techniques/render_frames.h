// Rendering with techniques that accumulate over frames.
#pragma once

#include "tests/pipeline/test_pictures.h"

namespace beampipe {

// Renders the same frame `frames` times and returns the last picture.
inline Image render_frames(const std::string& spec, const Trace& trace, std::size_t frames, int threads = 1) {
  const Technique technique = parse_technique(spec);
  History history;
  Image image;
  for (std::size_t i = 0; i < frames; ++i) image = technique.render(trace, 0, {threads, &history}).image;
  return image;
}

inline double red(const Image& image, std::uint32_t x, std::uint32_t y) {
  return image.rgba[4 * (std::size_t{y} * image.width + x)];
}

}  // namespace beampipe

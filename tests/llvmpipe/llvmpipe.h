// Mesa's software rasterizer, by way of a surfaceless EGL context: which samples of a small frame does a triangle
// cover?
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace beampipe {

class Llvmpipe {
 public:
  // Null, with the reason in `missing`, where Mesa or its llvmpipe driver is not there.
  static std::unique_ptr<Llvmpipe> start(int size, std::string& missing);
  ~Llvmpipe();

  const std::string& name() const { return name_; }  // of driver and version

  // Sample positions in 1/16 px from the pixel's upper left corner. `samples`: 1 or 4, here and below.
  std::vector<glm::ivec2> positions(int samples);

  // One mask per pixel of the size x size frame, row 0 on top: bit s is sample s. Clip space has y up, as in a trace.
  std::vector<std::uint32_t> coverage(const glm::vec4 clip[3], int samples);

 private:
  struct Objects;
  Llvmpipe();
  std::unique_ptr<Objects> objects_;
  std::string name_;
};

}  // namespace beampipe

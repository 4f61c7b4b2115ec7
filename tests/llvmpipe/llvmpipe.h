// Asks Mesa's software rasterizer, through an EGL context without a surface, which samples of a small frame a triangle
// covers.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace beampipe {

class Llvmpipe {
 public:
  // Null if Mesa or its llvmpipe driver is not installed; `missing` then has the reason.
  static std::unique_ptr<Llvmpipe> start(int size, std::string& missing);
  ~Llvmpipe();

  const std::string& name() const { return name_; }  // the driver and its version

  // Sample positions in 1/16 px from the pixel's upper left corner. Here and below, `samples` is 1 or 4.
  std::vector<glm::ivec2> positions(int samples);

  // One mask per pixel of the size x size frame, row 0 on top; bit s is set if sample s is covered. Clip space has y
  // up, as in a trace.
  std::vector<std::uint32_t> coverage(const glm::vec4 clip[3], int samples);

 private:
  struct Objects;
  Llvmpipe();
  std::unique_ptr<Objects> objects_;
  std::string name_;
};

}  // namespace beampipe

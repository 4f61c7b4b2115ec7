// Sizes of pictures in messages and tables.
#pragma once

#include <cstdint>
#include <string>

namespace beampipe {

// "1280 x 720".
inline std::string size_text(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace beampipe

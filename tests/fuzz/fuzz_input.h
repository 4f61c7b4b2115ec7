// What the fuzz targets share: a folder for the bytes to be read from, as a user's files are. libFuzzer ends without
// destructors, so that run.sh removes it: it lies in the folder for temporary files.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace beampipe {

class FuzzFolder {
 public:
  FuzzFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "beampipe-fuzz-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make " + name);
    path_ = name;
  }

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Errors are one line.
inline void require_one_line(std::string_view message) {
  if (message.empty()) std::abort();
  for (const char c : message)
    if (static_cast<unsigned char>(c) < 0x20) std::abort();
}

}  // namespace beampipe

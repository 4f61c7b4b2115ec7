// What the fuzz targets share. A folder holds the bytes as a file, because the program reads users' files that way.
// libFuzzer ends without calling destructors, so run.sh removes the folder, which lies in that for temporary files.
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

// Ends the program unless the message is one line.
inline void require_one_line(std::string_view message) {
  if (message.empty()) std::abort();
  for (const char c : message)
    if (static_cast<unsigned char>(c) < 0x20) std::abort();
}

}  // namespace beampipe

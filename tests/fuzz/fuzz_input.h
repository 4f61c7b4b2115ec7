// What the fuzz targets share. A folder holds the bytes as a file, because the program reads users' files that way.
// libFuzzer ends without calling destructors, so run.sh removes the folder, which lies in that for temporary files.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace beampipe {

class FuzzFolder {
 public:
  FuzzFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "beampipe-fuzz-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make " + name);
    path_ = name;
  }

  const std::filesystem::path& path() const { return path_; }

  // `name` may be in folders inside this one.
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// The texts between NULs, of which the last one may contain more NULs. Those that are missing are empty.
inline std::vector<std::string_view> parts_of(std::string_view text, std::size_t count) {
  std::vector<std::string_view> parts(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t end = i + 1 < count ? std::min(text.find('\0'), text.size()) : text.size();
    parts[i] = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

// Ends the program unless it holds.
inline void require(bool holds) {
  if (!holds) std::abort();
}

inline void require_one_line(std::string_view message) {
  require(!message.empty());
  for (const char c : message) require(static_cast<unsigned char>(c) >= 0x20);
}

}  // namespace beampipe

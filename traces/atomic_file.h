// A file that appears under its name only when it is complete.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace beampipe {

// Writes beside the target under a temporary name, which goes away unless commit() has renamed it.
// Everything throws std::runtime_error, one line that names the target.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  void commit();  // flushes to the disk and renames

 private:
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path target_, temporary_;
  int descriptor_ = -1;
};

}  // namespace beampipe

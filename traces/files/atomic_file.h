// A file that appears under its name only when it is complete.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace beampipe {

// Writes to a temporary file beside the target, which commit() renames to the target. Without commit() it is removed. A
// temporary file that a killed program has left is overwritten, so that such files do not pile up; one that is locked
// belongs to a program that is still writing, and is an error. All functions throw std::runtime_error, with one line
// that names the target.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  static std::filesystem::path temporary_of(const std::filesystem::path& target);  // "TARGET.tmp"

  void write(std::string_view bytes);
  void flush();   // to the disk
  void commit();  // flushes and renames

 private:
  [[noreturn]] void fail(const std::string& what) const;
  bool open();

  std::filesystem::path target_, temporary_;
  int descriptor_ = -1;
};

}  // namespace beampipe

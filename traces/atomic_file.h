// A file that appears under its name only when it is complete.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace beampipe {

// Writes beside the target under a temporary name, which goes away unless commit() has renamed it. What a killed
// program left under that name is written over, so that no rubbish piles up; while it is locked, another is writing.
// Everything throws std::runtime_error, one line that names the target.
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

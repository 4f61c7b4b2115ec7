// A text file that is written piece by piece, compressed with gzip if its name ends in .gz.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "tools/files/interrupt.h"
#include "traces/files/atomic_file.h"

namespace beampipe {

// The file appears under its name when commit() is called; an interrupt or an error leaves nothing of it. All functions
// throw std::runtime_error, one line that names the file.
class TextStream {
 public:
  TextStream(const std::filesystem::path& file, InterruptGate& gate);
  ~TextStream();
  TextStream(const TextStream&) = delete;
  TextStream& operator=(const TextStream&) = delete;

  void write(std::string_view text);
  void commit();

 private:
  void drain(bool is_last);

  class Gzip;

  InterruptGate& gate_;
  std::optional<AtomicFile> file_;
  std::unique_ptr<Gzip> gzip_;  // null: plain text
  std::string waiting_;
};

}  // namespace beampipe

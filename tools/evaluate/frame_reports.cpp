#include "tools/evaluate/frame_reports.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "tools/evaluate/frame_json.h"
#include "traces/files/json.h"

namespace beampipe {
namespace {

[[noreturn]] void fail(const char* what) {
  throw std::runtime_error(std::string("temporary file for the results of frames: cannot ") + what + ": " +
                           std::strerror(errno));
}

}  // namespace

void FrameReports::push_back(FrameReport frame) {
  last_ = std::move(frame);
  if (size() < most_in_memory_) {
    in_memory_.push_back(last_);
    return;
  }
  if (!file_) {
    std::FILE* const file = std::tmpfile();
    if (!file) fail("create it");
    file_.reset(file, std::fclose);
  }
  const std::string text = stored_json(last_).dump() + "\n";
  if (std::fseek(file_.get(), 0, SEEK_END) != 0) fail("write");
  const long place = std::ftell(file_.get());
  if (place < 0 || std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() ||
      std::fflush(file_.get()) != 0)
    fail("write");
  places_.push_back(static_cast<std::uint64_t>(place));
}

FrameReport FrameReports::operator[](std::size_t i) const {
  if (i < in_memory_.size()) return in_memory_[i];
  const std::uint64_t place = places_.at(i - in_memory_.size());
  if (std::fseek(file_.get(), static_cast<long>(place), SEEK_SET) != 0) fail("read");
  std::string text;
  for (int c = std::fgetc(file_.get()); c != '\n'; c = std::fgetc(file_.get())) {
    if (c == EOF) fail("read");
    text += static_cast<char>(c);
  }
  return stored_frame(parse_json_text(text, "a stored frame"));
}

}  // namespace beampipe

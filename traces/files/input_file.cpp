#include "traces/files/input_file.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "traces/files/trace_io.h"

namespace beampipe {

namespace {

std::string one_line(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return message;
}

}  // namespace

TraceError::TraceError(std::string message) : std::runtime_error(one_line(std::move(message))) {}

void fail_trace(const std::string& where, const std::string& expected, const std::string& found) {
  throw TraceError(where + ": expected " + expected + ", found " + found);
}

bool is_inside(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const std::filesystem::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

std::ifstream open_input_file(const std::filesystem::path& file, const std::string& where, std::uint64_t most_bytes) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  const bool is_link = std::filesystem::is_symlink(std::filesystem::symlink_status(file, error));
  if (!std::filesystem::exists(status)) fail_trace(where, "a readable file", is_link ? "a link to none" : "none");
  if (std::filesystem::is_directory(status)) fail_trace(where, "a readable file", "a folder");
  if (!std::filesystem::is_regular_file(status)) fail_trace(where, "a regular file", "a pipe or a device");
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (!error && size > most_bytes) {
    fail_trace(where, "at most " + std::to_string(most_bytes >> 30) + " GiB", std::to_string(size) + " bytes");
  }
  std::ifstream stream(file, std::ios::binary);
  stream.peek();  // some files of the kernel can be opened but not read
  if (stream.fail()) fail_trace(where, "a readable file", "none");
  stream.clear();  // peek() has found the end of an empty file
  return stream;
}

std::string read_input_file(const std::filesystem::path& file, const std::string& where, std::uint64_t most_bytes) {
  std::ifstream stream = open_input_file(file, where, most_bytes);
  std::string bytes;
  char part[1 << 16];
  while (stream.read(part, sizeof part) || stream.gcount() > 0)
    bytes.append(part, static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) fail_trace(where, "a file that can be read to its end", "one that cannot");
  return bytes;
}

}  // namespace beampipe

// The arrays of numbers of a trace: JSON arrays, or views of binary files beside the trace ("buffers").
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "traces/files/json_form.h"
#include "traces/files/trace_io.h"

namespace beampipe {

inline constexpr std::uint64_t kMostBufferBytes = std::uint64_t{1} << 32;  // of all buffers together
inline constexpr std::uint64_t kMostViews = 4;  // of each byte, on average, so that a small file stays a small trace

// The JSON Schemas of "buffers" and of an array of such numbers. `as_text`: it may be base64, too.
Json buffers_schema();
Json numbers_schema(const Json& number, bool as_text = false);
// Of bytes: base64, or a view of them.
Json bytes_schema();

// Reads an array as a JSON array or as a view:
//   {"buffer": NAME, "offset": BYTES, "count": NUMBERS, "type": "float32" | "uint32" | "uint16" | "uint8" | "srgb8"}
// A buffer is little-endian. srgb8 is for colours: 8 bits each, RGB encoded as sRGB and alpha linear. All functions
// check as those of JsonCursor do, and throw TraceError.
class ArrayReader {
 public:
  ArrayReader() = default;  // of a trace without buffers

  // `at`: the trace's "buffers". Reads the files.
  ArrayReader(const JsonCursor& at, const std::filesystem::path& trace_file, const ReadOptions& options);

  std::vector<float> numbers(const JsonCursor& at) const;
  std::vector<glm::vec2> vec2s(const JsonCursor& at) const;
  std::vector<glm::vec3> vec3s(const JsonCursor& at) const;
  std::vector<glm::vec4> vec4s(const JsonCursor& at) const;
  std::vector<glm::vec3> colors(const JsonCursor& at) const;
  std::vector<glm::vec4> rgbas(const JsonCursor& at) const;
  std::vector<glm::uvec3> triples(const JsonCursor& at, std::uint32_t below) const;
  std::vector<std::uint32_t> integers(const JsonCursor& at, std::uint32_t below) const;

  // Base64, or a view of "uint8".
  std::vector<std::uint8_t> bytes(const JsonCursor& at) const;
  // Words of 32 bits: an array of integers, base64 of their bytes, the lowest first, or a view of integers.
  std::vector<std::uint32_t> words(const JsonCursor& at) const;
  // Bits of numbers: an array of finite floats, or as words; a view may have the type "float32", too.
  std::vector<std::uint32_t> bits(const JsonCursor& at) const;

 private:
  struct View;
  template <class ReadElement>
  std::vector<std::uint32_t> words(const JsonCursor& at, bool may_be_floats, ReadElement read_element) const;
  View view(const JsonCursor& at, std::uint64_t length) const;

  std::map<std::string, std::string> buffers_;  // the bytes of each
  std::uint64_t buffer_bytes_ = 0;
  mutable std::uint64_t viewed_bytes_ = 0;
};

}  // namespace beampipe

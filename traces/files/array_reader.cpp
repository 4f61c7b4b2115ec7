#include "traces/files/array_reader.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "traces/files/base64.h"
#include "traces/files/input_file.h"
#include "traces/files/side_file.h"
#include "traces/material.h"
#include "traces/srgb.h"

namespace beampipe {

static_assert(std::endian::native == std::endian::little, "buffers are little-endian and are copied");

namespace {

enum class NumberType { float32, uint32, uint16, uint8, srgb8 };
constexpr std::uint64_t kTypeBytes[] = {4, 4, 2, 1, 1};

constexpr float kMostFloat = std::numeric_limits<float>::max();
constexpr const char* kReal = "a number in a float's range";
constexpr const char* kColor = "a number from 0 to 65504";
static_assert(kMostColor == 65504);

const std::array<float, 256>& linear_of_codes() {
  static const std::array<float, 256> values = [] {
    std::array<float, 256> linear{};
    for (std::size_t code = 0; code < linear.size(); ++code)
      linear[code] = static_cast<float>(linear_of_srgb(static_cast<double>(code) / 255));
    return linear;
  }();
  return values;
}

// A buffer and a view, as a trace writes them.
struct BufferKeys {
  std::string file;
  double bytes = 0;
};
const Form<BufferKeys>& buffer_form() {
  static const Form<BufferKeys> form =
      ObjectForm<BufferKeys>()
          .required("file", &BufferKeys::file, form::text(),
                    "Path of the file, relative to the trace's folder, which it may not leave: neither by .. nor by a "
                    "symbolic link.")
          .required("bytes", &BufferKeys::bytes, form::number(), "The size of the file.");
  return form;
}

struct ViewKeys {
  std::string buffer;
  double offset = 0, count = 0;
  NumberType type{};
};
constexpr std::string_view kTypeNames[] = {"float32", "uint32", "uint16", "uint8", "srgb8"};
const Form<ViewKeys>& view_form() {
  static const Form<ViewKeys> form =
      ObjectForm<ViewKeys>()
          .required("buffer", &ViewKeys::buffer, form::text(), "The name of one of `buffers`.")
          .required("offset", &ViewKeys::offset, form::number(),
                    "Where it starts, in bytes; a multiple of the numbers' size.")
          .required("count", &ViewKeys::count, form::number(),
                    "How many numbers there are: three for a position, and so on.")
          .required("type", &ViewKeys::type, form::choice<NumberType>(kTypeNames),
                    "float32; uint32 and uint16 for integers; uint8 for bytes; srgb8 for colours: 8 bits each, RGB "
                    "encoded as sRGB and "
                    "opacity linear.");
  return form;
}

std::string text_of(float value) { return std::isfinite(value) ? std::to_string(value) : "one that is not finite"; }

}  // namespace

// The bytes of one array.
struct ArrayReader::View {
  const JsonCursor at;
  std::string_view bytes;
  NumberType type;
  std::uint64_t count;

  void expect_type(std::initializer_list<NumberType> types, const char* expected) const {
    for (const NumberType known : types)
      if (type == known) return;
    at["type"].fail(expected);
  }

  [[noreturn]] void fail(const std::string& expected, const std::string& found, std::uint64_t number) const {
    at.fail(expected, found + " as number " + std::to_string(number) + " of the view");
  }

  // Floats, all of which are valid.
  template <class Vector, class IsValid>
  std::vector<Vector> floats(const char* expected, IsValid is_valid) const {
    expect_type({NumberType::float32}, "\"float32\"");
    std::vector<Vector> result(count * sizeof(float) / sizeof(Vector));
    if (!bytes.empty()) std::memcpy(static_cast<void*>(result.data()), bytes.data(), bytes.size());
    const auto* numbers = reinterpret_cast<const float*>(result.data());
    for (std::uint64_t i = 0; i < count; ++i)
      if (!is_valid(numbers[i])) fail(expected, text_of(numbers[i]), i);
    return result;
  }

  template <class Vector>
  std::vector<Vector> colors() const {
    if (type != NumberType::srgb8) {
      expect_type({NumberType::float32}, "\"float32\" or \"srgb8\"");
      return floats<Vector>(kColor, [](float value) { return value >= 0 && value <= kMostColor; });
    }
    const std::array<float, 256>& linear = linear_of_codes();
    std::vector<Vector> result(count / static_cast<std::uint64_t>(Vector::length()));
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto code = static_cast<std::uint8_t>(bytes[i]);
      const auto channel = static_cast<int>(i % static_cast<std::uint64_t>(Vector::length()));
      result[i / static_cast<std::uint64_t>(Vector::length())][channel] =
          channel == 3 ? static_cast<float>(code) / 255.0f : linear[code];
    }
    return result;
  }

  // Bits of floats or integers.
  std::vector<std::uint32_t> words() const {
    std::vector<std::uint32_t> result(count);
    if (type != NumberType::uint16) {
      if (!bytes.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
    } else {
      for (std::uint64_t i = 0; i < count; ++i) {
        std::uint16_t value = 0;
        std::memcpy(&value, bytes.data() + 2 * i, sizeof value);
        result[i] = value;
      }
    }
    return result;
  }

  std::vector<std::uint32_t> integers(std::uint32_t below) const {
    expect_type({NumberType::uint32, NumberType::uint16}, "\"uint32\" or \"uint16\"");
    const std::vector<std::uint32_t> result = words();
    for (std::uint64_t i = 0; i < count; ++i)
      if (result[i] >= below) fail("integers below " + std::to_string(below), std::to_string(result[i]), i);
    return result;
  }
};

Json buffers_schema() { return {{"type", "object"}, {"additionalProperties", buffer_form().schema}}; }

Json numbers_schema(const Json& number, bool as_text) {
  Json forms = Json::array({{{"type", "array"}, {"items", number}}, view_form().schema});
  if (as_text) forms.push_back({{"type", "string"}, {"contentEncoding", "base64"}});
  return {{"oneOf", forms}};
}

Json bytes_schema() {
  return {{"oneOf", Json::array({{{"type", "string"}, {"contentEncoding", "base64"}}, view_form().schema})}};
}

ArrayReader::ArrayReader(const JsonCursor& at, const std::filesystem::path& trace_file, const ReadOptions& options) {
  for (const auto& [name, buffer] : at.members()) {
    const BufferKeys keys = buffer_form()(buffer);
    const std::filesystem::path file = side_file(buffer["file"], trace_file, options.allow_outside);
    const std::uint64_t size = std::filesystem::file_size(file);
    if (keys.bytes != static_cast<double>(size)) {
      buffer["bytes"].fail("the size of " + in_quotes(file.filename().string()) + ", " + std::to_string(size));
    }
    buffer_bytes_ += size;
    if (buffer_bytes_ > kMostBufferBytes) {
      buffer["bytes"].fail("buffers of at most " + std::to_string(kMostBufferBytes) + " bytes together",
                           std::to_string(buffer_bytes_));
    }
    std::string content = read_input_file(file, buffer.where());
    if (content.size() != size) buffer["file"].fail("a file that does not change while it is read");
    buffers_.emplace(name, std::move(content));
  }
}

ArrayReader::View ArrayReader::view(const JsonCursor& at, std::uint64_t length) const {
  const ViewKeys keys = view_form()(at);
  const auto buffer = buffers_.find(keys.buffer);
  if (buffer == buffers_.end()) at["buffer"].fail("the name of a buffer in /buffers");
  const NumberType type = keys.type;
  const std::uint64_t number_bytes = kTypeBytes[static_cast<std::size_t>(type)], size = buffer->second.size();
  const auto whole = [](const JsonCursor& number, std::uint64_t most, std::uint64_t step, const std::string& expected) {
    const double value = number.number();
    if (!(value >= 0 && value <= static_cast<double>(most) && std::fmod(value, static_cast<double>(step)) == 0)) {
      number.fail(expected);
    }
    return static_cast<std::uint64_t>(value);
  };
  const std::string in_buffer = " in a buffer of " + std::to_string(size) + " bytes";
  const std::uint64_t offset =
      whole(at["offset"], size, number_bytes, "a multiple of " + std::to_string(number_bytes) + in_buffer);
  const std::uint64_t count = whole(at["count"], (size - offset) / number_bytes, length,
                                    "numbers that end" + in_buffer + ", " + std::to_string(length) + " for each item");
  viewed_bytes_ += count * number_bytes;
  if (viewed_bytes_ > kMostViews * buffer_bytes_) {
    at.fail("views of at most " + std::to_string(kMostViews) + " times the bytes of all buffers together",
            std::to_string(viewed_bytes_) + " bytes");
  }
  return {at, std::string_view(buffer->second).substr(offset, count * number_bytes), type, count};
}

std::vector<float> ArrayReader::numbers(const JsonCursor& at) const {
  if (!at.is_object()) {
    std::vector<float> result;
    for (const JsonCursor& number : at.elements()) result.push_back(number.real(-kMostFloat, kMostFloat));
    return result;
  }
  return view(at, 1).floats<float>(kReal, [](float value) { return std::isfinite(value); });
}

std::vector<glm::vec2> ArrayReader::vec2s(const JsonCursor& at) const {
  if (!at.is_object()) return at.vec2s();
  return view(at, 2).floats<glm::vec2>(kReal, [](float value) { return std::isfinite(value); });
}

std::vector<glm::vec3> ArrayReader::vec3s(const JsonCursor& at) const {
  if (!at.is_object()) return at.vec3s();
  return view(at, 3).floats<glm::vec3>(kReal, [](float value) { return std::isfinite(value); });
}

std::vector<glm::vec4> ArrayReader::vec4s(const JsonCursor& at) const {
  if (!at.is_object()) return at.vec4s();
  return view(at, 4).floats<glm::vec4>(kReal, [](float value) { return std::isfinite(value); });
}

std::vector<glm::vec3> ArrayReader::colors(const JsonCursor& at) const {
  if (!at.is_object()) return at.colors();
  return view(at, 3).colors<glm::vec3>();
}

std::vector<glm::vec4> ArrayReader::rgbas(const JsonCursor& at) const {
  if (!at.is_object()) return at.rgbas();
  const View of_numbers = view(at, 4);
  std::vector<glm::vec4> result = of_numbers.colors<glm::vec4>();
  for (std::size_t i = 0; i < result.size(); ++i)
    if (result[i].a > 1) of_numbers.fail("a number 0..1", text_of(result[i].a), 4 * i + 3);
  return result;
}

std::vector<glm::uvec3> ArrayReader::triples(const JsonCursor& at, std::uint32_t below) const {
  if (!at.is_object()) return at.triples(below);
  const std::vector<std::uint32_t> flat = view(at, 3).integers(below);
  std::vector<glm::uvec3> result(flat.size() / 3);
  if (!flat.empty()) std::memcpy(static_cast<void*>(result.data()), flat.data(), flat.size() * sizeof(std::uint32_t));
  return result;
}

std::vector<std::uint32_t> ArrayReader::integers(const JsonCursor& at, std::uint32_t below) const {
  if (at.is_object()) return view(at, 1).integers(below);
  std::vector<std::uint32_t> result;
  for (const JsonCursor& number : at.elements()) result.push_back(number.integer(0, below - 1));
  return result;
}

namespace {

std::string inline_bytes(const JsonCursor& at) {
  std::optional<std::string> bytes = from_base64(at.string());
  if (!bytes) at.fail("base64 text");
  return std::move(*bytes);
}

}  // namespace

std::vector<std::uint8_t> ArrayReader::bytes(const JsonCursor& at) const {
  if (!at.is_object()) {
    const std::string bytes = inline_bytes(at);
    return {bytes.begin(), bytes.end()};
  }
  const View of_bytes = view(at, 1);
  of_bytes.expect_type({NumberType::uint8}, "\"uint8\"");
  return {of_bytes.bytes.begin(), of_bytes.bytes.end()};
}

template <class ReadElement>
std::vector<std::uint32_t> ArrayReader::words(const JsonCursor& at, bool may_be_floats,
                                              ReadElement read_element) const {
  std::vector<std::uint32_t> result;
  if (at.is_object()) {
    const View of_words = view(at, 1);
    if (may_be_floats && of_words.type == NumberType::float32)
      of_words.floats<float>(kReal, [](float value) { return std::isfinite(value); });
    else
      of_words.expect_type({NumberType::uint32, NumberType::uint16},
                           may_be_floats ? "\"float32\", \"uint32\" or \"uint16\"" : "\"uint32\" or \"uint16\"");
    return of_words.words();
  }
  if (at.is_array()) {
    for (const JsonCursor& element : at.elements()) result.push_back(read_element(element));
    return result;
  }
  if (!at.is_string()) at.fail("an array, base64 text or a view of a buffer");
  const std::string bytes = inline_bytes(at);
  if (bytes.size() % sizeof(std::uint32_t) != 0)
    at.fail("base64 text of whole words of 4 bytes", std::to_string(bytes.size()) + " bytes");
  result.resize(bytes.size() / sizeof(std::uint32_t));
  if (!bytes.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
  return result;
}

std::vector<std::uint32_t> ArrayReader::words(const JsonCursor& at) const {
  return words(at, false, [](const JsonCursor& element) { return element.integer(0, ~0u); });
}

std::vector<std::uint32_t> ArrayReader::bits(const JsonCursor& at) const {
  return words(at, true, [](const JsonCursor& element) {
    return std::bit_cast<std::uint32_t>(element.real(-kMostFloat, kMostFloat));
  });
}

}  // namespace beampipe

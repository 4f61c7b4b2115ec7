// The text of a trace that is being written: JSON, and the binary file of its arrays if it has one.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "traces/files/atomic_file.h"
#include "traces/files/base64.h"
#include "traces/files/json.h"
#include "traces/files/trace_io.h"

namespace beampipe {

// All functions throw std::runtime_error, with one line.
class TraceText {
 public:
  TraceText(const std::filesystem::path& file, ArrayStorage storage) : name_(file.string()), file_(file) {
    if (storage == ArrayStorage::text) return;
    if (file.extension() == ".bin") fail("its name ends in .bin, as that of the binary file beside it would");
    arrays_.emplace(arrays_file_of(file));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(name_ + ": cannot write the trace: " + what);
  }

  ArrayStorage storage() const { return arrays_ ? ArrayStorage::binary : ArrayStorage::text; }

  // Adds "buffers" to the object that is open, and gives the binary file its name.
  void finish_arrays() {
    if (!arrays_) return;
    put(",\n\"buffers\": {\"" + std::string(kBuffer) + "\": {\"file\": ");
    put_text("the file", arrays_->path.filename().string());
    put(", \"bytes\": " + std::to_string(arrays_->bytes) + "}}");
    arrays_->file.commit();
  }

  // Gives the trace its name.
  void finish() {
    file_.write(buffer_);
    file_.commit();
  }

  void put(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() < kChunk) return;
    file_.write(buffer_);
    buffer_.clear();
  }

  // `what` is "a mesh's name" or the like, for the message.
  void put_text(const std::string& what, const std::string& text) {
    try {
      put(json_string(text));
    } catch (const JsonError&) {
      fail(what + " is not UTF-8");
    }
  }

  void put_name(const char* whose, const std::string& name) { put_text(std::string(whose) + "'s name", name); }

  // The shortest text that a reader turns into the same bits.
  void put_number(double value) {
    if (!std::isfinite(value)) fail("a number in it is not finite");
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    put({text, end});
    if (value == 0 && std::signbit(value)) put(".0");  // a reader takes "-0" for an integer, which loses the sign
  }

  void put_number(float value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    double read = 0;
    std::from_chars(text, end, read);  // a reader rounds to double and then to float, which may give another float
    const bool same = std::isfinite(value) && value != 0 && static_cast<float>(read) == value;
    same ? put({text, end}) : put_number(static_cast<double>(value));
  }

  void put_number(std::uint32_t value) { put(std::to_string(value)); }

  template <typename Items, typename PutItem>
  void list(const Items& items, PutItem put_item) {
    const char* separator = "\n";
    for (const auto& item : items) {
      put(separator);
      put_item(item);
      separator = ",\n";
    }
  }

  template <typename Vector>
  void put_components(const Vector& vector) {
    for (int i = 0; i < Vector::length(); ++i) {
      if (i > 0) put(",");
      put_number(vector[i]);
    }
  }

  template <typename Vector>
  void put_array(const Vector& vector) {
    put("[");
    put_components(vector);
    put("]");
  }

  // An array of numbers that may stand in the binary file.
  template <typename Vector>
  void put_numbers(std::string_view key, const std::vector<Vector>& vectors) {
    put(key);
    if (!arrays_) {
      put_array(vectors);
    } else if constexpr (std::is_arithmetic_v<Vector>) {
      put_view(vectors.data(), vectors.size());
    } else {
      put_view(reinterpret_cast<const typename Vector::value_type*>(vectors.data()),
               static_cast<std::size_t>(Vector::length()) * vectors.size());
    }
  }

  // Bytes, and words of 32 bits, as base64 or in the binary file.
  void put_bytes(const std::vector<std::uint8_t>& bytes) {
    if (arrays_)
      put_view(bytes.data(), bytes.size());
    else
      put_base64(bytes.data(), bytes.size());
  }
  void put_words(const std::vector<std::uint32_t>& words) {
    if (arrays_)
      put_view(words.data(), words.size());
    else
      put_base64(words.data(), words.size() * sizeof(std::uint32_t));
  }

  // Bits of floats, all of which are finite, or of anything.
  void put_bits(const std::vector<std::uint32_t>& bits) {
    std::vector<float> floats(bits.size());
    if (!bits.empty()) std::memcpy(floats.data(), bits.data(), bits.size() * sizeof(float));
    if (std::all_of(floats.begin(), floats.end(), [](float value) { return std::isfinite(value); }))
      put_numbers("", floats);
    else
      put_words(bits);
  }

  // Integers take 16 bits where these are enough.
  template <typename Number>
  void put_view(const Number* numbers, std::size_t count) {
    constexpr bool kIsFloat = std::is_same_v<Number, float>, kIsByte = sizeof(Number) == 1;
    const bool is_short =
        !kIsFloat && !kIsByte && std::all_of(numbers, numbers + count, [](Number n) { return n <= 0xffff; });
    put("{\"buffer\": \"" + std::string(kBuffer) + "\", \"offset\": " + std::to_string(arrays_->bytes) +
        ", \"count\": " + std::to_string(count) + ", \"type\": \"" +
        (kIsFloat   ? "float32"
         : kIsByte  ? "uint8"
         : is_short ? "uint16"
                    : "uint32") +
        "\"}");
    if (is_short) {
      const std::vector<std::uint16_t> values(numbers, numbers + count);
      arrays_->append(values.data(), count * sizeof(std::uint16_t));
    } else {
      if (kIsFloat && !std::all_of(numbers, numbers + count, [](Number n) { return std::isfinite(n); })) {
        fail("a number in it is not finite");
      }
      arrays_->append(numbers, count * sizeof(Number));
    }
  }

  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void put_array(const std::vector<Number>& numbers) {
    put("[");
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (i > 0) put(",");
      put_number(numbers[i]);
    }
    put("]");
  }

  template <typename Vector>
  requires(!std::is_arithmetic_v<Vector>) void put_array(const std::vector<Vector>& vectors) {
    put("[");
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      if (i > 0) put(",");
      put_components(vectors[i]);
    }
    put("]");
  }

  void put_array(const glm::dmat4& matrix) {
    put_array(std::vector<glm::dvec4>{matrix[0], matrix[1], matrix[2], matrix[3]});
  }

  template <typename Vector>
  void put_array(std::string_view key, const Vector& vector) {
    put(key);
    put_array(vector);
  }

  // Members of an object that differ from what a reader takes when they are left out.
  template <class Value>
  void put_member(const char* key, const Value& value, const Value& otherwise) {
    if (std::memcmp(&value, &otherwise, sizeof value) == 0) return;  // -0 is not 0
    put_key(key);
    if constexpr (std::is_same_v<Value, bool>) {
      put(value ? "true" : "false");
    } else if constexpr (std::is_arithmetic_v<Value>) {
      put_number(value);
    } else {
      put_array(value);
    }
  }

  // A text that is not empty.
  void put_member(const char* key, const std::string& text) {
    if (text.empty()) return;
    put_key(key);
    put_text(std::string("the ") + key, text);
  }

  template <class Enum>
  void put_choice(const char* key, Enum value, Enum otherwise, std::span<const std::string_view> names) {
    if (value != otherwise) put_name_of(key, value, names);
  }

  template <class Enum>
  void put_name_of(const char* key, Enum value, std::span<const std::string_view> names) {
    put_key(key);
    put("\"");
    put(names[static_cast<std::size_t>(value)]);
    put("\"");
  }

  // Starts the next member of an object that is open.
  void put_key(const char* key) {
    put(has_members_ ? ", \"" : "\"");
    put(key);
    put("\": ");
    has_members_ = true;
  }

  // An object whose members put_key and the like add.
  void open_object() {
    put("{");
    has_members_ = false;
  }
  void close_object() {  // it may be a member of another one
    put("}");
    has_members_ = true;
  }

 private:
  void put_base64(const void* bytes, std::size_t count) {
    put("\"" + to_base64({static_cast<const char*>(bytes), count}) + "\"");
  }

  static constexpr std::size_t kChunk = 1 << 20;    // bytes that are written at once
  static constexpr const char* kBuffer = "arrays";  // the name of the binary file in the trace

  // The binary file. Every array starts at a multiple of 4 bytes.
  struct BinaryArrays {
    std::filesystem::path path;
    AtomicFile file;
    std::uint64_t bytes = 0;

    explicit BinaryArrays(const std::filesystem::path& target) : path(target), file(target) {}

    void append(const void* values, std::size_t count) {
      const std::string_view padding("\0\0\0", (4 - count % 4) % 4);
      file.write({static_cast<const char*>(values), count});
      file.write(padding);
      bytes += count + padding.size();
    }
  };

  std::string name_;
  AtomicFile file_;
  std::optional<BinaryArrays> arrays_;
  std::string buffer_;
  bool has_members_ = false;  // the object that is open has a member already
};

}  // namespace beampipe

// Reading JSON values, with errors that name the file, the JSON pointer of the value, and what was expected there.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "traces/files/json.h"

namespace beampipe {

// A value in a file, both of which must outlive the cursor. Its place is searched for only when a message needs it, so
// that cursors are cheap. Each reader throws TraceError if the value is not what the reader is named after.
class JsonCursor {
 public:
  // The whole of a file.
  JsonCursor(const Json& json, const std::string& file) : value_(&json), root_(&json), file_(&file) {}

  // Members of an object.
  void expect_keys(std::initializer_list<std::string_view> known) const {  // there are no other keys
    expect_keys(std::span(known.begin(), known.size()));
  }
  // `called`: how an error calls them; empty: it lists them.
  void expect_keys(std::span<const std::string_view> known, const std::string& called = "") const;
  void expect_all(const std::vector<std::string>& keys) const;  // it has these; an error names up to ten
  bool has(std::string_view key) const;
  JsonCursor operator[](std::string_view key) const;           // required
  std::optional<JsonCursor> find(std::string_view key) const;  // optional
  std::vector<std::pair<std::string, JsonCursor>> members() const;

  // Elements of an array.
  std::vector<JsonCursor> elements() const;

  bool is_null() const { return value_->is_null(); }
  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  bool is_string() const { return value_->is_string(); }
  double number() const;
  double number(double low, double high) const;          // low..high
  double number_between(double low, double high) const;  // low < number < high
  float real(float low, float high) const;               // low..high
  float fraction() const;                                // 0..1
  std::uint32_t integer(std::uint32_t low, std::uint32_t high) const;
  bool boolean() const;
  std::string string() const;
  std::size_t choice(std::initializer_list<std::string_view> names) const {  // index of the string in `names`
    return choice(std::span(names.begin(), names.size()));
  }
  std::size_t choice(std::span<const std::string_view> names) const;

  glm::dvec3 vec3() const;
  glm::vec3 color() const;  // each 0..kMostColor
  glm::vec4 rgba() const;   // the same, and alpha 0..1
  glm::dmat4 matrix() const;

  // Flat arrays: the numbers of one vector after those of the other.
  std::vector<glm::vec2> vec2s() const;  // finite as floats
  std::vector<glm::vec3> vec3s() const;
  std::vector<glm::vec4> vec4s() const;
  std::vector<glm::vec3> colors() const;                       // 0..kMostColor
  std::vector<glm::vec4> rgbas() const;                        // the same, and alpha 0..1
  std::vector<glm::uvec3> triples(std::uint32_t count) const;  // integers below `count`

  std::string where() const;  // "FILE: POINTER"; takes time in proportion to the file
  std::string found() const;  // the value in a few words
  [[noreturn]] void fail(const std::string& expected) const { fail(expected, found()); }
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const;

 private:
  JsonCursor at(const Json& value) const;
  void expect_object() const;
  void expect_numbers(std::size_t count) const;  // an array of this length
  std::vector<double> numbers(std::size_t count) const;
  template <class Vector, class IsValid>
  std::vector<Vector> vectors_of(const std::string& expected, IsValid is_valid) const;

  const Json* value_;
  const Json* root_;
  const std::string* file_;
};

}  // namespace beampipe

// A JSON value and the place where it stands, for readers whose every error names file, JSON pointer and expectation.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "traces/json.h"

namespace beampipe {

// Throws TraceError "WHERE: expected EXPECTED, found FOUND", on one line whatever the parts contain.
[[noreturn]] void fail_trace(const std::string& where, const std::string& expected, const std::string& found);

// A quoted string on one line, for messages.
std::string in_quotes(std::string_view text);

// A key as a step of a JSON pointer: "/" and "~" escaped.
std::string pointer_step(std::string_view key);

// All readers throw TraceError when the value is not what they are named after.
class JsonCursor {
 public:
  JsonCursor(const Json& value, const std::string& file) : JsonCursor(value, file, "") {}

  // Members of an object.
  void expect_keys(std::initializer_list<std::string_view> known) const;
  bool has(std::string_view key) const;
  JsonCursor operator[](std::string_view key) const;           // required
  std::optional<JsonCursor> find(std::string_view key) const;  // optional
  std::vector<std::pair<std::string, JsonCursor>> members() const;

  // Elements of an array.
  std::vector<JsonCursor> elements() const;

  double number() const;
  double number_between(double low, double high) const;  // both excluded
  std::uint32_t integer(std::uint32_t low, std::uint32_t high) const;
  std::string string() const;
  std::size_t choice(std::initializer_list<std::string_view> names) const;  // index of the string in `names`

  glm::dvec3 vec3() const;
  glm::vec3 color() const;  // each 0 and up, finite as a float
  glm::dmat4 matrix() const;
  std::vector<glm::vec3> vec3s() const;                        // flat array of triples, finite as floats
  std::vector<glm::vec3> colors() const;                       // the same, 0 and up
  std::vector<glm::uvec3> triples(std::uint32_t count) const;  // flat array of triples of integers below `count`

  std::string where() const;  // "FILE: POINTER"
  std::string found() const;  // the value in a few words
  [[noreturn]] void fail(const std::string& expected) const { fail(expected, found()); }
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const;

 private:
  JsonCursor(const Json& value, const std::string& file, std::string pointer)
      : value_(&value), file_(&file), pointer_(std::move(pointer)) {}
  JsonCursor child(const Json& value, std::string_view step) const;
  void expect_object() const;
  const Json& array_of(std::size_t length) const;
  const Json& array_of_triples() const;
  float float_at(const Json& array, std::size_t i, bool negative_too) const;

  const Json* value_;
  const std::string* file_;
  std::string pointer_;
};

}  // namespace beampipe

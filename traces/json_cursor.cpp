#include "traces/json_cursor.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "traces/trace_io.h"

namespace beampipe {
namespace {

constexpr std::size_t kLongestFound = 60;  // characters of a value that a message shows

std::string names_of(std::initializer_list<std::string_view> names) {
  std::string text;
  for (std::string_view name : names) text += (text.empty() ? "" : ", ") + in_quotes(name);
  return text;
}

std::string number_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string describe(const Json& value) {
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_object()) return "an object";
  if (value.is_string()) return in_quotes(value.get<std::string>());
  return value.dump();
}

}  // namespace

void fail_trace(const std::string& where, const std::string& expected, const std::string& found) {
  std::string message = where + ": expected " + expected + ", found " + found;
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  throw TraceError(message);
}

std::string in_quotes(std::string_view text) {
  const bool long_text = text.size() > kLongestFound;
  return Json(text.substr(0, kLongestFound)).dump() + (long_text ? "..." : "");  // may have been cut within a character
}

std::string pointer_step(std::string_view key) {
  std::string step;
  for (char c : key) {
    if (c == '~') {
      step += "~0";
    } else if (c == '/') {
      step += "~1";
    } else {
      step += c;
    }
  }
  return step;
}

void JsonCursor::fail(const std::string& expected, const std::string& found) const {
  fail_trace(where(), expected, found);
}

std::string JsonCursor::where() const { return *file_ + ": " + (pointer_.empty() ? "/" : pointer_); }

std::string JsonCursor::found() const { return describe(*value_); }

JsonCursor JsonCursor::child(const Json& value, std::string_view step) const {
  return JsonCursor(value, *file_, pointer_ + '/' + pointer_step(step));
}

void JsonCursor::expect_object() const {
  if (!value_->is_object()) fail("an object");
}

void JsonCursor::expect_keys(std::initializer_list<std::string_view> known) const {
  expect_object();
  for (const auto& [key, value] : value_->members()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      child(value, key).fail("one of the keys " + names_of(known), in_quotes(key));
    }
  }
}

bool JsonCursor::has(std::string_view key) const {
  expect_object();
  return value_->contains(key);
}

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
  expect_object();
  const Json* member = value_->find(key);
  if (!member) return std::nullopt;
  return child(*member, key);
}

JsonCursor JsonCursor::operator[](std::string_view key) const {
  const std::optional<JsonCursor> member = find(key);
  if (!member) fail("the key " + in_quotes(key), "none");
  return *member;
}

std::vector<std::pair<std::string, JsonCursor>> JsonCursor::members() const {
  expect_object();
  std::vector<std::pair<std::string, JsonCursor>> result;
  for (const auto& [key, value] : value_->members()) result.emplace_back(key, child(value, key));
  return result;
}

std::vector<JsonCursor> JsonCursor::elements() const {
  if (!value_->is_array()) fail("an array");
  std::vector<JsonCursor> result;
  for (std::size_t i = 0; i < value_->size(); ++i) result.push_back(child(value_->at(i), std::to_string(i)));
  return result;
}

double JsonCursor::number() const {
  if (!value_->is_number()) fail("a number");
  return value_->get<double>();
}

double JsonCursor::number_between(double low, double high) const {
  const double value = value_->is_number() ? number() : low;
  if (!(value > low && value < high)) {
    fail("a number above " + number_text(low) + (std::isinf(high) ? "" : " and below " + number_text(high)));
  }
  return value;
}

std::uint32_t JsonCursor::integer(std::uint32_t low, std::uint32_t high) const {
  const double value = value_->is_number() ? number() : -1.0;
  if (!(value >= low && value <= high && value == std::floor(value))) {
    fail("an integer " + std::to_string(low) + ".." + std::to_string(high));
  }
  return static_cast<std::uint32_t>(value);
}

std::string JsonCursor::string() const {
  if (!value_->is_string()) fail("a string");
  return value_->get<std::string>();
}

std::size_t JsonCursor::choice(std::initializer_list<std::string_view> names) const {
  const auto name =
      value_->is_string() ? std::find(names.begin(), names.end(), value_->get<std::string>()) : names.end();
  if (name == names.end()) fail("one of " + names_of(names));
  return static_cast<std::size_t>(name - names.begin());
}

const Json& JsonCursor::array_of(std::size_t length) const {
  if (!value_->is_array() || value_->size() != length) fail("an array of " + std::to_string(length) + " numbers");
  return *value_;
}

const Json& JsonCursor::array_of_triples() const {
  if (!value_->is_array() || value_->size() % 3 != 0) fail("an array of numbers, three for each item");
  return *value_;
}

float JsonCursor::float_at(const Json& array, std::size_t i, bool negative_too) const {
  const Json& element = array.at(i);
  const float value = element.is_number() ? static_cast<float>(element.get<double>()) : NAN;
  if (!std::isfinite(value) || (value < 0 && !negative_too)) {
    child(element, std::to_string(i)).fail(negative_too ? "a number in a float's range" : "a number, 0 and up");
  }
  return value;
}

glm::dvec3 JsonCursor::vec3() const {
  array_of(3);
  const std::vector<JsonCursor> e = elements();
  return {e[0].number(), e[1].number(), e[2].number()};
}

glm::vec3 JsonCursor::color() const {
  array_of(3);
  return colors()[0];
}

glm::dmat4 JsonCursor::matrix() const {
  array_of(16);
  const std::vector<JsonCursor> e = elements();
  glm::dmat4 result;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) result[column][row] = e[static_cast<std::size_t>(4 * column + row)].number();
  }
  return result;
}

std::vector<glm::vec3> JsonCursor::vec3s() const {
  const Json& array = array_of_triples();
  std::vector<glm::vec3> result(array.size() / 3);
  for (std::size_t i = 0; i < array.size(); ++i) {
    result[i / 3][static_cast<int>(i % 3)] = float_at(array, i, true);
  }
  return result;
}

std::vector<glm::vec3> JsonCursor::colors() const {
  const Json& array = array_of_triples();
  std::vector<glm::vec3> result(array.size() / 3);
  for (std::size_t i = 0; i < array.size(); ++i) {
    result[i / 3][static_cast<int>(i % 3)] = float_at(array, i, false);
  }
  return result;
}

std::vector<glm::uvec3> JsonCursor::triples(std::uint32_t count) const {
  const Json& array = array_of_triples();
  std::vector<glm::uvec3> result(array.size() / 3);
  for (std::size_t i = 0; i < array.size(); ++i) {
    const double value = array.at(i).is_number() ? array.at(i).get<double>() : -1.0;
    if (!(value >= 0 && value < count && value == std::floor(value))) {
      child(array.at(i), std::to_string(i)).fail("an integer below the number of positions, " + std::to_string(count));
    }
    result[i / 3][static_cast<int>(i % 3)] = static_cast<std::uint32_t>(value);
  }
  return result;
}

}  // namespace beampipe

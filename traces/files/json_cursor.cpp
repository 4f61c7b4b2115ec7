#include "traces/files/json_cursor.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <sstream>

#include "traces/closest_name.h"
#include "traces/files/input_file.h"
#include "traces/material.h"

namespace beampipe {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string names_of(std::span<const std::string_view> names) {
  std::string text;
  for (std::string_view name : names) text += (text.empty() ? "" : ", ") + in_quotes(name);
  return text;
}

std::string number_text(double value) {
  std::ostringstream text;
  text.precision(9);
  text << value;
  return text.str();
}

double number_or_nan(const Json& value) { return value.is_number() ? value.get<double>() : kNan; }

constexpr const char* kReal = "a number in a float's range";
constexpr const char* kFraction = "a number 0..1";

bool is_float(double value) { return std::isfinite(static_cast<float>(value)); }
bool is_intensity(double value) { return value >= 0 && value <= kMostColor; }

std::string range_text(double low, double high) {
  return "a number from " + number_text(low) + " to " + number_text(high);
}

}  // namespace

void JsonCursor::fail(const std::string& expected, const std::string& found) const {
  fail_trace(where(), expected, found);
}

std::string JsonCursor::where() const {
  const std::string pointer = pointer_to(*value_, *root_);
  return *file_ + ": " + (pointer.empty() ? "/" : pointer);
}

std::string JsonCursor::found() const {
  if (value_->is_array()) return "an array of " + std::to_string(value_->size());
  if (value_->is_object()) return "an object";
  if (value_->is_string()) return in_quotes(value_->get<std::string>());
  return value_->dump();
}

JsonCursor JsonCursor::at(const Json& value) const {
  JsonCursor cursor = *this;
  cursor.value_ = &value;
  return cursor;
}

void JsonCursor::expect_object() const {
  if (!value_->is_object()) fail("an object");
}

void JsonCursor::expect_keys(std::span<const std::string_view> known, const std::string& called) const {
  expect_object();
  for (const auto& [key, value] : value_->members())
    if (std::find(known.begin(), known.end(), key) == known.end())
      at(value).fail(called.empty() ? "one of the keys " + names_of(known) : called,
                     in_quotes(key) + did_you_mean(key, {known.begin(), known.end()}));
}

void JsonCursor::expect_all(const std::vector<std::string>& keys) const {
  constexpr std::size_t kNamed = 10;
  std::vector<std::string> missing;
  for (const std::string& key : keys)
    if (!has(key)) missing.push_back(key);
  if (missing.empty()) return;
  std::string names;
  for (std::size_t i = 0; i < std::min(missing.size(), kNamed); ++i)
    names += (i > 0 ? ", " : "") + in_quotes(missing[i]);
  if (missing.size() > kNamed) names += " and " + std::to_string(missing.size() - kNamed) + " more";
  fail(missing.size() == 1 ? "the key " + names : "the keys " + names,
       "none" + std::string(missing.size() == 1 ? "" : " of them"));
}

bool JsonCursor::has(std::string_view key) const {
  expect_object();
  return value_->contains(key);
}

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
  expect_object();
  const Json* const found = value_->find(key);
  if (!found) return std::nullopt;
  return at(*found);
}

JsonCursor JsonCursor::operator[](std::string_view key) const {
  const std::optional<JsonCursor> found = find(key);
  if (!found) fail("the key " + in_quotes(key), "none");
  return *found;
}

std::vector<std::pair<std::string, JsonCursor>> JsonCursor::members() const {
  expect_object();
  std::vector<std::pair<std::string, JsonCursor>> result;
  for (const auto& [key, value] : value_->members()) result.emplace_back(key, at(value));
  return result;
}

std::vector<JsonCursor> JsonCursor::elements() const {
  if (!value_->is_array()) fail("an array");
  std::vector<JsonCursor> result;
  for (const Json& value : value_->elements()) result.push_back(at(value));
  return result;
}

double JsonCursor::number() const {
  if (!value_->is_number()) fail("a number");
  return value_->get<double>();
}

double JsonCursor::number_between(double low, double high) const {
  const double value = number_or_nan(*value_);
  if (!(value > low && value < high)) {
    fail("a number above " + number_text(low) + (std::isinf(high) ? "" : " and below " + number_text(high)));
  }
  return value;
}

double JsonCursor::number(double low, double high) const {
  const double value = number_or_nan(*value_);
  if (!(value >= low && value <= high)) fail(range_text(low, high));
  return value;
}

float JsonCursor::real(float low, float high) const { return static_cast<float>(number(low, high)); }

float JsonCursor::fraction() const {
  const double value = number_or_nan(*value_);
  if (!(value >= 0 && value <= 1)) fail(kFraction);
  return static_cast<float>(value);
}

bool JsonCursor::boolean() const {
  if (!value_->is_boolean()) fail("true or false");
  return value_->get<bool>();
}

std::uint32_t JsonCursor::integer(std::uint32_t low, std::uint32_t high) const {
  const double value = number_or_nan(*value_);
  if (!(value >= low && value <= high && value == std::floor(value))) {
    fail(low == high ? std::to_string(low) : "an integer " + std::to_string(low) + ".." + std::to_string(high));
  }
  return static_cast<std::uint32_t>(value);
}

std::string JsonCursor::string() const {
  if (!value_->is_string()) fail("a string");
  return value_->get<std::string>();
}

std::size_t JsonCursor::choice(std::span<const std::string_view> names) const {
  const auto name =
      value_->is_string() ? std::find(names.begin(), names.end(), value_->get<std::string>()) : names.end();
  if (name == names.end()) fail("one of " + names_of(names));
  return static_cast<std::size_t>(name - names.begin());
}

void JsonCursor::expect_numbers(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) fail("an array of " + std::to_string(count) + " numbers");
}

std::vector<double> JsonCursor::numbers(std::size_t count) const {
  expect_numbers(count);
  std::vector<double> result;
  for (const Json& value : value_->elements()) result.push_back(at(value).number());
  return result;
}

glm::dvec3 JsonCursor::vec3() const { return glm::make_vec3(numbers(3).data()); }

glm::vec3 JsonCursor::color() const {
  expect_numbers(3);
  return colors()[0];
}

glm::vec4 JsonCursor::rgba() const {
  expect_numbers(4);
  return rgbas()[0];
}

glm::dmat4 JsonCursor::matrix() const { return glm::make_mat4(numbers(16).data()); }

template <class Vector, class IsValid>
std::vector<Vector> JsonCursor::vectors_of(const std::string& expected, IsValid is_valid) const {
  constexpr std::size_t kLength = Vector::length();
  constexpr const char* kCounts[] = {"two", "three", "four"};
  if (!value_->is_array() || value_->size() % kLength != 0) {
    fail(std::string("an array of numbers, ") + kCounts[kLength - 2] + " for each item");
  }
  const Json::Array& array = value_->elements();
  std::vector<Vector> result(array.size() / kLength);
  for (std::size_t i = 0; i < array.size(); ++i) {
    const double value = number_or_nan(array[i]);
    if (!is_valid(value)) at(array[i]).fail(expected);
    result[i / kLength][static_cast<int>(i % kLength)] = static_cast<typename Vector::value_type>(value);
  }
  return result;
}

std::vector<glm::vec2> JsonCursor::vec2s() const { return vectors_of<glm::vec2>(kReal, is_float); }
std::vector<glm::vec3> JsonCursor::vec3s() const { return vectors_of<glm::vec3>(kReal, is_float); }
std::vector<glm::vec4> JsonCursor::vec4s() const { return vectors_of<glm::vec4>(kReal, is_float); }

std::vector<glm::vec3> JsonCursor::colors() const {
  return vectors_of<glm::vec3>(range_text(0, kMostColor), is_intensity);
}

std::vector<glm::vec4> JsonCursor::rgbas() const {
  std::vector<glm::vec4> result = vectors_of<glm::vec4>(range_text(0, kMostColor), is_intensity);
  for (std::size_t i = 0; i < result.size(); ++i)
    if (result[i].a > 1) at(value_->elements()[4 * i + 3]).fail(kFraction);
  return result;
}

std::vector<glm::uvec3> JsonCursor::triples(std::uint32_t count) const {
  return vectors_of<glm::uvec3>(
      "an integer below the number of positions, " + std::to_string(count),
      [count](double value) { return value >= 0 && value < count && value == std::floor(value); });
}

}  // namespace beampipe

#include "traces/json_cursor.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "traces/input_file.h"

namespace beampipe {
namespace {

// Nested arrays and objects: a report has 8 levels, a trace has 6. The parser takes 200 bytes for each "[" that is
// open.
constexpr std::size_t kMostLevels = 32;

constexpr std::size_t kLongestFound = 60;  // characters of a value that a message shows

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string place_in(const std::string& file, const Json::json_pointer& pointer) {
  return file + ": " + (pointer.empty() ? "/" : pointer.to_string());
}

// The library's message without its prefixes: "line 3, column 7: syntax error ...".
std::string reason_of(const std::exception& error) {
  std::string message = error.what();
  for (const std::string_view end_of_prefix : {"] ", "parse error at "}) {
    const std::size_t found = message.find(end_of_prefix);
    if (found != std::string::npos) message.erase(0, found + end_of_prefix.size());
  }
  return message;
}

// Builds the value of a file and knows the place of each part while it is read. The library offers a callback as well,
// but then it searches an array again at the end of each object in it, which takes the square of their number.
class Builder : public nlohmann::json_sax<Json> {
 public:
  // The parser must read from `stream`.
  Builder(const std::string& file, std::istream& stream) : file_(file), stream_(stream) {}

  Json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(std::move(value)); }
  bool start_object(std::size_t) override { return enter(Json::object()); }
  bool start_array(std::size_t) override { return enter(Json::array()); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool key(string_t& key) override {
    levels_.back().key = key;
    if (!levels_.back().keys.insert(key).second) fail_trace(where(), "each key once", in_quotes(key) + " again");
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const Json::exception& error) override {
    if (dynamic_cast<const Json::out_of_range*>(&error)) fail_trace(where(), "a finite number", reason_of(error));
    fail_trace(file_ + ": byte " + std::to_string(byte), "valid JSON", reason_of(error));
  }

 private:
  // The place of the value that comes next.
  std::string where() const {
    Json::json_pointer pointer;
    for (const Level& level : levels_) {
      if (!level.value->is_array()) {
        pointer /= level.key;
      } else {  // all arrays but the innermost hold the element that is open already
        pointer /= level.value->size() - (&level == &levels_.back() ? 0 : 1);
      }
    }
    return place_in(file_, pointer);
  }

  // Appends to the array or object that is open. The keys of an object are known to differ.
  Json& place(Json&& value) {
    if (levels_.empty()) return root_ = std::move(value);
    Json& parent = *levels_.back().value;
    if (parent.is_array()) return parent.emplace_back(std::move(value));
    auto& members = parent.get_ref<Json::object_t&>();
    return static_cast<Json::object_t::Container&>(members).emplace_back(levels_.back().key, std::move(value)).second;
  }
  bool add(Json&& value) {
    place(std::move(value));
    return true;
  }
  bool enter(Json&& value) {
    if (levels_.size() == kMostLevels) {
      fail_trace(file_ + ": byte " + std::to_string(stream_.tellg()),
                 "at most " + std::to_string(kMostLevels) + " levels of arrays and objects", "more");
    }
    Json& placed = place(std::move(value));
    levels_.push_back({&placed, "", {}});
    return true;
  }
  bool leave() {
    levels_.pop_back();
    return true;
  }

  struct Level {
    Json* value;  // array or object; it is not moved while it is open
    std::string key;
    std::set<std::string> keys;
  };

  const std::string& file_;
  std::istream& stream_;
  Json root_;
  std::vector<Level> levels_;
};

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

// Extends the pointer to `from` so that it points to `wanted`. False if that is not in `from`.
bool extend_to(const Json& wanted, const Json& from, Json::json_pointer& pointer) {
  if (&from == &wanted) return true;
  if (!from.is_structured()) return false;
  for (const auto& [key, value] : from.items()) {
    pointer.push_back(key);
    if (extend_to(wanted, value, pointer)) return true;
    pointer.pop_back();
  }
  return false;
}

bool is_float(double value) { return std::isfinite(static_cast<float>(value)); }

}  // namespace

Json parse_json(const std::string& file) {
  std::ifstream stream = open_input_file(file, file);
  Builder builder(file, stream);
  Json::sax_parse(stream, &builder);
  return builder.take();
}

std::string in_quotes(std::string_view text) {
  const bool long_text = text.size() > kLongestFound;
  const auto replace = Json::error_handler_t::replace;  // cutting may have split a UTF-8 sequence
  return Json(text.substr(0, kLongestFound)).dump(-1, ' ', false, replace) + (long_text ? "..." : "");
}

std::optional<std::string> json_string(std::string_view text) {
  try {
    return Json(text).dump();
  } catch (const Json::type_error&) {
    return std::nullopt;
  }
}

struct JsonCursor::Document {
  std::string file;
  Json json;
};

JsonCursor::JsonCursor(const std::string& file)
    : document_(std::make_shared<const Document>(Document{file, parse_json(file)})), value_(&document_->json) {}

void JsonCursor::fail(const std::string& expected, const std::string& found) const {
  fail_trace(where(), expected, found);
}

std::string JsonCursor::where() const {
  Json::json_pointer pointer;
  extend_to(*value_, document_->json, pointer);
  return place_in(document_->file, pointer);
}

std::string JsonCursor::found() const {
  if (value_->is_array()) return "an array of " + std::to_string(value_->size());
  if (value_->is_object()) return "an object";
  if (value_->is_string()) return in_quotes(value_->get_ref<const std::string&>());
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

void JsonCursor::expect_keys(std::initializer_list<std::string_view> known) const {
  expect_object();
  for (const auto& [key, value] : value_->items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      at(value).fail("one of the keys " + names_of(known), in_quotes(key));
}

bool JsonCursor::has(std::string_view key) const {
  expect_object();
  return value_->contains(key);
}

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
  expect_object();
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
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
  for (const auto& [key, value] : value_->items()) result.emplace_back(key, at(value));
  return result;
}

std::vector<JsonCursor> JsonCursor::elements() const {
  if (!value_->is_array()) fail("an array");
  std::vector<JsonCursor> result;
  for (const Json& value : *value_) result.push_back(at(value));
  return result;
}

double JsonCursor::number() const {
  if (!value_->is_number()) fail("a number");
  return value_->get<double>();
}

double JsonCursor::number_or_nan() const { return value_->is_number() ? value_->get<double>() : kNan; }

double JsonCursor::number_between(double low, double high) const {
  const double value = number_or_nan();
  if (!(value > low && value < high)) {
    fail("a number above " + number_text(low) + (std::isinf(high) ? "" : " and below " + number_text(high)));
  }
  return value;
}

std::uint32_t JsonCursor::integer(std::uint32_t low, std::uint32_t high) const {
  const double value = number_or_nan();
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
      value_->is_string() ? std::find(names.begin(), names.end(), value_->get_ref<const std::string&>()) : names.end();
  if (name == names.end()) fail("one of " + names_of(names));
  return static_cast<std::size_t>(name - names.begin());
}

void JsonCursor::expect_numbers(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) fail("an array of " + std::to_string(count) + " numbers");
}

std::vector<double> JsonCursor::numbers(std::size_t count) const {
  expect_numbers(count);
  std::vector<double> result;
  for (const Json& value : *value_) result.push_back(at(value).number());
  return result;
}

glm::dvec3 JsonCursor::vec3() const { return glm::make_vec3(numbers(3).data()); }

glm::vec3 JsonCursor::color() const {
  expect_numbers(3);
  return colors()[0];
}

glm::dmat4 JsonCursor::matrix() const { return glm::make_mat4(numbers(16).data()); }

template <class Vector, class IsValid>
std::vector<Vector> JsonCursor::triples_of(const std::string& expected, IsValid is_valid) const {
  if (!value_->is_array() || value_->size() % 3 != 0) fail("an array of numbers, three for each item");
  const Json& array = *value_;
  std::vector<Vector> result(array.size() / 3);
  for (std::size_t i = 0; i < array.size(); ++i) {
    const double value = array[i].is_number() ? array[i].get<double>() : kNan;
    if (!is_valid(value)) at(array[i]).fail(expected);
    result[i / 3][static_cast<int>(i % 3)] = static_cast<typename Vector::value_type>(value);
  }
  return result;
}

std::vector<glm::vec3> JsonCursor::vec3s() const {
  return triples_of<glm::vec3>("a number in a float's range", is_float);
}

std::vector<glm::vec3> JsonCursor::colors() const {
  return triples_of<glm::vec3>("a number, 0 and up",
                               [](double value) { return is_float(value) && static_cast<float>(value) >= 0; });
}

std::vector<glm::uvec3> JsonCursor::triples(std::uint32_t count) const {
  return triples_of<glm::uvec3>(
      "an integer below the number of positions, " + std::to_string(count),
      [count](double value) { return value >= 0 && value < count && value == std::floor(value); });
}

}  // namespace beampipe

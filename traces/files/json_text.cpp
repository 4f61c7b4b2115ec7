// Turns text into values and back with the JSON library. The library accepts duplicate keys and any depth, and its
// messages are long; Builder below refuses the former and shortens the latter.
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string_view>

#include "traces/files/input_file.h"
#include "traces/files/json.h"

namespace beampipe {
namespace {

using Library = nlohmann::ordered_json;

// Nested arrays and objects: a report has 8 levels, a trace has 6. The parser takes 200 bytes for each "[" that is
// open.
constexpr std::size_t kMostLevels = 32;

constexpr std::size_t kLongestQuote = 60;  // bytes of a text that a message shows

// The library's message without its prefixes: "line 3, column 7: syntax error ...".
std::string reason_of(const std::exception& error) {
  std::string message = error.what();
  for (const std::string_view end_of_prefix : {"] ", "parse error at "}) {
    const std::size_t found = message.find(end_of_prefix);
    if (found != std::string::npos) message.erase(0, found + end_of_prefix.size());
  }
  return message;
}

std::string place_in(const std::string& file, const Library::json_pointer& pointer) {
  return file + ": " + (pointer.empty() ? "/" : pointer.to_string());
}

// Builds the value of a text and knows the place of each part while it is read. The library offers a callback as well,
// but then it searches an array again at the end of each object in it, which takes the square of their number.
class Builder : public nlohmann::json_sax<Library> {
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
  bool binary(binary_t&) override { return false; }  // texts have none
  bool start_object(std::size_t) override { return enter(Json::object()); }
  bool start_array(std::size_t) override { return enter(Json::array()); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool key(string_t& key) override {
    levels_.back().key = key;
    if (!levels_.back().keys.insert(key).second) fail_trace(where(), "each key once", in_quotes(key) + " again");
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const Library::exception& error) override {
    if (dynamic_cast<const Library::out_of_range*>(&error)) fail_trace(where(), "a finite number", reason_of(error));
    fail_trace(file_ + ": byte " + std::to_string(byte), "valid JSON", reason_of(error));
  }

 private:
  // The place of the value that comes next.
  std::string where() const {
    Library::json_pointer pointer;
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
    if (parent.is_array()) return parent.elements().emplace_back(std::move(value));
    return parent.members().emplace_back(Json::Member{levels_.back().key, std::move(value)}).value;
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

Json parse(std::istream& stream, const std::string& name) {
  Builder builder(name, stream);
  Library::sax_parse(stream, &builder);
  return builder.take();
}

Library to_library(const Json& json) {
  if (json.is_null()) return nullptr;
  if (json.is_string()) return json.get<std::string>();
  if (json.is_unsigned()) return json.get<std::uint64_t>();
  if (json.is_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  if (json.is_array()) {
    Library array = Library::array();
    for (const Json& element : json.elements()) array.push_back(to_library(element));
    return array;
  }
  if (json.is_object()) {
    Library::object_t object;
    for (const auto& [key, value] : json.members())
      static_cast<Library::object_t::Container&>(object).emplace_back(key, to_library(value));
    return object;
  }
  return json.get<bool>();
}

// Extends the pointer to `from` so that it points to `value`. False if that is not in `from`.
bool extend_to(const Json& value, const Json& from, Library::json_pointer& pointer) {
  if (&from == &value) return true;
  const auto is_below = [&](auto step, const Json& child) {
    pointer /= step;
    if (extend_to(value, child, pointer)) return true;
    pointer.pop_back();
    return false;
  };
  if (from.is_array())
    for (std::size_t i = 0; i < from.size(); ++i)
      if (is_below(i, from.elements()[i])) return true;
  if (from.is_object())
    for (const auto& [key, child] : from.members())
      if (is_below(key, child)) return true;
  return false;
}

}  // namespace

std::string Json::dump(int indent) const {
  return to_library(*this).dump(indent, ' ', false, Library::error_handler_t::replace);
}

std::string json_text(const Json& json) { return json.dump(2) + "\n"; }

std::string json_string(const std::string& text) {
  try {
    return Library(text).dump();
  } catch (const Library::exception&) {
    throw JsonError("expected UTF-8, found other bytes");
  }
}

std::string in_quotes(std::string_view text) {
  const bool is_long = text.size() > kLongestQuote;
  return Json(text.substr(0, kLongestQuote)).dump() + (is_long ? "..." : "");  // the cut may have split a character
}

std::string pointer_to(const Json& value, const Json& root) {
  Library::json_pointer pointer;
  extend_to(value, root, pointer);
  return pointer.to_string();
}

Json parse_json(const std::string& file) {
  std::ifstream stream = open_input_file(file, file);
  return parse(stream, file);
}

Json parse_json_text(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  return parse(stream, name);
}

}  // namespace beampipe

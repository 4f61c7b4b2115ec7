// A JSON value and its text. nlohmann::json, which parses and prints it, is known to traces/files/json_text.cpp alone:
// its templates would take seconds in every file that sees them.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace beampipe {

// One line: a value is not of the type that was asked for, or lacks the key or index.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// null, true or false, a number, a string, an array, or an object that keeps the order of its keys. Integers and
// floating-point numbers are told apart, as their texts differ: 1 and 1.0.
class Json {
 public:
  struct Member;
  using Array = std::vector<Json>;
  using Object = std::vector<Member>;

  Json(std::nullptr_t = nullptr) {}
  template <std::integral Integer>
  Json(Integer value) {
    if constexpr (std::same_as<Integer, bool>) {
      value_ = value;
    } else if (value < 0) {
      value_ = static_cast<std::int64_t>(value);
    } else {
      value_ = static_cast<std::uint64_t>(value);
    }
  }
  Json(std::floating_point auto value) : value_(static_cast<double>(value)) {}
  Json(std::string value);
  Json(std::string_view value) : Json(std::string(value)) {}
  Json(const char* value) : Json(std::string(value)) {}
  Json(std::initializer_list<Member> members);  // an object: Json({{"width", 4}, {"name", "fence"}})
  template <class Item>
  Json(const std::vector<Item>& items) : Json(array()) {
    for (const Item& item : items) push_back(item);
  }
  static Json array(std::initializer_list<Json> elements = {});
  static Json object();

  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(Json other) noexcept;
  ~Json();

  bool is_null() const { return std::holds_alternative<std::nullptr_t>(value_); }
  bool is_boolean() const { return std::holds_alternative<bool>(value_); }
  bool is_unsigned() const { return std::holds_alternative<std::uint64_t>(value_); }  // an integer, 0 and up
  bool is_integer() const { return is_unsigned() || std::holds_alternative<std::int64_t>(value_); }
  bool is_number() const { return is_integer() || std::holds_alternative<double>(value_); }
  bool is_string() const { return std::holds_alternative<std::unique_ptr<std::string>>(value_); }
  bool is_array() const { return std::holds_alternative<std::unique_ptr<Array>>(value_); }
  bool is_object() const { return std::holds_alternative<std::unique_ptr<Object>>(value_); }

  // The value as bool, double, int, std::int64_t, std::uint32_t, std::uint64_t or std::string. A fraction is cut off
  // where an integer is asked for. Throws JsonError when it is of another kind, or does not fit.
  template <class Value>
  Value get() const;

  // Of an array or object; 0 of everything else.
  std::size_t size() const;

  // Throw JsonError when it is not an array (object). Not of a temporary value, which a loop over them would outlive.
  const Array& elements() const&;
  Array& elements() &;
  const Array& elements() && = delete;
  const Object& members() const&;
  Object& members() &;
  const Object& members() && = delete;

  // Of an array; null becomes one. Throws JsonError when it is something else.
  void push_back(Json element);
  const Json& at(std::size_t index) const;  // throws JsonError too when there is none
  const Json& operator[](std::size_t index) const { return at(index); }
  Json& operator[](std::size_t index) { return const_cast<Json&>(at(index)); }

  // Of an object. `find` gives null when there is no such key, or no object; `at` throws JsonError then.
  const Json* find(std::string_view key) const;
  bool contains(std::string_view key) const { return find(key) != nullptr; }
  const Json& at(std::string_view key) const;
  const Json& operator[](std::string_view key) const { return at(key); }
  Json& operator[](std::string_view key);  // adds null under a new key; null becomes an object
  void erase(std::string_view key);

  // The value under a key, or `otherwise` where it is missing.
  template <class Value>
  Value value(std::string_view key, Value otherwise) const {
    const Json* member = find(key);
    if constexpr (std::same_as<Value, Json>) {
      return member ? *member : otherwise;
    } else {
      return member ? member->get<Value>() : otherwise;
    }
  }

  // Numbers are equal when their values are; objects when they have the same members in the same order.
  bool operator==(const Json& other) const;

  // On one line, or with each member and element on its own, indented by `indent` blanks per level. Numbers that are
  // not finite become null. Bytes that are not UTF-8 are replaced.
  std::string dump(int indent = -1) const;

 private:
  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::unique_ptr<std::string>,
               std::unique_ptr<Array>, std::unique_ptr<Object>>
      value_;
};

struct Json::Member {
  std::string key;
  Json value;
  bool operator==(const Member&) const = default;
};

// The text of a JSON file: indented by two blanks, with an end of line.
std::string json_text(const Json& json);

// A JSON string with its quotes. Throws JsonError when the text is not UTF-8.
std::string json_string(const std::string& text);

// The same for messages: long texts are cut, and bytes that are not UTF-8 are replaced.
std::string in_quotes(std::string_view text);

// The JSON pointer of `value`, which must be `root` or in it; "" of `root` itself. Takes time in proportion to `root`.
std::string pointer_to(const Json& value, const Json& root);

// Parses a whole file; broken JSON, duplicate keys, numbers out of range, more than 32 levels of arrays and objects,
// and what open_input_file refuses throw TraceError.
Json parse_json(const std::string& file);

// The same for a text; `name` stands for the file's in messages.
Json parse_json_text(const std::string& text, const std::string& name);

}  // namespace beampipe

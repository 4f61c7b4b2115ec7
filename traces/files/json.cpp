#include "traces/files/json.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace beampipe {
namespace {

[[noreturn]] void fail(const char* expected, const Json& found) {
  const char* kind = found.is_null()     ? "null"
                     : found.is_number() ? "a number"
                     : found.is_string() ? "a string"
                     : found.is_array()  ? "an array"
                     : found.is_object() ? "an object"
                                         : "true or false";
  throw JsonError(std::string("expected ") + expected + ", found " + kind);
}

// Without the fraction of a number. What does not fit is refused.
template <class Integer, class Number>
Integer to_integer(Number number, const Json& json) {
  using Limits = std::numeric_limits<Integer>;
  bool is_less = false, is_more = false;
  if constexpr (std::is_floating_point_v<Number>) {
    constexpr double kEnd = 2.0 * static_cast<double>(Limits::max() / 2 + 1);
    is_less = !(std::trunc(number) >= static_cast<double>(Limits::min()));
    is_more = number >= kEnd;
  } else {
    is_less = std::cmp_less(number, Limits::min());
    is_more = std::cmp_greater(number, Limits::max());
  }
  if (is_less || is_more)
    throw JsonError(std::string("expected a ") + (is_less ? "larger" : "smaller") + " number, found " + json.dump());
  return static_cast<Integer>(number);
}

}  // namespace

Json::Json(std::string value) : value_(std::make_unique<std::string>(std::move(value))) {}

Json::Json(std::initializer_list<Member> members) : value_(std::make_unique<Object>(members)) {}

Json Json::array(std::initializer_list<Json> elements) {
  Json json;
  json.value_ = std::make_unique<Array>(elements);
  return json;
}

Json Json::object() {
  Json json;
  json.value_ = std::make_unique<Object>();
  return json;
}

Json::Json(const Json& other) {
  const auto copy = [](const auto& value) -> decltype(value_) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (requires { typename Value::element_type; }) {
      return std::make_unique<typename Value::element_type>(*value);
    } else {
      return value;
    }
  };
  value_ = std::visit(copy, other.value_);
}

Json::Json(Json&& other) noexcept : value_(std::exchange(other.value_, nullptr)) {}

Json& Json::operator=(Json other) noexcept {
  value_.swap(other.value_);
  return *this;
}

Json::~Json() = default;

template <class Value>
Value Json::get() const {
  if constexpr (std::same_as<Value, bool>) {
    if (const bool* value = std::get_if<bool>(&value_)) return *value;
    fail("true or false", *this);
  } else if constexpr (std::same_as<Value, std::string>) {
    if (is_string()) return *std::get<std::unique_ptr<std::string>>(value_);
    fail("a string", *this);
  } else {
    const auto converted = [this](auto number) {
      if constexpr (std::same_as<Value, double>) {
        return static_cast<double>(number);
      } else {
        return to_integer<Value>(number, *this);
      }
    };
    if (const auto* value = std::get_if<double>(&value_)) return converted(*value);
    if (const auto* value = std::get_if<std::uint64_t>(&value_)) return converted(*value);
    if (const auto* value = std::get_if<std::int64_t>(&value_)) return converted(*value);
    fail("a number", *this);
  }
}
template bool Json::get() const;
template std::string Json::get() const;
template double Json::get() const;
template int Json::get() const;
template std::int64_t Json::get() const;
template std::uint32_t Json::get() const;
template std::uint64_t Json::get() const;

std::size_t Json::size() const { return is_array() ? elements().size() : is_object() ? members().size() : 0; }

const Json::Array& Json::elements() const& {
  if (!is_array()) fail("an array", *this);
  return *std::get<std::unique_ptr<Array>>(value_);
}

Json::Array& Json::elements() & { return const_cast<Array&>(std::as_const(*this).elements()); }

const Json::Object& Json::members() const& {
  if (!is_object()) fail("an object", *this);
  return *std::get<std::unique_ptr<Object>>(value_);
}

Json::Object& Json::members() & { return const_cast<Object&>(std::as_const(*this).members()); }

void Json::push_back(Json element) {
  if (is_null()) *this = array();
  elements().push_back(std::move(element));
}

const Json& Json::at(std::size_t index) const {
  if (index < elements().size()) return elements()[index];
  throw JsonError("expected an array with an element " + std::to_string(index) + ", found one of " +
                  std::to_string(size()));
}

const Json* Json::find(std::string_view key) const {
  if (!is_object()) return nullptr;
  const auto found =
      std::find_if(members().begin(), members().end(), [&](const Member& member) { return member.key == key; });
  return found == members().end() ? nullptr : &found->value;
}

const Json& Json::at(std::string_view key) const {
  if (const Json* value = find(key)) return *value;
  members();  // throws when it is no object
  throw JsonError("expected the key \"" + std::string(key) + "\", found none");
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) *this = object();
  if (const Json* value = find(key)) return const_cast<Json&>(*value);
  return members().emplace_back(Member{std::string(key), nullptr}).value;
}

void Json::erase(std::string_view key) {
  std::erase_if(members(), [&](const Member& member) { return member.key == key; });
}

bool Json::operator==(const Json& other) const {
  if (is_number() && other.is_number()) {
    if (is_unsigned() && other.is_unsigned()) return value_ == other.value_;
    return get<double>() == other.get<double>();
  }
  if (is_string() && other.is_string()) return get<std::string>() == other.get<std::string>();
  if (is_array() && other.is_array()) return elements() == other.elements();
  if (is_object() && other.is_object()) return members() == other.members();
  return value_ == other.value_;  // both null or both boolean, else of different kinds
}

}  // namespace beampipe

// A JSON Schema and the program's reader must not drift apart: both name, require and limit the same things.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/tools/fixtures.h"

namespace beampipe {

// Changes one thing at a time in an example that has every key of the schema, and compares what the schema and the
// reader say of it.
class SchemaAgreement {
 public:
  using Value = nlohmann::ordered_json;
  using Pointer = Value::json_pointer;

  // `read` throws if it refuses a text. `bound`: pointers of values that must fit to others, of which the schema knows
  // nothing; there the reader may refuse what the schema accepts. `elsewhere`: pointers of objects whose keys are the
  // same as in another place, so that the example need not have all of them.
  SchemaAgreement(const std::filesystem::path& schema, const std::filesystem::path& example,
                  std::function<void(const std::string& text)> read, std::set<std::string> bound = {},
                  std::set<std::string> elsewhere = {})
      : schema_(Value::parse(read_text(schema))),
        example_(Value::parse(read_text(example))),
        read_(std::move(read)),
        bound_(std::move(bound)),
        elsewhere_(std::move(elsewhere)) {}

  void check() {
    EXPECT_EQ(refusal(example_), "");
    check(schema_, "");
    EXPECT_GT(changes_, 30) << "not much of the schema was compared";
  }

 private:
  std::string refusal(const Value& value) const {
    try {
      read_(value.dump());
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  void expect(bool accepted, const std::string& at, const std::string& what, const Value& changed) {
    if (accepted && is_bound(at)) return;
    ++changes_;
    const std::string found = refusal(changed);
    EXPECT_EQ(found.empty(), accepted) << at << ", " << what << ": " << found;
    EXPECT_EQ(found.find('\n'), found.npos) << found;
  }

  bool is_bound(const std::string& at) const {
    for (const std::string& each : bound_)
      if (at == each || at.starts_with(each + "/")) return true;
    return false;
  }

  // The example with another value at a place; null removes the member.
  Value with(const std::string& at, const Value& value) const {
    Value changed = example_;
    const Pointer pointer(at);
    if (value.is_null()) {
      changed.at(pointer.parent_pointer()).erase(pointer.back());
    } else {
      changed[pointer] = value;
    }
    return changed;
  }

  void check(const Value& described, const std::string& at) {
    const Value& rule =
        described.contains("$ref") ? schema_.at(Pointer(described["$ref"].get<std::string>().substr(1))) : described;
    EXPECT_GT(rule.value("description", described.value("description", "")).size(), 4u) << at;
    if (rule.contains("oneOf")) {
      for (const Value& each : rule["oneOf"])
        if (each.value("type", "") == type_of(example_.at(Pointer(at)))) return check_value(each, at);
      ADD_FAILURE() << at << ": the example has none of the schema's types";
    }
    check_value(rule, at);
  }

  void check_value(const Value& rule, const std::string& at) {
    const Value& value = example_.at(Pointer(at));
    if (rule.value("type", "") == "object") return check_object(rule, at);
    if (rule.contains("items")) {
      ASSERT_TRUE(value.is_array() && !value.empty()) << at;
      if (rule.value("minItems", 0) == 1) expect(false, at, "empty", with(at, Value::array()));
      const Value& items = rule["items"];
      return items.contains("description") || items.contains("$ref") ? check(items, at + "/0")
                                                                     : check_value(items, at + "/0");
    }
    expect(false, at, "an object", with(at, Value::object()));
    for (const char* limit : {"minimum", "maximum"}) {
      if (!rule.contains(limit)) continue;
      expect(true, at, limit, with(at, rule[limit]));
      const double beyond = rule[limit].get<double>() + (limit[1] == 'i' ? -1 : 1);
      expect(false, at, std::string("beyond ") + limit,
             rule["type"] == "integer" ? with(at, static_cast<std::int64_t>(beyond)) : with(at, beyond));
    }
    if (rule.contains("exclusiveMinimum")) expect(false, at, "exclusiveMinimum", with(at, rule["exclusiveMinimum"]));
    if (rule.contains("minLength")) expect(false, at, "empty text", with(at, ""));
    if (rule.value("type", "") == "integer") expect(false, at, "a fraction", with(at, 1.5));
    if (rule.value("type", "") != "string") expect(false, at, "a text", with(at, "no such thing"));
    if (rule.contains("enum"))
      for (const Value& each : rule["enum"]) expect(true, at, "enum " + each.dump(), with(at, each));
    if (rule.contains("const")) expect(false, at, "another constant", with(at, 99));
  }

  void check_object(const Value& rule, const std::string& at) {
    const Value& value = example_.at(Pointer(at));
    const std::set<std::string> required = rule.value("required", std::set<std::string>{});
    const Value rest = rule.value("additionalProperties", Value(true));
    if (rule.contains("properties")) {
      for (const auto& [key, described] : rule["properties"].items()) {
        EXPECT_TRUE(value.contains(key) || elsewhere_.contains(at)) << at << "/" << key << " is not in the example";
        if (!value.contains(key)) continue;
        expect(!required.contains(key), at + "/" + key, "left out", with(at + "/" + key, nullptr));
        check(described, at + "/" + key);
      }
    }
    if (rest == Value(false)) expect(false, at, "another key", with(at + "/no_such_key", 1));
    if (!rest.is_object()) return;
    for (const auto& [key, member] : value.items())
      if (!rule.contains("properties") || !rule["properties"].contains(key)) check_value_of(rest, at + "/" + key);
  }

  void check_value_of(const Value& rule, const std::string& at) {
    rule.contains("$ref") ? check(rule, at) : check_value(rule, at);
  }

  static std::string type_of(const Value& value) {
    return value.is_array() ? "array" : value.is_object() ? "object" : value.is_string() ? "string" : "number";
  }

  Value schema_, example_;
  std::function<void(const std::string&)> read_;
  std::set<std::string> bound_, elsewhere_;
  int changes_ = 0;
};

}  // namespace beampipe

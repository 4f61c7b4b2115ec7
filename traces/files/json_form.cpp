#include "traces/files/json_form.h"

#include <bit>
#include <cmath>

#include "traces/material.h"

namespace beampipe {
namespace {

template <class Value>
Json write_value(const Value& value) {
  return value;
}

Json limits(const char* type, double low, double high) {
  Json schema = {{"type", type}};
  const auto whole = [](double value) {
    return value == std::floor(value) && std::abs(value) < 1e15 ? Json(static_cast<std::int64_t>(value)) : Json(value);
  };
  schema["minimum"] = whole(low);
  schema["maximum"] = whole(high);
  return schema;
}

}  // namespace

Json described(Json schema, const std::string& meaning) {
  Json json = {{"description", meaning}};
  for (auto& [key, value] : schema.members()) json[key] = std::move(value);
  return json;
}

Json schema_file(const Json& schema, const std::string& title) {
  Json json = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  for (const auto& [key, value] : schema.members()) json[key] = value;
  return json;
}

namespace form {

Form<bool> boolean() {
  return {{{"type", "boolean"}}, [](const JsonCursor& at, bool& value) { value = at.boolean(); }, write_value<bool>};
}

Form<std::string> text() {
  return {{{"type", "string"}},
          [](const JsonCursor& at, std::string& value) { value = at.string(); },
          write_value<std::string>};
}

Form<std::string> text(const std::string& meaning) {
  return {{{"type", "string"}, {"minLength", 1}},
          [meaning](const JsonCursor& at, std::string& value) {
            value = at.string();
            if (value.empty()) at.fail(meaning, "nothing");
          },
          write_value<std::string>};
}

Form<std::string> one_of(const std::vector<std::string>& names) {
  return {{{"enum", Json(names)}},
          [names](const JsonCursor& at, std::string& value) {
            value = names[at.choice(std::vector<std::string_view>(names.begin(), names.end()))];
          },
          write_value<std::string>};
}

Form<double> number() {
  return {{{"type", "number"}}, [](const JsonCursor& at, double& value) { value = at.number(); }, write_value<double>};
}

Form<double> number(double low, double high) {
  return {limits("number", low, high),
          [low, high](const JsonCursor& at, double& value) { value = at.number(low, high); }, write_value<double>};
}

Form<double> number_between(double low, double high) {
  Json schema = {{"type", "number"}, {"exclusiveMinimum", low}};
  if (std::isfinite(high)) schema["exclusiveMaximum"] = high;
  return {schema, [low, high](const JsonCursor& at, double& value) { value = at.number_between(low, high); },
          write_value<double>};
}

Form<float> real(float low, float high) {
  return {limits("number", low, high), [low, high](const JsonCursor& at, float& value) { value = at.real(low, high); },
          write_value<float>};
}

Form<float> fraction() {
  return {limits("number", 0, 1), [](const JsonCursor& at, float& value) { value = at.fraction(); },
          write_value<float>};
}

Form<std::uint32_t> integer(std::uint32_t low, std::uint32_t high) {
  return {limits("integer", low, high),
          [low, high](const JsonCursor& at, std::uint32_t& value) { value = at.integer(low, high); },
          write_value<std::uint32_t>};
}

Form<std::uint32_t> power_of_two(std::uint32_t low, std::uint32_t high) {
  Json schema;
  for (std::uint64_t power = low; power <= high; power *= 2) schema["enum"].push_back(power);
  return {schema,
          [low, high](const JsonCursor& at, std::uint32_t& value) {
            value = at.integer(low, high);
            if (!std::has_single_bit(value))
              at.fail("a power of two from " + std::to_string(low) + " to " + std::to_string(high));
          },
          write_value<std::uint32_t>};
}

Form<std::uint32_t> version(std::uint32_t number) {
  Form<std::uint32_t> form = integer(number, number);
  form.schema = {{"const", number}};
  return form;
}

Json array_schema(const Json& element, int length) {
  return {{"type", "array"}, {"items", element}, {"minItems", length}, {"maxItems", length}};
}

Form<glm::dvec3> vec3() {
  return {array_schema(number().schema, 3), [](const JsonCursor& at, glm::dvec3& value) { value = at.vec3(); }};
}

Form<glm::vec3> color() {
  return {array_schema(limits("number", 0, kMostColor), 3),
          [](const JsonCursor& at, glm::vec3& value) { value = at.color(); }, vector<glm::vec3>().write};
}

Form<glm::vec4> rgba() {
  Json schema = array_schema(limits("number", 0, kMostColor), 4);
  schema.erase("items");
  schema["prefixItems"] = Json::array();
  for (int i = 0; i < 4; ++i) schema["prefixItems"].push_back(limits("number", 0, i < 3 ? kMostColor : 1.0f));
  return {schema, [](const JsonCursor& at, glm::vec4& value) { value = at.rgba(); }, vector<glm::vec4>().write};
}

Form<glm::dmat4> matrix() {
  return {array_schema(number().schema, 16), [](const JsonCursor& at, glm::dmat4& value) { value = at.matrix(); }};
}

Form<std::uint64_t> count(std::uint64_t least) {
  return {{{"type", "integer"}, {"minimum", least}}, {}, write_value<std::uint64_t>};
}

Form<double> amount() { return {{{"type", "number"}, {"minimum", 0}}, {}, write_value<double>}; }

Form<Json> as_it_is(const Json& schema) { return {schema, {}, write_value<Json>}; }

}  // namespace form
}  // namespace beampipe

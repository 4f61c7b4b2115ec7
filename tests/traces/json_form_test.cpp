#include "traces/files/json_form.h"

#include "tests/test.h"
#include "traces/files/trace_io.h"

namespace beampipe::json_form_test {

// What the reader says of a text, without the file's name; "" if it takes it.
template <class T>
std::string refusal(const Form<T>& form, const std::string& text) {
  const std::string file = "f.json";
  const Json json = parse_json_text(text, file);
  try {
    form(JsonCursor(json, file));
  } catch (const TraceError& error) {
    return std::string(error.what()).substr(file.size() + 2);
  }
  return "";
}

// Of each form: a value that it takes, one that it does not, what it says then, and how its schema says the same.
struct FormCase {
  const char *name, *good, *bad, *error, *schema;
  std::function<std::string(const std::string&)> refuse;
  Json described;
};

template <class T>
FormCase form_case(const char* name, const Form<T>& form, const char* good, const char* bad, const char* error,
                   const char* schema) {
  return {name, good, bad, error, schema, [form](const std::string& text) { return refusal(form, text); }, form.schema};
}

constexpr std::string_view kColors[] = {"red", "green"};

TEST(JsonForm, ReadersAndSchemasHaveTheSameLimits) {
  using namespace form;
  for (const FormCase& each : {
           form_case("boolean", boolean(), "true", "1", "expected true or false, found 1", R"({"type":"boolean"})"),
           form_case("text", text(), R"("")", "1", "expected a string, found 1", R"({"type":"string"})"),
           form_case("filled text", text("a source"), R"("a")", R"("")", "expected a source, found nothing",
                     R"({"type":"string","minLength":1})"),
           form_case("one of", one_of({"a", "b"}), R"("b")", R"("c")", R"(expected one of "a", "b", found "c")",
                     R"({"enum":["a","b"]})"),
           form_case("choice", choice<int>(kColors), R"("green")", "0", R"(expected one of "red", "green", found 0)",
                     R"({"enum":["red","green"]})"),
           form_case("number", number(), "-1e300", "null", "expected a number, found null", R"({"type":"number"})"),
           form_case("closed range", number(-1, 2), "2", "2.1", "expected a number from -1 to 2, found 2.1",
                     R"({"type":"number","minimum":-1,"maximum":2})"),
           form_case("open range", number_between(0, 180), "1e-9", "0",
                     "expected a number above 0 and below 180, found 0",
                     R"({"type":"number","exclusiveMinimum":0.0,"exclusiveMaximum":180.0})"),
           form_case("real", real(-1, 1), "-1", "-1.5", "expected a number from -1 to 1, found -1.5",
                     R"({"type":"number","minimum":-1,"maximum":1})"),
           form_case("fraction", fraction(), "1", "1.5", "expected a number 0..1, found 1.5",
                     R"({"type":"number","minimum":0,"maximum":1})"),
           form_case("integer", integer(3, 5), "5.0", "6", "expected an integer 3..5, found 6",
                     R"({"type":"integer","minimum":3,"maximum":5})"),
           form_case("power", power_of_two(8, 32), "16", "24", "expected a power of two from 8 to 32, found 24",
                     R"({"enum":[8,16,32]})"),
           form_case("version", version(2), "2", "1", "expected 2, found 1", R"({"const":2})"),
           form_case("list", list(integer(0, 1), "bit"), "[0, 1]", "[]", "expected at least one bit, found none",
                     R"({"type":"array","items":{"type":"integer","minimum":0,"maximum":1},"minItems":1})"),
       }) {
    EXPECT_EQ(each.refuse(each.good), "") << each.name;
    EXPECT_EQ(each.refuse(each.bad), std::string("/: ") + each.error) << each.name;
    EXPECT_EQ(each.described.dump(), each.schema) << each.name;
  }
}

struct Lamp {
  std::string name;
  double watts = 60;
  std::optional<bool> lit;
  std::map<std::string, double> sides;
  bool operator==(const Lamp&) const = default;
};

Form<Lamp> lamp() {
  return ObjectForm<Lamp>()
      .required("name", &Lamp::name, form::text(), "What it is called.")
      .optional("watts", &Lamp::watts, form::number(0, 100), "Its power.")
      .optional("lit", &Lamp::lit, form::boolean(), "Whether it is on.")
      .add({"sides", "Their lengths.", false, form::record({{"a", "One."}, {"b", "Two."}}, true, form::number()).schema,
            [](const JsonCursor& at, Lamp& lamp) {
              lamp.sides = form::record({{"a", "One."}, {"b", "Two."}}, true, form::number(), "a side")(at);
            }})
      .check([](const JsonCursor& at, const Lamp& lamp) {
        if (lamp.lit && lamp.watts == 0) at["lit"].fail("some power", "none");
      });
}

Lamp read(const std::string& text) {
  const std::string file = "f.json";
  const Json json = parse_json_text(text, file);
  return lamp()(JsonCursor(json, file));
}

TEST(JsonForm, ObjectsAreReadAndWritten) {
  const Lamp lit{"desk", 40, true, {}};
  EXPECT_EQ(lamp().write(lit).dump(), R"({"name":"desk","watts":40.0,"lit":true})");
  EXPECT_EQ(read(R"({"lit": true, "watts": 40, "name": "desk"})"), lit);
  const Lamp plain{"desk", 60, {}, {}};
  EXPECT_EQ(lamp().write(plain).dump(), R"({"name":"desk"})") << "what has its default value is left out";
  EXPECT_EQ(read(R"({"name": "desk"})"), plain);
  EXPECT_EQ(read(R"({"name": "x", "sides": {"b": 2, "a": 1}})").sides,
            (std::map<std::string, double>{{"a", 1}, {"b", 2}}));
}

TEST(JsonForm, ErrorsNameAllMissingKeys) {
  std::vector<form::Key> keys;
  for (char key = 'a'; key < 'm'; ++key) keys.push_back({std::string(1, key), "A number."});
  const auto numbers = form::record(keys, true, form::number());
  EXPECT_EQ(refusal(numbers, "{}"),
            R"(/: expected the keys "a", "b", "c", "d", "e", "f", "g", "h", "i", "j" and 2 more, found none of them)");
  EXPECT_EQ(refusal(numbers, R"({"a": 1, "b": 1, "d": 1, "e": 1, "f": 1, "g": 1, "h": 1, "i": 1, "k": 1, "l": 1})"),
            R"(/: expected the keys "c", "j", found none of them)");
  EXPECT_EQ(refusal(numbers, R"({"a": "one"})").find("/a: expected a number"), 0u) << "in the order of the keys";
}

TEST(JsonForm, ErrorsNamePlaceExpectationAndWhatWasFound) {
  const auto refused = [](const char* text) { return refusal(lamp(), text); };
  EXPECT_EQ(refused("[]"), "/: expected an object, found an array of 0");
  EXPECT_EQ(refused("{}"), R"(/: expected the key "name", found none)");
  EXPECT_EQ(refused(R"({"name": "x", "watt": 1})"),
            R"(/watt: expected one of the keys "name", "watts", "lit", "sides", found "watt" (did you mean 'watts'?))");
  EXPECT_EQ(refused(R"({"name": "x", "sides": {"a": 1}})"), R"(/sides: expected the key "b", found none)");
  EXPECT_EQ(refused(R"({"name": "x", "sides": {"a": 1, "c": 2}})"), R"(/sides/c: expected a side, found "c")");
  EXPECT_EQ(refused(R"({"name": "x", "watts": 0, "lit": true})"), "/lit: expected some power, found none");
}

TEST(JsonForm, SchemasDescribeEveryKey) {
  EXPECT_EQ(schema_file(lamp().schema, "lamp").dump(),
            R"({"$schema":"https://json-schema.org/draft/2020-12/schema","title":"lamp","type":"object",)"
            R"("required":["name"],"additionalProperties":false,"properties":{)"
            R"("name":{"description":"What it is called.","type":"string"},)"
            R"("watts":{"description":"Its power.","type":"number","minimum":0,"maximum":100,"default":60.0},)"
            R"("lit":{"description":"Whether it is on.","type":"boolean"},)"
            R"("sides":{"description":"Their lengths.","type":"object","required":["a","b"],)"
            R"("additionalProperties":false,"properties":{"a":{"description":"One.","type":"number"},)"
            R"("b":{"description":"Two.","type":"number"}}}}})");
}

TEST(JsonForm, NamedValuesKeepTheirKeys) {
  struct Named {
    std::string name;
    bool on = false;
  };
  const Form<std::vector<Named>> form = form::named(
      Form<Named>(ObjectForm<Named>().required("on", &Named::on, form::boolean(), "On.")), &Named::name, "switch");
  EXPECT_EQ(refusal(form, "{}"), "/: expected at least one switch, found none");
  EXPECT_EQ(refusal(form, R"({"a": {"on": true}, "b": {}})"), R"(/b: expected the key "on", found none)");
  const std::string file = "f.json";
  const Json json = parse_json_text(R"({"z": {"on": true}, "a": {"on": false}})", file);
  const std::vector<Named> values = form(JsonCursor(json, file));
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[0].name + values[1].name, "za");
  EXPECT_TRUE(values[0].on);
}

}  // namespace beampipe::json_form_test

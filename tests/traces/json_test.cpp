// JSON values: kinds, members and text.
#include "traces/files/json.h"

#include "tests/message_of.h"
#include "tests/test.h"
#include "traces/files/trace_io.h"

namespace beampipe::json_test {

const auto error_of = [](const auto& read) { return message_of<JsonError>(read); };

TEST(Json, TextKeepsOrderAndKindsOfNumbers) {
  const Json json = {{"z", 1},    {"a", 1.0},     {"i", -3},
                     {"t", true}, {"n", nullptr}, {"list", Json::array({1, "two", Json::object()})}};
  const std::string text = R"({"z":1,"a":1.0,"i":-3,"t":true,"n":null,"list":[1,"two",{}]})";
  EXPECT_EQ(json.dump(), text);
  EXPECT_EQ(parse_json_text(text, "t.json").dump(), text);
  EXPECT_EQ(parse_json_text(text, "t.json"), json);
  EXPECT_EQ(Json({{"a", Json::array({1, 2})}}).dump(2), "{\n  \"a\": [\n    1,\n    2\n  ]\n}");
}

TEST(Json, NumbersKeepEveryBit) {
  for (const double value : {0.1, 1e-300, 1.7976931348623157e308, 4.9e-324, -0.0}) {
    const double read = parse_json_text(Json(value).dump(), "t.json").get<double>();
    EXPECT_EQ(read, value);
    EXPECT_EQ(std::signbit(read), std::signbit(value));
  }
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(parse_json_text(Json(most).dump(), "t.json").get<std::uint64_t>(), most);
  const std::int64_t least = std::numeric_limits<std::int64_t>::min();
  EXPECT_EQ(parse_json_text(Json(least).dump(), "t.json").get<std::int64_t>(), least);
  EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).dump(), "null");
}

TEST(Json, EqualityComparesValues) {
  EXPECT_EQ(Json(1), Json(1.0));
  EXPECT_NE(Json(std::uint64_t{1} << 53), Json((std::uint64_t{1} << 53) + 1)) << "as doubles they are equal";
  EXPECT_NE(Json(0), Json());
  EXPECT_NE(Json(1), Json(true));
  EXPECT_NE(Json({{"a", 1}, {"b", 2}}), Json({{"b", 2}, {"a", 1}})) << "the order of keys matters";
  EXPECT_EQ(Json(std::vector<double>{1, 2}), Json::array({1, 2}));
}

TEST(Json, CopiesAreIndependent) {
  Json first = {{"list", Json::array({1})}};
  Json second = first;
  second["list"].push_back(2);
  second["new"] = "text";
  EXPECT_EQ(first.dump(), R"({"list":[1]})");
  EXPECT_EQ(second.dump(), R"({"list":[1,2],"new":"text"})");
  second.erase("list");
  EXPECT_EQ(second.dump(), R"({"new":"text"})");
  first = first.at("list");
  EXPECT_EQ(first.dump(), "[1]") << "assigned from a part of itself";
}

TEST(Json, NullBecomesWhatIsPutIntoIt) {
  Json object, array;
  object["a"]["b"] = 1;
  array.push_back(1);
  EXPECT_EQ(object.dump(), R"({"a":{"b":1}})");
  EXPECT_EQ(array.dump(), "[1]");
}

TEST(Json, AValueThatWasMovedFromIsNull) {
  for (Json json : {Json("text"), Json::array({1}), Json({{"a", 1}}), Json(7)}) {
    const Json taken = std::move(json);
    EXPECT_TRUE(json.is_null()) << taken.dump();
    EXPECT_EQ(json.size(), 0u);
    EXPECT_EQ(Json(json), Json());
  }
}

TEST(Json, ValueHasADefault) {
  const Json json = {{"a", 2}};
  EXPECT_EQ(json.value("a", 1), 2);
  EXPECT_EQ(json.value("b", 1), 1);
  EXPECT_EQ(json.value("b", Json::array()).size(), 0u);
}

TEST(Json, ErrorsSayWhatIsExpectedAndFound) {
  const Json json = {{"a", "text"}, {"list", Json::array({1})}};
  EXPECT_EQ(error_of([&] { json.at("b"); }), "expected the key \"b\", found none");
  EXPECT_EQ(error_of([&] { json.at("a").get<double>(); }), "expected a number, found a string");
  EXPECT_EQ(error_of([&] { json.at("a").get<bool>(); }), "expected true or false, found a string");
  EXPECT_EQ(error_of([&] { json.at("list").get<std::string>(); }), "expected a string, found an array");
  EXPECT_EQ(error_of([&] { json.at("list").at(1); }), "expected an array with an element 1, found one of 1");
  EXPECT_EQ(error_of([&] { json.at("a").at("b"); }), "expected an object, found a string");
  EXPECT_EQ(error_of([&] { json.elements(); }), "expected an array, found an object");
  EXPECT_EQ(error_of([&] { Json(7).push_back(1); }), "expected an array, found a number");
}

// Casting them would have no defined result.
TEST(Json, IntegersThatDoNotFitAreRefused) {
  EXPECT_EQ(Json(2.75).get<int>(), 2) << "a fraction is cut off";
  EXPECT_EQ(Json(-2147483648.0).get<int>(), std::numeric_limits<int>::min());
  EXPECT_EQ(error_of([] { Json(2147483648.0).get<int>(); }), "expected a smaller number, found 2147483648.0");
  EXPECT_EQ(error_of([] { Json(1e300).get<std::uint64_t>(); }), "expected a smaller number, found 1e+300");
  EXPECT_EQ(error_of([] { Json(18446744073709551616.0).get<std::uint64_t>(); }),
            "expected a smaller number, found 1.8446744073709552e+19");
  EXPECT_EQ(error_of([] { Json(-1.0).get<std::uint32_t>(); }), "expected a larger number, found -1.0");
  EXPECT_EQ(error_of([] { Json(-1).get<std::uint64_t>(); }), "expected a larger number, found -1");
  EXPECT_EQ(error_of([] { Json(std::uint64_t{1} << 32).get<std::uint32_t>(); }),
            "expected a smaller number, found 4294967296");
  EXPECT_EQ(error_of([] { Json(std::nan("")).get<int>(); }), "expected a larger number, found null");
}

TEST(Json, BytesThatAreNotUtf8AreReplacedOrRefused) {
  EXPECT_EQ(Json("caf\xE9").dump(), "\"caf\xEF\xBF\xBD\"");
  EXPECT_EQ(json_string("\"\n\xC3\xA9"), "\"\\\"\\n\xC3\xA9\"");
  EXPECT_THROW(json_string("caf\xE9"), JsonError);
}

TEST(Json, BrokenTextNamesTheFile) {
  EXPECT_THROW(parse_json_text("{", "t.json"), TraceError);
  EXPECT_EQ(message_of<TraceError>([] { parse_json_text("{\"a\": 1, \"a\": 2}", "t.json"); }),
            "t.json: /a: expected each key once, found \"a\" again");
}

}  // namespace beampipe::json_test

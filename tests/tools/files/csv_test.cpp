#include "tools/files/csv.h"

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"
#include "traces/files/trace_io.h"

namespace beampipe::csv_test {

using Fields = std::vector<std::string>;

class Csv : public InFolder {
 protected:
  std::vector<CsvRow> read(const std::string& text) {
    write_text(folder_ / "a.csv", text);
    return read_csv(folder_ / "a.csv", {"a", "b"});
  }
  void expect_error(const std::string& text, const std::string& part) {
    const std::string message = message_of<TraceError>([&] { read(text); });
    expect_parts(message, {part, "a.csv"});
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
};

TEST_F(Csv, QuotesHoldCommasLinesAndQuotes) {
  const auto rows = read("a,b\r\n1,\"x, \"\"y\"\"\nz\"\n\n,q\"r");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].line, 2u);
  EXPECT_EQ(rows[0].fields, (Fields{"1", "x, \"y\"\nz"}));
  EXPECT_EQ(rows[1].line, 5u);
  EXPECT_EQ(rows[1].fields, (Fields{"", "q\"r"}));
  EXPECT_TRUE(read("a,b").empty());
}

TEST_F(Csv, FieldsAreReadAsTheyWereWritten) {
  for (const std::string text : {"plain", "a,b", "\"quoted\"", "two\nlines", ""}) {
    const auto rows = read(csv_text({"a", "b"}, {{"x", text}, {1.5, nullptr}}));
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].fields, (Fields{"x", text}));
    EXPECT_EQ(rows[1].fields, (Fields{"1.5", ""}));
  }
}

TEST_F(Csv, MistakesNameTheirLine) {
  expect_error("", "line 1: expected the header a,b, found an empty file");
  expect_error("a;b\n", "line 1: expected the header a,b, found \"a;b\"");
  expect_error("a,b\n1,2\n1,2,3\n", "line 3: expected 2 fields, found 3");
  expect_error("a,b\n\n\"1,2\n", "line 3: expected a quote that ends the field, found the end of the file");
  expect_error(std::string("a,b\n\0", 5), "line 2: expected 2 fields, found 1");
  expect_parts(message_of<TraceError>([&] { read_csv(folder_ / "none.csv", {"a"}); }), {"none.csv"});
}

}  // namespace beampipe::csv_test

#include "tools/files/csv.h"

#include "traces/files/input_file.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;

std::string place(const std::filesystem::path& file, std::size_t line) {
  return file.string() + ", line " + std::to_string(line);
}

std::string joined(const std::vector<std::string>& fields) {
  std::string text;
  for (const std::string& field : fields) text += (&field == &fields.front() ? "" : ",") + field;
  return text;
}

// Rows of any length. A quote inside a field without quotes stands for itself.
std::vector<CsvRow> rows_of(const std::string& text, const std::filesystem::path& file) {
  std::vector<CsvRow> rows;
  std::size_t line = 1, at = 0;
  while (at < text.size()) {
    CsvRow row{line, {""}};
    bool quoted = false;
    for (; at < text.size() && (quoted || text[at] != '\n'); ++at) {
      const char c = text[at];
      std::string& field = row.fields.back();
      if (c == '\n') ++line;
      if (quoted && c == '"') {
        if (at + 1 < text.size() && text[at + 1] == '"')
          field += text[++at];
        else
          quoted = false;
      } else if (!quoted && c == '"' && field.empty()) {
        quoted = true;
      } else if (!quoted && c == ',') {
        row.fields.emplace_back();
      } else if (quoted || c != '\r') {
        field += c;
      }
    }
    if (quoted) fail_trace(place(file, row.line), "a quote that ends the field", "the end of the file");
    ++at, ++line;
    if (row.fields != std::vector<std::string>{""}) rows.push_back(std::move(row));
  }
  return rows;
}

// In quotes where it has to be.
std::string csv_field(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const std::string text = value.get<std::string>();
  if (text.find_first_of("\",\r\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted.append("\"");
}

}  // namespace

std::string csv_text(const std::vector<std::string>& names, const std::vector<std::vector<Json>>& rows) {
  std::string text;
  const auto add_line = [&](const auto& values) {
    for (std::size_t i = 0; i < values.size(); ++i) text += (i > 0 ? "," : "") + csv_field(values[i]);
    text += "\r\n";
  };
  add_line(names);
  for (const std::vector<Json>& row : rows) add_line(row);
  return text;
}

std::vector<CsvRow> read_csv(const std::filesystem::path& file, const std::vector<std::string>& header) {
  std::vector<CsvRow> rows = rows_of(read_input_file(file, file.string(), kMostBytes), file);
  const std::string expected = "the header " + joined(header);
  if (rows.empty()) fail_trace(place(file, 1), expected, "an empty file");
  if (rows.front().fields != header)
    fail_trace(place(file, rows.front().line), expected, in_quotes(joined(rows.front().fields)));
  rows.erase(rows.begin());
  for (const CsvRow& row : rows)
    if (row.fields.size() != header.size())
      fail_trace(place(file, row.line), std::to_string(header.size()) + " fields", std::to_string(row.fields.size()));
  return rows;
}

}  // namespace beampipe

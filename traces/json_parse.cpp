// Parsing with what the JSON library lets pass or says badly: duplicate keys, numbers out of range, folders.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include "traces/json_cursor.h"

namespace beampipe {
namespace {

// The library's message without its prefixes: "line 3, column 7: syntax error ...".
std::string reason_of(const std::exception& error) {
  std::string message = error.what();
  for (const std::string_view end_of_prefix : {"] ", "parse error at "}) {
    const std::size_t found = message.find(end_of_prefix);
    if (found != std::string::npos) message.erase(0, found + end_of_prefix.size());
  }
  return message;
}

// Follows the parser to know where it stands. As a handler of its own: given a callback, the library looks through an
// array again for each object in it.
class PlaceTracker : public nlohmann::json_sax<Json> {
 public:
  explicit PlaceTracker(const std::string& file) : file_(file) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool string(string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool start_object(std::size_t) override { return enter(false); }
  bool start_array(std::size_t) override { return enter(true); }
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
  std::string where() const {
    std::string pointer;
    for (const Level& level : levels_) {
      pointer += '/' + (level.is_array ? std::to_string(level.index) : pointer_step(level.key));
    }
    return file_ + ": " + (pointer.empty() ? "/" : pointer);
  }

  bool value() {
    if (!levels_.empty()) ++levels_.back().index;
    return true;
  }
  bool enter(bool is_array) {
    levels_.push_back({is_array, 0, "", {}});
    return true;
  }
  bool leave() {
    levels_.pop_back();
    return value();
  }

  struct Level {
    bool is_array;
    std::size_t index;
    std::string key;
    std::set<std::string> keys;
  };

  const std::string& file_;
  std::vector<Level> levels_;
};

}  // namespace

void require_input_file(const std::filesystem::path& file, const std::string& where) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{16} << 30;
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) fail_trace(where, "a readable file", "none");
  if (std::filesystem::is_directory(status)) fail_trace(where, "a readable file", "a folder");
  if (!std::filesystem::is_regular_file(status)) fail_trace(where, "a regular file", "a pipe or a device");
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (!error && size > kMostBytes) fail_trace(where, "at most 16 GiB", std::to_string(size >> 30) + " GiB");
}

Json parse_json(const std::string& file) {
  require_input_file(file, file);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail_trace(file, "a readable file", "none");
  PlaceTracker place(file);
  Json::sax_parse(stream, &place);
  stream.clear();
  stream.seekg(0);
  return Json::parse(stream);
}

}  // namespace beampipe

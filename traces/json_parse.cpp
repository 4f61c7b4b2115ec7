// Parsing with what the JSON library lets pass or says badly: duplicate keys, numbers out of range, folders.
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include "traces/json_cursor.h"

namespace beampipe {
namespace {

// Follows the parser to know where it stands.
class PlaceTracker {
 public:
  explicit PlaceTracker(const std::string& file) : file_(file) {}

  bool operator()(Json::parse_event_t event, const Json& parsed) {
    switch (event) {
      case Json::parse_event_t::key:
        enter_key(parsed.get_ref<const std::string&>());
        break;
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        levels_.push_back({event == Json::parse_event_t::array_start, 0, "", {}});
        break;
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end:
        levels_.pop_back();
        [[fallthrough]];
      case Json::parse_event_t::value:
        if (!levels_.empty()) ++levels_.back().index;
        break;
    }
    return true;
  }

  std::string where() const {
    std::string pointer;
    for (const Level& level : levels_) {
      pointer += '/' + (level.is_array ? std::to_string(level.index) : pointer_step(level.key));
    }
    return file_ + ": " + (pointer.empty() ? "/" : pointer);
  }

 private:
  struct Level {
    bool is_array;
    std::size_t index;
    std::string key;
    std::set<std::string> keys;
  };

  void enter_key(const std::string& key) {
    levels_.back().key = key;
    if (!levels_.back().keys.insert(key).second) fail_trace(where(), "each key once", in_quotes(key) + " again");
  }

  const std::string& file_;
  std::vector<Level> levels_;
};

// The library's message without its prefixes: "line 3, column 7: syntax error ...".
std::string reason_of(const std::exception& error) {
  std::string message = error.what();
  for (const std::string_view end_of_prefix : {"] ", "parse error at "}) {
    const std::size_t found = message.find(end_of_prefix);
    if (found != std::string::npos) message.erase(0, found + end_of_prefix.size());
  }
  return message;
}

}  // namespace

Json parse_json(const std::string& file) {
  std::error_code no_matter;  // what cannot be asked cannot be opened either
  if (std::filesystem::is_directory(file, no_matter)) fail_trace(file, "a readable file", "a folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail_trace(file, "a readable file", "none");
  PlaceTracker place(file);
  try {
    return Json::parse(stream, [&](int, Json::parse_event_t event, Json& parsed) { return place(event, parsed); });
  } catch (const Json::parse_error& error) {
    fail_trace(file + ": byte " + std::to_string(error.byte), "valid JSON", reason_of(error));
  } catch (const Json::out_of_range& error) {
    fail_trace(place.where(), "a finite number", reason_of(error));
  }
}

}  // namespace beampipe

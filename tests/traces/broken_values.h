// Sound JSON files in which one value is replaced, and what their readers say then.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/test.h"

namespace beampipe {

struct BrokenValue {
  const char *place, *value;  // a JSON pointer, and a JSON text
  std::string error;          // what is said of the place, or of another that stands before it; or "no error"
};

// `error_in` gives the error for a JSON value that it reads; errors begin with `start`.
template <class Json, class ErrorIn>
void expect_errors(const Json& sound, ErrorIn error_in, const std::vector<BrokenValue>& values,
                   const std::string& start = "scene.json: ") {
  for (const auto& [place, value, error] : values) {
    Json json = sound;
    json[typename Json::json_pointer(place)] = Json::parse(value);
    const std::string at = error[0] == '/' ? "" : place + std::string(": ");
    EXPECT_EQ(error_in(json), error == "no error" ? error : start + at + error) << place << " = " << value;
  }
}

}  // namespace beampipe

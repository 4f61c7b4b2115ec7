#include "tools/files/format.h"

#include <cstdarg>
#include <cstdio>

namespace beampipe {

std::string format(const char* pattern, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string with_noun(std::uint64_t number, const std::string& noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : noun.ends_with("sh") ? "es" : "s");
}

}  // namespace beampipe

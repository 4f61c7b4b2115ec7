#include "tools/files/shell_word.h"

namespace beampipe {

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string short_shell_word(const std::string& text) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,@%+";
  return !text.empty() && text.find_first_not_of(kPlain) == text.npos ? text : shell_word(text);
}

}  // namespace beampipe

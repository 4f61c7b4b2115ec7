// Texts as words of a shell command.
#pragma once

#include <string>

namespace beampipe {

// A word in quotes that stands for this text.
std::string shell_word(const std::string& text);

// The same for people to read: without quotes if it needs none.
std::string short_shell_word(const std::string& text);

}  // namespace beampipe

// Text in lines of limited width, for --help and other output on terminals.
#pragma once

#include <cstddef>
#include <string>

namespace beampipe {

// Breaks a line at blanks, so that none has more than `width` characters; where there is no blank, within a word. Lines
// after the first are indented.
std::string wrapped(const std::string& line, std::size_t width, std::size_t indent = 0);

}  // namespace beampipe

#include "pipeline/wrapped_text.h"

namespace beampipe {

std::string wrapped(const std::string& line, std::size_t width, std::size_t indent) {
  std::string lines;
  std::size_t start = 0, room = width;
  while (line.size() - start > room) {
    std::size_t end = line.rfind(' ', start + room);
    if (end == line.npos || end <= start) end = start + room;
    lines += line.substr(start, end - start) + "\n" + std::string(indent, ' ');
    start = end + (line[end] == ' ');
    room = width - indent;
  }
  return lines + line.substr(start);
}

}  // namespace beampipe

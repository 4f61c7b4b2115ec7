#include "traces/closest_name.h"

#include <algorithm>
#include <cstddef>

namespace beampipe {
namespace {

// Longer words are not compared: nobody mistypes a name that much, and the time is the product of both lengths.
constexpr std::size_t kLongest = 64;

// Optimal string alignment (Damerau 1964).
std::size_t changes(std::string_view from, std::string_view to) {
  std::vector<std::vector<std::size_t>> least(from.size() + 1, std::vector<std::size_t>(to.size() + 1));
  for (std::size_t i = 0; i <= from.size(); ++i) {
    for (std::size_t j = 0; j <= to.size(); ++j) {
      if (i == 0 || j == 0) {
        least[i][j] = i + j;
        continue;
      }
      const bool same = from[i - 1] == to[j - 1];
      least[i][j] = std::min({least[i - 1][j] + 1, least[i][j - 1] + 1, least[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1])
        least[i][j] = std::min(least[i][j], least[i - 2][j - 2] + 1);
    }
  }
  return least[from.size()][to.size()];
}

}  // namespace

std::string closest_name(std::string_view word, const std::vector<std::string>& names) {
  std::string closest;
  std::size_t fewest = kLongest;
  for (const std::string& name : names) {
    if (word.size() > kLongest || name.size() > kLongest) continue;
    const std::size_t count = changes(word, name);
    if (count >= fewest || 3 * count > name.size()) continue;
    fewest = count;
    closest = name;
  }
  return closest;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  const std::string name = closest_name(word, names);
  return name.empty() ? "" : " (did you mean '" + name + "'?)";
}

}  // namespace beampipe

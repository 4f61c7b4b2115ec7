// Which name a user may have meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace beampipe {

// Returns the name that becomes `word` with the fewest changes: letters added, dropped or replaced, and neighbours that
// change places. Empty if that takes more than one change for every three letters of the name. The first of several.
std::string closest_name(std::string_view word, const std::vector<std::string>& names);

// " (did you mean 'NAME'?)", or nothing if no name is close.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

}  // namespace beampipe

// One colour for each technique, stage and cause, the same in all plots, cards and files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace beampipe {

// The colour of a spec in a report with these techniques, in their order. All of msaa share one colour.
std::string technique_color(const std::vector<std::string>& specs, std::string_view spec);

// For series that are none of these: 20 colours in turn.
std::string color_at(std::size_t index);

// A stage's colour, and lighter that of the same stage in a pre-pass.
std::string stage_color(std::string_view stage);

// Of error_causes().
std::string cause_color(std::string_view cause);

}  // namespace beampipe

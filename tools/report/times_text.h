// Modelled times of finished runs as tables for the terminal and as JSON.
#pragma once

#include <string>

#include "tools/evaluate/results.h"

namespace beampipe {

// What the tables have beside the times.
struct TimesOptions {
  std::string over;          // a technique by which the times of the others are divided; empty: none
  bool sensitivity = false;  // what each rate at the ends of its range makes of these quotients
  bool stages = false;       // in the text: the stages that take at least one per cent of the time
};

// A row per technique and implementation, or one for those that agree: milliseconds one stage after the other, with the
// interval that the rates' ranges leave, with bins one by one on cores, and all at once; the busiest unit and the rate
// that limits it; how unevenly bins fill the cores; and the room of a bin. Means over the frames; units and rooms are
// those of the first. The reference has no row. Throws std::runtime_error, one line, if the report has no technique
// `over`.
std::string times_text(const Report& report, const TimesOptions& options = {});

// An array of objects with the same, and the time and busiest unit of each stage.
Json times_json(const Report& report, const TimesOptions& options = {});

}  // namespace beampipe

// A timeline as a file for ui.perfetto.dev or chrome://tracing (the Trace Event Format, JSON).
#pragma once

#include <string>

#include "pipeline/timeline.h"

namespace beampipe {

// Each event is a slice on its thread, named after the stage and told its tile; times are microseconds since the first.
std::string trace_events_json(const Timeline& timeline);

}  // namespace beampipe

// The options that show a trace in another size or from another place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/cli/command_line.h"
#include "traces/trace.h"

namespace beampipe {

struct TraceView {
  std::string camera = {};              // file; empty: the trace's own
  std::uint32_t width = 0, height = 0;  // 0: as the trace says, or in proportion to the other one
};

// `view` must live until the command line is parsed.
void add_trace_view_options(Command& command, TraceView& view);

// Changes these frames. `name`: the trace's, for messages. Throws std::runtime_error, one line, if the view of a frame
// cannot be changed, because it has matrices in place of a camera or was captured, or if the camera's file is wrong.
void apply(const TraceView& view, const std::vector<std::size_t>& frames, const std::string& name, Trace& trace);

}  // namespace beampipe

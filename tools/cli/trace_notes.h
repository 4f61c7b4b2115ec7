// What a user should know about a trace before looking at its pictures.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// One line about the frames that draw surfaces which only light could show, and have neither lights nor ambient light:
// such surfaces are black. Empty if no frame does. `file`: the trace's name for the line.
std::string note_on_darkness(const Trace& trace, const std::vector<std::size_t>& frames, const std::string& file);

// One line about the draws that show a mesh with other triangles than in the frame before: techniques with a history
// (`specs`) know no motion of these. Frames with another number of draws do not count: what they show is new. Empty if
// there are no such draws or techniques. `frames`: rising.
std::string note_on_motion(const Trace& trace, const std::vector<std::size_t>& frames,
                           const std::vector<std::string>& specs, const std::string& file);

}  // namespace beampipe

// What frames ask for and no technique does: stages/geometry/draw_plan.h, for several frames together.
#pragma once

#include <string>
#include <vector>

#include "pipeline/technique.h"
#include "stages/geometry/draw_notes.h"
#include "stages/surface/program_set.h"
#include "traces/files/json_form.h"
#include "traces/trace.h"

namespace beampipe {

// One note for each reason. A draw counts in each frame that has it. `frames`: indices into the trace. `programs`: of
// the trace. `by_depth`: who does not keep the API's order, by names; empty: everybody does.
std::vector<DrawNote> notes_of(const Trace& trace, const std::vector<std::size_t>& frames, const ProgramSet& programs,
                               const std::string& by_depth);

// The specs of those techniques that do not, as words.
std::string drawing_by_depth(const std::vector<Technique>& techniques);

// Adds what rendering a frame has shown: the programs that were stopped. `spec`: of who rendered it.
void add_stopped(const Trace& trace, std::size_t frame, const std::string& spec,
                 const std::vector<StoppedDraw>& stopped, std::vector<DrawNote>& notes);

// "12 draws (340 triangles) are left out: stencil test"
std::string text_of(const DrawNote& note);

// As in report.json.
Form<std::vector<DrawNote>> notes_form();

// Prints a line on stderr for each note.
void tell_notes(const std::vector<DrawNote>& notes);

}  // namespace beampipe

// The parts of a trace that programs brought: their fragment shaders, images and samplers, and what draws bind.
#pragma once

#include <vector>

#include "traces/files/array_reader.h"
#include "traces/files/json_form.h"
#include "traces/trace.h"

namespace beampipe {

// What the forms refer to must outlive them.
Form<std::vector<ShaderProgram>> programs_form(const ArrayReader& arrays);
Form<std::vector<ProgramImage>> program_images_form(const ArrayReader& arrays);
Form<std::vector<ProgramSampler>> program_samplers_form();

// Of a draw. The trace has its programs, images and samplers already.
Form<ProgramUse> program_use_form(const ArrayReader& arrays, const Trace& trace);

// Throws TraceError if the draw's mesh has not the varyings that its program, which `at` names, reads.
void expect_varyings(const JsonCursor& at, const Trace& trace, const Draw& draw);

Form<ColorTarget> color_target_form();

}  // namespace beampipe

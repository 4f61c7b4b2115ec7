#include "tools/evaluate/draw_notes.h"

#include <algorithm>
#include <iostream>
#include <optional>

#include "stages/geometry/draw_plan.h"
#include "tools/files/format.h"

namespace beampipe {

std::string drawing_by_depth(const std::vector<Technique>& techniques) {
  std::string names;
  for (const Technique& technique : techniques)
    if (!technique.keeps_api_order) names += (names.empty() ? "" : ", ") + technique.spec;
  return names;
}

std::vector<DrawNote> notes_of(const Trace& trace, const std::vector<std::size_t>& frames, const ProgramSet& programs,
                               const std::string& by_depth) {
  std::vector<DrawNote> notes;
  for (const std::size_t frame : frames) {
    if (!by_depth.empty())
      for (const DrawNote& note : plan_draws(trace, trace.frames[frame]).notes)
        add_note(notes, note.reason + " (" + by_depth + ")", note.left_out, note.draws, note.triangles);
    for (const Draw& draw : trace.frames[frame].draws) {
      if (!draw.program) continue;
      const auto note = [&](const std::string& reason) {
        add_note(notes, reason, false, 1, trace.meshes[draw.mesh].triangles.size());
      };
      const std::uint32_t number = draw.program->program;
      const LaneProgram* const program = programs.find(number);
      if (!program)
        note("in one grey, as shader " + in_quotes(trace.programs[number].name) +
             " cannot run: " + programs.error(number));
      else if (std::ranges::any_of(program->outputs, [](const InterfaceRow& row) {
                 return row.built_in == spv::BuiltInFragStencilRefEXT;
               }))
        note("shaders set the stencil test's reference, which stays that of the draw");
    }
  }
  return notes;
}

void add_stopped(const Trace& trace, std::size_t frame, const std::string& spec,
                 const std::vector<StoppedDraw>& stopped, std::vector<DrawNote>& notes) {
  for (const auto& [number, invocations] : stopped) {
    const Draw& draw = trace.frames[frame].draws[number];
    add_note(notes,
             "shader " + in_quotes(trace.programs[draw.program->program].name) +
                 " is stopped where it takes too many steps (" + spec + ")",
             false, 1, trace.meshes[draw.mesh].triangles.size(), invocations);
  }
}

std::string text_of(const DrawNote& note) {
  const char* const verb =
      note.left_out ? (note.draws == 1 ? " is left out: " : " are left out: ")
                    : (note.draws == 1 ? " is drawn in the nearest way: " : " are drawn in the nearest way: ");
  return with_noun(note.draws, "draw") + " (" + with_noun(note.triangles, "triangle") + ')' + verb + note.reason +
         (note.invocations > 0 ? ": " + with_noun(note.invocations, "invocation") : "");
}

Form<std::vector<DrawNote>> notes_form() {
  return form::list(Form<DrawNote>(
      ObjectForm<DrawNote>()
          .written("reason", &DrawNote::reason, form::text(), "What it is.")
          .written("left_out", &DrawNote::left_out, form::boolean(), "Left out; otherwise drawn in the nearest way.")
          .written("draws", &DrawNote::draws, form::count(), "So many.")
          .written("triangles", &DrawNote::triangles, form::count(), "So many.")
          .written(
              "invocations",
              [](const DrawNote& note) {
                return note.invocations > 0 ? std::optional(note.invocations) : std::nullopt;
              },
              form::count(1), "So many of fragment shaders, if it is not about all of the draws.")));
}

void tell_notes(const std::vector<DrawNote>& notes) {
  for (const DrawNote& note : notes) std::cerr << "beampipe: note: " << text_of(note) << "\n";
}

}  // namespace beampipe

#include "tools/evaluate/draw_notes.h"

#include <iostream>

#include "stages/geometry/draw_plan.h"

namespace beampipe {

std::vector<DrawNote> notes_of(const Trace& trace, const std::vector<std::size_t>& frames) {
  std::vector<DrawNote> notes;
  for (const std::size_t frame : frames)
    for (const DrawNote& note : plan_draws(trace, trace.frames[frame]).notes)
      add_note(notes, note.reason, note.left_out, note.draws, note.triangles);
  return notes;
}

std::string text_of(const DrawNote& note) {
  const auto counted = [](std::uint64_t count, const char* name) {
    return std::to_string(count) + ' ' + name + (count == 1 ? "" : "s");
  };
  const char* const verb =
      note.left_out ? (note.draws == 1 ? " is left out: " : " are left out: ")
                    : (note.draws == 1 ? " is drawn in the nearest way: " : " are drawn in the nearest way: ");
  return counted(note.draws, "draw") + " (" + counted(note.triangles, "triangle") + ')' + verb + note.reason;
}

Json to_json(const std::vector<DrawNote>& notes) {
  Json json = Json::array();
  for (const DrawNote& note : notes)
    json.push_back(
        {{"reason", note.reason}, {"left_out", note.left_out}, {"draws", note.draws}, {"triangles", note.triangles}});
  return json;
}

void tell_notes(const std::vector<DrawNote>& notes) {
  for (const DrawNote& note : notes) std::cerr << "beampipe: note: " << text_of(note) << "\n";
}

}  // namespace beampipe

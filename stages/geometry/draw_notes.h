// What a frame's draws ask for and no technique does.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace beampipe {

struct DrawNote {
  std::string reason;
  bool left_out = false;  // the draws are left out; else they are drawn in the nearest way
  std::uint64_t draws = 0, triangles = 0;
  std::uint64_t invocations = 0;  // of fragment shaders, that it is about; 0: it is about all of the draws
  bool operator==(const DrawNote&) const = default;
};

// One note for each reason, in the order in which they first occur.
inline void add_note(std::vector<DrawNote>& notes, const std::string& reason, bool left_out, std::uint64_t draws,
                     std::uint64_t triangles, std::uint64_t invocations = 0) {
  auto note = std::find_if(notes.begin(), notes.end(),
                           [&](const DrawNote& other) { return other.reason == reason && other.left_out == left_out; });
  if (note == notes.end()) note = notes.insert(note, {reason, left_out});
  note->draws += draws, note->triangles += triangles, note->invocations += invocations;
}

}  // namespace beampipe

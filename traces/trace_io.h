// Reading and writing traces (format: traces/trace.schema.json).
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "traces/trace.h"

namespace beampipe {

// One line, "FILE: PLACE: expected WHAT, found WHAT". PLACE is a JSON pointer ("/" for the whole), or "byte N" where
// the JSON is broken. Errors in an OBJ follow the place in the trace that named it: "scene.json: /meshes/ship/obj:
// ship.obj: line 12: expected ...".
struct TraceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ReadOptions {
  bool allow_outside = false;  // let mesh paths leave the trace's folder; they must be regular files all the same
};

// Reads and validates a trace with all its meshes. Throws TraceError.
Trace read_trace(const std::filesystem::path& file, const ReadOptions& options = {});

// Reads one OBJ with its .mtl (Kd per face; faces without a material are 0.8 grey; polygons are triangulated).
// A missing .mtl counts as no material; one outside the OBJ's folder is an error. The mesh gets the file's name without
// ".obj". `named_by`, unless empty, prefixes errors with the place in the trace that named the file. Throws TraceError.
Mesh read_obj(const std::filesystem::path& file, const std::string& named_by);

// Writes a trace with its meshes inline, atomically (temporary name, then rename); read_trace gives back the same bits.
// A frame's camera, if there is one, stands for its view and projection. Throws std::runtime_error, one line, and then
// leaves what was there.
void write_trace(const Trace& trace, const std::filesystem::path& file);

}  // namespace beampipe

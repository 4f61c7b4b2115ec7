// Reading and writing traces (format: traces/trace.schema.json).
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "traces/trace.h"

namespace beampipe {

// One line, "FILE: PLACE: expected WHAT, found WHAT". PLACE is a JSON pointer ("/" for the whole file), or "byte N"
// where the JSON is broken. An error in an OBJ starts with the place in the trace that names the OBJ: "scene.json:
// /meshes/ship/obj: ship.obj: line 12: expected ...".
struct TraceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ReadOptions {
  bool allow_outside = false;  // paths may leave the trace's folder; what they name must still be regular files
};

// Reads and validates a trace of version 1 or 2, with all its meshes and images. Throws TraceError.
Trace read_trace(const std::filesystem::path& file, const ReadOptions& options = {});

// Writes a trace with its meshes and images inline; read_trace() gives back the same bits. The version is 1 if that can
// express the trace, else 2. A frame with a camera is written with it in place of its view and projection. The file
// appears under its name when it is complete. Throws std::runtime_error, with one line, and leaves the file that was
// there as it is.
void write_trace(const Trace& trace, const std::filesystem::path& file);

}  // namespace beampipe

// Reading and writing traces.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "traces/files/json.h"
#include "traces/trace.h"

namespace beampipe {

// One line, "FILE: PLACE: expected WHAT, found WHAT". PLACE is a JSON pointer ("/" for the whole file), or "byte N"
// where the JSON is broken. An error in an OBJ starts with the place in the trace that names the OBJ: "scene.json:
// /meshes/ship/obj: ship.obj: line 12: expected ...".
struct TraceError : std::runtime_error {
  // Control characters, which names in a file may hold, become question marks.
  explicit TraceError(std::string message);
};

struct ReadOptions {
  bool allow_outside = false;  // paths may leave the trace's folder; what they name must still be regular files
};

// Reads and validates a trace of version 1 or 2, with all its meshes and images. Throws TraceError.
Trace read_trace(const std::filesystem::path& file, const ReadOptions& options = {});

// The JSON Schema of traces, which describes every key.
Json trace_schema();

enum class ArrayStorage {
  text,    // in the trace's own file, which can be moved and edited
  binary,  // in a file beside it, whose name ends in .bin: a fifth of the size, and faster to read
};

// The binary file beside a trace.
std::filesystem::path arrays_file_of(const std::filesystem::path& trace);

// Writes a trace with its images inline; read_trace() gives back the same bits. The version is 1 if that can express
// the trace, else 2. A frame with a camera is written with it in place of its view and projection. The files appear
// under their names when they are complete, the trace last. Throws std::runtime_error, with one line, and leaves the
// trace that was there as it is.
void write_trace(const Trace& trace, const std::filesystem::path& file, ArrayStorage storage = ArrayStorage::text);

}  // namespace beampipe

// Reading and writing traces (format: traces/trace.schema.json).
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "traces/trace.h"

namespace beampipe {

// One line, "FILE: POINTER: expected WHAT, found WHAT"; POINTER is a JSON pointer, or a byte offset for broken JSON.
struct TraceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ReadOptions {
  bool allow_outside = false;  // let mesh paths leave the trace's folder
};

// Reads and validates a trace with all its meshes. Throws TraceError.
Trace read_trace(const std::filesystem::path& file, const ReadOptions& options = {});

// Reads one OBJ with its .mtl (Kd per face; faces without a material are 0.8 grey; polygons are triangulated).
// `named_by` prefixes errors with the place in the trace that named it. Throws TraceError.
Mesh read_obj(const std::filesystem::path& file, const std::string& named_by);

// Writes a trace with its meshes inline, atomically (temporary name, then rename). Throws std::runtime_error.
void write_trace(const Trace& trace, const std::filesystem::path& file);

}  // namespace beampipe

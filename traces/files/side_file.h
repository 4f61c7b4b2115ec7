// Files that a trace names: meshes and images.
#pragma once

#include <filesystem>

#include "traces/files/json_cursor.h"

namespace beampipe {

// The file that the string at `at` names, relative to the trace's folder. The path may not leave that folder, which is
// decided after following symbolic links, unless `allow_outside`. Throws TraceError if it does, and if there is no
// regular file.
std::filesystem::path side_file(const JsonCursor& at, const std::filesystem::path& trace_file, bool allow_outside);

}  // namespace beampipe

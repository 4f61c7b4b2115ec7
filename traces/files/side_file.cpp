#include "traces/files/side_file.h"

#include "traces/files/input_file.h"

namespace beampipe {

namespace fs = std::filesystem;

fs::path side_file(const JsonCursor& at, const fs::path& trace_file, bool allow_outside) {
  const fs::path named = at.string();
  if (named.native().find('\0') != std::string::npos) at.fail("a path without NUL characters");
  const fs::path folder = trace_file.has_parent_path() ? trace_file.parent_path() : ".";
  std::error_code error;
  const fs::path path = fs::weakly_canonical(folder / named, error);
  if (error) at.fail("a path that can be followed", in_quotes(named.string()) + ": " + error.message());
  if (!allow_outside && (named.is_absolute() || !is_inside(path, fs::canonical(folder)))) {
    at.fail("a path that stays in the trace's folder (--allow-outside allows others)");
  }
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) at.fail("an existing file");
  if (!fs::is_regular_file(status)) at.fail("a regular file");
  return folder / named;
}

}  // namespace beampipe

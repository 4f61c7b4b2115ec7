// The program `beampipe` as a function, for programs that have techniques of their own too (docs/manual.md).
#pragma once

namespace beampipe {

// Runs the command that the arguments name, those of main(), and returns the exit code: 0 success, 1 failure, 2 wrong
// usage. Errors are one line on stderr.
int run_program(int argc, char** argv);

}  // namespace beampipe

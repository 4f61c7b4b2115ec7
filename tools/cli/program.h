// The program `beampipe` as a function, for programs that have techniques of their own too (docs/manual.md).
#pragma once

#include <string>
#include <vector>

namespace beampipe {

// Runs the command that the arguments name, those of main(), and returns the exit code: 0 success, 1 failure, 2 wrong
// usage. Errors are one line on stderr. `start`: the words of a command line that start this program again, on another
// machine too; empty: its executable does.
int run_program(int argc, char** argv, const std::vector<std::string>& start = {});

}  // namespace beampipe

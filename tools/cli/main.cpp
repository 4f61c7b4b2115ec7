// The program `beampipe`.
#include "tools/cli/program.h"

int main(int argc, char** argv) { return beampipe::run_program(argc, argv); }

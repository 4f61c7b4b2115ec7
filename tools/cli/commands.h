// The subcommands of the program, one per file. Each adds itself, with its options and help, to the command line; the
// work is done while CLI11 parses, by the subcommand's callback. Callbacks print results on stdout and throw on errors.
#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "tools/files/interrupt.h"

namespace beampipe {

// What the user asked for makes no sense; one line. Ends the program with exit code 2, other errors with 1.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void add_run_command(CLI::App& app, InterruptGate& gate);
void add_compare_command(CLI::App& app, InterruptGate& gate);
void add_report_command(CLI::App& app, InterruptGate& gate);
void add_plot_command(CLI::App& app, InterruptGate& gate);
void add_claims_command(CLI::App& app);
void add_stress_command(CLI::App& app, InterruptGate& gate);
void add_diff_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_export_soup_command(CLI::App& app, InterruptGate& gate);
void add_make_command(CLI::App& app, InterruptGate& gate);

}  // namespace beampipe

// The subcommands of the program, one per file. Each function adds its command, with options and help, to the command
// line.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/command_line.h"
#include "tools/files/interrupt.h"

namespace beampipe {

// `command_line`: the words that the user gave, as one text.
void add_run_command(CommandLine& line, const std::string& command_line, InterruptGate& gate);
void add_compare_command(CommandLine& line, const std::string& command_line, InterruptGate& gate);
void add_report_command(CommandLine& line, InterruptGate& gate);
void add_plot_command(CommandLine& line, InterruptGate& gate);
void add_figure_command(CommandLine& line);
void add_claims_command(CommandLine& line);
void add_counters_command(CommandLine& line);
void add_model_command(CommandLine& line);
void add_correlate_command(CommandLine& line, InterruptGate& gate);
// `start`: the words that start the program on another machine; empty: its executable does.
void add_sweep_command(CommandLine& line, const std::vector<std::string>& start, InterruptGate& gate);
void add_stress_command(CommandLine& line, InterruptGate& gate);
void add_inspect_command(CommandLine& line, InterruptGate& gate);
void add_diff_command(CommandLine& line, InterruptGate& gate);
void add_info_command(CommandLine& line);
void add_check_capture_command(CommandLine& line, InterruptGate& gate);
void add_export_soup_command(CommandLine& line, InterruptGate& gate);
void add_make_command(CommandLine& line, InterruptGate& gate);
void add_preview_command(CommandLine& line, InterruptGate& gate);
void add_capture_command(CommandLine& line);
void add_schema_command(CommandLine& line);
void add_completion_command(CommandLine& line);  // after all others, which it completes
void add_man_command(CommandLine& line);

}  // namespace beampipe

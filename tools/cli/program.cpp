#include "tools/cli/program.h"

#include <malloc.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "pipeline/technique.h"
#include "tools/cli/commands.h"
#include "tools/evaluate/results.h"
#include "tools/files/shell_word.h"

namespace beampipe {
namespace {

constexpr int kRuntimeError = 1, kUsageError = 2;

constexpr const char* kDescription =
    "beampipe simulates the beam rasterization pipeline and other antialiasing techniques stage by stage. It renders\n"
    "their pictures, measures the errors, and counts what every stage costs.";

constexpr const char* kExamples = R"(Examples:
  beampipe make fence -o fence.json
  beampipe compare fence.json -t beam msaa:8 -o out
  beampipe preview model.obj                   (your own model, as the next command will show it)
  beampipe make model.obj -o model.json        (the camera is chosen to show all of it, or to stand in a room)
  beampipe run model.json -t beam -o out
  beampipe capture -o gears.json -- glxgears   (a frame of a program that runs)
  beampipe report out                          (makes out/report.html, to open in a browser)
  beampipe inspect model.json --worst 1 -t beam   (why is the worst pixel wrong?)
  beampipe plot out -o frontier.svg
  beampipe diff out/beam/frame_0000.exr out/reference/frame_0000.exr
`beampipe COMMAND --help` explains a command. Exit codes: 0 success, 1 failure, 2 wrong usage, 130 interrupted.)";

// Prints the message as one line, whatever characters file names and libraries have put into it.
int report_error(std::string message, int exit_code) {
  for (char& c : message) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  std::cerr << "beampipe: error: " << message.substr(0, message.find_last_not_of(' ') + 1) << std::endl;
  return exit_code;
}

// Each frame allocates and frees the same memory. By default glibc returns large blocks to the system at once, and the
// next frame gets every page of them anew. That took a third of the time of vertex_setup.
void keep_freed_memory() {
  constexpr int kLargest = 1 << 30;  // bytes
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, kLargest);
}

std::string command_text(int argc, char** argv, const std::vector<std::string>& start) {
  std::string text = start.empty() ? "beampipe" : "";
  for (const std::string& word : start) text += (text.empty() ? "" : " ") + short_shell_word(word);
  for (int i = 1; i < argc; ++i) text += " " + short_shell_word(argv[i]);
  return text;
}

int run(int argc, char** argv, const std::vector<std::string>& start, InterruptGate& gate) {
  keep_freed_memory();
  const std::string command_line = command_text(argc, argv, start);
  CommandLine line("beampipe", program_version(), kDescription, kExamples);
  add_run_command(line, command_line, gate);
  add_compare_command(line, command_line, gate);
  add_report_command(line, gate);
  add_plot_command(line, gate);
  add_figure_command(line);
  add_claims_command(line);
  add_counters_command(line);
  add_model_command(line);
  add_correlate_command(line, gate);
  add_sweep_command(line, start, gate);
  add_stress_command(line, gate);
  add_inspect_command(line, gate);
  add_diff_command(line, gate);
  add_info_command(line);
  add_check_capture_command(line, gate);
  add_export_soup_command(line, gate);
  add_make_command(line, gate);
  add_preview_command(line, gate);
  add_capture_command(line);
  add_schema_command(line);
  add_completion_command(line);
  add_man_command(line);
  line.run(argc, argv);
  std::cout.flush();
  if (!std::cout) return report_error("cannot write to standard output", kRuntimeError);
  return 0;
}

}  // namespace

int run_program(int argc, char** argv, const std::vector<std::string>& start) {
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding a file size limit must be a write error, not the end of the program
  InterruptGate gate;
  try {
    return run(argc, argv, start, gate);
  } catch (const UsageError& error) {
    return report_error(error.what(), kUsageError);
  } catch (const SpecError& error) {
    return report_error(error.what(), kUsageError);
  } catch (const std::bad_alloc&) {
    return report_error("out of memory", kRuntimeError);
  } catch (const std::exception& error) {
    return report_error(error.what(), kRuntimeError);
  }
}

}  // namespace beampipe

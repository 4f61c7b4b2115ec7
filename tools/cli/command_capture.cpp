// beampipe capture: makes a trace from a real program. The work is done by the Python scripts in tools/capture.

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "tools/cli/commands.h"

namespace beampipe {
namespace {

// The scripts of the installed program, or those of the source folder.
std::filesystem::path scripts_folder() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path installed = program.parent_path() / "../share/beampipe/capture";
  return std::filesystem::exists(installed / "__main__.py") ? installed : BEAMPIPE_CAPTURE_SCRIPTS;
}

// Becomes Python, which does not return. The process stays the same, so that signals reach it.
[[noreturn]] void run_scripts(const std::vector<std::string>& words) {
  std::vector<std::string> command = {BEAMPIPE_PYTHON, scripts_folder().string()};
  command.insert(command.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& word : command) argv.push_back(word.data());
  argv.push_back(nullptr);
  sigset_t signals;  // those that InterruptGate blocks; a process keeps its mask
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_UNBLOCK, &signals, nullptr);
  execv(BEAMPIPE_PYTHON, argv.data());
  throw std::runtime_error(std::string(BEAMPIPE_PYTHON " (Debian package python3) cannot be started: ") +
                           std::strerror(errno));
}

}  // namespace

void add_capture_command(CommandLine& line) {
  const auto words = std::make_shared<std::vector<std::string>>();
  Command command = line.add_command("capture", "Make a trace from a frame of a real OpenGL or Vulkan program");
  command.take_all_words(*words);
  command.set_work([words] { run_scripts(*words); });
}

}  // namespace beampipe

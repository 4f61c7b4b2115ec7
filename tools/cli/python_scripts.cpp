#include "tools/cli/python_scripts.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace beampipe {

std::filesystem::path scripts_folder(const std::string& installed, const std::string& source, const std::string& file) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path folder = program.parent_path() / ".." / installed;
  return std::filesystem::exists(folder / file) ? folder : std::filesystem::path(source);
}

void become_python(const std::vector<std::string>& arguments) {
  // On a full disk, half of a compiled module would stay, and Python would believe it.
  std::vector<std::string> command = {BEAMPIPE_PYTHON, "-B"};
  command.insert(command.end(), arguments.begin(), arguments.end());
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

}  // namespace beampipe

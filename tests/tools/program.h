// Runs the built program as a user does.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/tools/fixtures.h"

namespace beampipe {

struct Outcome {
  int exit_code = -1;  // -1 if a signal ended the program
  std::string out, err;
  std::uint64_t peak_bytes = 0;  // of resident memory
};

// A running `beampipe ARGUMENTS`, whose output goes to files.
class Program {
 public:
  // If `terminal` is not negative, standard error goes to this file descriptor instead of a file.
  explicit Program(const std::vector<std::string>& arguments, int terminal = -1) {
    std::vector<std::string> words = {BEAMPIPE_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = (output_ / "out").string(), err = (output_ / "err").string();
    pid_ = fork();
    if (pid_ == 0) {
      dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
      dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0666), STDOUT_FILENO);
      dup2(terminal >= 0 ? terminal : open(err.c_str(), O_WRONLY | O_CREAT, 0666), STDERR_FILENO);
      setenv("XDG_CACHE_HOME", (output_ / "cache").c_str(), 1);  // no run sees what another one has kept
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Program() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void signal(int number) const { kill(pid_, number); }

  Outcome wait() {
    int status = 0;
    rusage usage{};
    wait4(pid_, &status, 0, &usage);
    pid_ = 0;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of("out"), text_of("err"),
            static_cast<std::uint64_t>(usage.ru_maxrss) << 10};
  }

 private:
  // Empty if the process was killed before it opened the file, or writes to a terminal.
  std::string text_of(const char* name) const {
    return std::filesystem::exists(output_ / name) ? read_text(output_ / name) : "";
  }

  TemporaryFolder output_;
  pid_t pid_ = 0;
};

using Names = std::vector<std::string>;

inline Names joined(Names first, const Names& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

inline Outcome run_program(const std::vector<std::string>& arguments) { return Program(arguments).wait(); }

// Expects a failed run with a single line on standard error, which contains `part`, and no output.
inline void expect_one_error_line(const Outcome& outcome, int exit_code, const std::string& part) {
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.rfind("beampipe: error: ", 0), 0u) << outcome.err;
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err << "does not say: " << part;
}

// Runs the program in a folder.
class RunInFolder : public InFolder {
 protected:
  // Expects success, with notes on standard error or without.
  static Outcome finish(const Names& arguments) {
    Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  }
  // Expects success, with nothing on standard error. Returns the output.
  static std::string succeed(const Names& arguments) {
    const Outcome outcome = finish(arguments);
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  }
  static void expect_error(const Names& arguments, int exit_code, const std::string& part) {
    expect_one_error_line(run_program(arguments), exit_code, part);
  }
};

}  // namespace beampipe

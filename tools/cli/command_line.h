// The command line: subcommands, their options, and what --help says of them. CLI11, which parses it, is known to
// tools/cli/command_line.cpp alone: its templates take seconds in every file that sees them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace beampipe {

// What the user asked for makes no sense; one line. Ends the program with exit code 2, other errors with 1.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// An option or argument of a command. Each member adds a rule and returns the option, so that rules can be chained.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& required();
  Option& between(std::uint64_t low, std::uint64_t high);   // both included
  Option& one_of(const std::vector<std::string>& choices);  // in small or capital letters
  // Likewise; takes units too: 512MB, 2GB. `example`: for the error.
  Option& bytes(std::uint64_t low, std::uint64_t high, const std::string& example);
  Option& exactly(int values, const std::string& form);     // one word with commas: --eye 1,2,3
  Option& list(const std::string& form);                    // likewise, with any number of values
  Option& shows_default();                                  // --help prints the variable's value
  Option& excludes(const Option& other);
  Option& needs(const Option& other);  // means nothing without the other one

 private:
  CLI::Option* option_;
};

// A subcommand, or a group of its options under a heading of their own.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  // Binds an option ("-o,--output") or argument ("TRACE") to a variable, which keeps its value when the user does not
  // give the option. The variable must live until the command line is parsed. Value: std::string, int, double,
  // std::uint32_t, std::uint64_t, std::optional<std::uint64_t>, or a std::vector of strings, doubles or std::uint32_t.
  template <class Value>
  Option add(const std::string& names, Value& variable, const std::string& help);
  Option add_flag(const std::string& names, bool& variable, const std::string& help);
  Command add_group(const std::string& title);

  bool was_given(const std::string& option) const;

  // What --help prints after the options.
  void footer(const std::string& text);

  // `work` is done, after parsing, when the user names this command. It prints results on stdout and throws on errors.
  void set_work(std::function<void()> work);

 private:
  CLI::App* app_;
};

// What --help says, for man pages and for shells.
struct OptionHelp {
  std::vector<std::string> names;    // "-o", "--output"; of an argument, what stands for it: "TRACE"
  bool is_argument = false;          // it has no name on the command line
  std::string value;                 // "FILE", "N", ...; empty for a flag
  std::vector<std::string> choices;  // all values; empty if there are others
  std::string text;
};

struct CommandHelp {
  std::string name, description, footer;
  std::vector<OptionHelp> options;
};

class CommandLine {
 public:
  CommandLine(const std::string& program, const std::string& version, const std::string& description,
              const std::string& footer);
  ~CommandLine();

  Command add_command(const std::string& name, const std::string& description);

  // A command for a program that understands all words which follow its name, options and --help too: run() leaves them
  // in `words`, which must live until then.
  Command add_command(const std::string& name, const std::string& description, std::vector<std::string>& words);

  std::string description() const;
  std::string footer() const;

  // Of all commands that were added, in that order.
  std::vector<CommandHelp> help() const;

  // Does the work of the command that the user named, or prints what --help or --version ask for. Throws UsageError,
  // and what the work throws.
  void run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
  std::map<std::string, std::vector<std::string>*> all_words_;  // of the commands that take them, by name
};

}  // namespace beampipe

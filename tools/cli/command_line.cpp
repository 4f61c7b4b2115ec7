#include "tools/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <optional>
#include <type_traits>

#include "pipeline/wrapped_text.h"
#include "traces/closest_name.h"

namespace beampipe {
namespace {

constexpr std::size_t kHelpWidth = 88;  // characters of the column in which --help prints a text

// What --help shows as an option's value.
template <class Value>
const char* type_name() {
  if constexpr (std::is_integral_v<Value> || std::is_same_v<Value, std::optional<std::uint64_t>>) {
    return "N";
  } else if constexpr (std::is_same_v<Value, double>) {
    return "NUMBER";
  } else {
    return "TEXT";
  }
}

template <class Part>
std::vector<std::string> names_of(const std::vector<Part*>& parts) {
  std::vector<std::string> names;
  for (const Part* part : parts) names.push_back(part->get_name());
  return names;
}

// The groups of a command's options, which are commands without a name.
std::vector<const CLI::App*> groups_of(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App* part) { return part->get_name().empty(); });
}

// An option that does not exist explains more than one that is missing, which may be the same, mistyped. `help`: the
// command line that lists the options.
void fail_unknown_option(const CLI::App& command, const std::string& help) {
  const auto is_named = [](const CLI::Option* option) { return option->nonpositional(); };
  std::vector<std::string> names = names_of(command.get_options(is_named));
  for (const CLI::App* group : groups_of(command)) {
    const std::vector<std::string> more = names_of(group->get_options(is_named));
    names.insert(names.end(), more.begin(), more.end());
  }
  for (const std::string& word : command.remaining()) {
    if (!word.starts_with("--")) continue;
    const std::string name = word.substr(0, word.find('='));
    throw UsageError("there is no option " + name + did_you_mean(name, names) + " (see " + help + ")");
  }
}

// The choices in a description such as "TEXT:{all,none}".
std::vector<std::string> choices_of(const std::string& type) {
  std::vector<std::string> choices;
  const std::size_t first = type.find('{'), last = type.find('}');
  if (first == type.npos || last == type.npos) return choices;
  for (std::size_t at = first + 1, end; at < last; at = end + 1) {
    end = std::min(type.find(',', at), last);
    choices.push_back(type.substr(at, end - at));
  }
  return choices;
}

OptionHelp help_of(const CLI::Option& option) {
  OptionHelp help;
  for (const std::string& name : option.get_snames()) help.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) help.names.push_back("--" + name);
  help.is_argument = help.names.empty();
  if (help.is_argument) help.names.push_back(option.get_name());
  const std::string type = option.get_type_name();
  if (option.get_items_expected_max() > 0) help.value = type.substr(0, type.find(':'));
  help.choices = choices_of(type);
  help.text = option.get_description();
  std::replace(help.text.begin(), help.text.end(), '\n', ' ');
  return help;
}

// Those of its groups too, which are commands without a name.
void add_options(const CLI::App& app, std::vector<OptionHelp>& options) {
  for (const CLI::Option* option : app.get_options()) options.push_back(help_of(*option));
  for (const CLI::App* group : groups_of(app)) add_options(*group, options);
}

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::between(std::uint64_t low, std::uint64_t high) {
  option_->check(CLI::Range(low, high).description(std::to_string(low) + ".." + std::to_string(high)));
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& choices) {
  CLI::Validator member = CLI::IsMember(choices, CLI::ignore_case);
  CLI::Validator with_hint = member;  // keeps its description, which --help prints
  with_hint.operation([member, choices](std::string& text) {
    const std::string wrong = member(text);
    return wrong.empty() ? wrong : wrong + did_you_mean(text, choices);
  });
  option_->transform(with_hint);
  return *this;
}

Option& Option::bytes(std::uint64_t low, std::uint64_t high, const std::string& example) {
  option_->transform(CLI::AsSizeValue(false).description(""));
  const auto refusal = [low, high, example](const std::string& found) -> std::string {
    if (CLI::Range(low, high)(found).empty()) return "";
    return "expected " + std::to_string(low) + " to " + std::to_string(high) + " bytes, such as " + example +
           ", found " + found;
  };
  option_->check(CLI::Validator(refusal, ""))->type_name("SIZE");
  return *this;
}

Option& Option::exactly(int values, const std::string& form) {
  option_->delimiter(',')->expected(values)->type_name(form);
  return *this;
}

Option& Option::list(const std::string& form) {
  option_->delimiter(',')->allow_extra_args(false)->type_name(form);
  return *this;
}

Option& Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

template <class Value>
Option Command::add(const std::string& names, Value& variable, const std::string& help) {
  return Option(app_->add_option(names, variable, wrapped(help, kHelpWidth))->type_name(type_name<Value>()));
}
template Option Command::add(const std::string&, std::string&, const std::string&);
template Option Command::add(const std::string&, int&, const std::string&);
template Option Command::add(const std::string&, double&, const std::string&);
template Option Command::add(const std::string&, std::uint32_t&, const std::string&);
template Option Command::add(const std::string&, std::uint64_t&, const std::string&);
template Option Command::add(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Option Command::add(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::add(const std::string&, std::vector<double>&, const std::string&);
template Option Command::add(const std::string&, std::vector<std::uint32_t>&, const std::string&);

Option Command::add_flag(const std::string& names, bool& variable, const std::string& help) {
  return Option(app_->add_flag(names, variable, wrapped(help, kHelpWidth)));
}

Command Command::add_group(const std::string& title) { return Command(app_->add_option_group(title)); }

bool Command::was_given(const std::string& option) const { return app_->count(option) > 0; }

void Command::footer(const std::string& text) { app_->footer(text); }

void Command::set_work(std::function<void()> work) { app_->callback(std::move(work)); }

CommandLine::CommandLine(const std::string& program, const std::string& version, const std::string& description,
                         const std::string& footer)
    : app_(std::make_unique<CLI::App>(description, program)) {
  app_->set_version_flag("--version", program + " " + version);
  app_->require_subcommand(1);
  app_->footer(footer);
}

CommandLine::~CommandLine() = default;

Command CommandLine::add_command(const std::string& name, const std::string& description) {
  return Command(app_->add_subcommand(name, description));
}

Command CommandLine::add_command(const std::string& name, const std::string& description,
                                 std::vector<std::string>& words) {
  all_words_[name] = &words;
  CLI::App* app = app_->add_subcommand(name, description);
  app->set_help_flag();
  return Command(app);
}

std::string CommandLine::description() const { return app_->get_description(); }

std::string CommandLine::footer() const { return app_->get_footer(); }

std::vector<CommandHelp> CommandLine::help() const {
  std::vector<CommandHelp> commands;
  for (const CLI::App* app : app_->get_subcommands([](const CLI::App*) { return true; })) {
    CommandHelp& command = commands.emplace_back();
    command.name = app->get_name();
    command.description = app->get_description();
    if (app->get_footer() != footer())
      command.footer = app->get_footer();  // commands without one inherit the program's
    add_options(*app, command.options);
  }
  return commands;
}

void CommandLine::run(int argc, char** argv) {
  const std::string program = app_->get_name();
  if (const auto found = all_words_.find(argc > 1 ? argv[1] : ""); found != all_words_.end()) {
    found->second->assign(argv + 2, argv + argc);
    argc = 2;
  }
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    app_->exit(asked);
  } catch (const CLI::ParseError& error) {
    const std::vector<CLI::App*> named = app_->get_subcommands();
    if (named.empty() && argc > 1 && argv[1][0] != '-')
      throw UsageError(std::string("there is no command ") + argv[1] +
                       did_you_mean(argv[1], names_of(app_->get_subcommands([](CLI::App*) { return true; }))) +
                       " (see " + program + " --help)");
    const std::string help = program + (named.empty() ? "" : " " + named.front()->get_name()) + " --help";
    fail_unknown_option(named.empty() ? *app_ : *named.front(), help);
    throw UsageError(std::string(error.what()) + " (see " + help + ")");
  }
}

}  // namespace beampipe

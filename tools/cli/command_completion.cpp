// beampipe completion: a script that completes commands, options and their values in bash or zsh.
#include <algorithm>
#include <iostream>
#include <sstream>

#include "pipeline/technique_table.h"
#include "tools/cli/commands.h"
#include "tools/evaluate/hardware.h"
#include "traces/scenes.h"

namespace beampipe {
namespace {

std::string join(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

// The values of an option that are not files.
std::vector<std::string> values_of(const std::string& command, const OptionHelp& option) {
  const std::string& name = option.names.back();
  std::vector<std::string> values = option.choices;
  if (name == "--technique") {
    for (const TechniqueKind& kind : technique_kinds())
      if (std::find(values.begin(), values.end(), kind.name) == values.end()) values.push_back(kind.name);
  } else if (name == "--hardware") {
    values = hardware_names();
  } else if (command == "make" && option.is_argument) {
    for (const SceneKind& kind : scene_kinds()) values.emplace_back(kind.name);
  }
  return values;
}

std::string bash_script(const std::vector<CommandHelp>& commands) {
  std::ostringstream script;
  std::vector<std::string> names;
  for (const CommandHelp& command : commands) names.push_back(command.name);
  script << "# Completion of beampipe in bash: source it, or put it into a folder of bash-completion.\n"
            "_beampipe() {\n"
            "  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]}\n"
            "  local options= values=\n"
            "  COMPREPLY=()\n"
            "  if ((COMP_CWORD == 1)); then\n"
            "    COMPREPLY=($(compgen -W '"
         << join(names, " ")
         << " --help --version' -- \"$word\"))\n"
            "    return\n"
            "  fi\n"
            "  case $command in\n";
  for (const CommandHelp& command : commands) {
    std::vector<std::string> options, arguments;
    script << "    " << command.name << ")\n      case $previous in\n";
    for (const OptionHelp& option : command.options) {
      const std::vector<std::string> values = values_of(command.name, option);
      if (option.is_argument) {
        arguments.insert(arguments.end(), values.begin(), values.end());
        continue;
      }
      options.insert(options.end(), option.names.begin(), option.names.end());
      if (!values.empty())
        script << "        " << join(option.names, "|") << ") values='" << join(values, " ") << "' ;;\n";
    }
    if (!arguments.empty()) script << "        " << command.name << ") values='" << join(arguments, " ") << "' ;;\n";
    script << "      esac\n      options='" << join(options, " ") << "' ;;\n";
  }
  script << "  esac\n"
            "  if [[ $word == -* ]]; then\n"
            "    COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
            "  elif [[ $values ]]; then\n"
            "    COMPREPLY=($(compgen -W \"$values\" -- \"$word\"))\n"
            "  fi\n"
            "}\n"
            "complete -o default -F _beampipe beampipe\n";  // files, where nothing else fits
  return script.str();
}

// As text in single quotes in a specification of _arguments.
std::string zsh_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') escaped += '\\';
    escaped += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return escaped;
}

std::string zsh_script(const std::vector<CommandHelp>& commands) {
  std::ostringstream script;
  script << "#compdef beampipe\n"
            "# Completion of beampipe in zsh: put it as _beampipe into a folder of $fpath.\n"
            "_beampipe() {\n"
            "  local -a commands=(\n";
  for (const CommandHelp& command : commands)
    script << "    '" << zsh_text(command.name) << ":" << zsh_text(command.description) << "'\n";
  script << "  )\n"
            "  if ((CURRENT == 2)); then\n"
            "    _describe command commands\n"
            "    return\n"
            "  fi\n"
            "  local command=$words[2]\n"
            "  shift words\n"
            "  ((CURRENT--))\n"
            "  case $command in\n";
  for (const CommandHelp& command : commands) {
    script << "    " << command.name << ")\n      _arguments";
    bool takes_files = false;
    for (const OptionHelp& option : command.options) {
      const std::vector<std::string> values = values_of(command.name, option);
      const std::string action = values.empty() ? "_files" : "(" + join(values, " ") + ")";
      if (option.is_argument) {
        if (!takes_files)
          script << " \\\n        '*:" << zsh_text(option.names[0]) << ":" << (values.empty() ? "_files" : "_files -/")
                 << "'";
        takes_files = true;
        continue;
      }
      for (const std::string& name : option.names) {
        script << " \\\n        '*" << name << "[" << zsh_text(option.text) << "]";
        if (!option.value.empty()) script << ":" << zsh_text(option.value) << ":" << action;
        script << "'";
      }
    }
    script << " ;;\n";
  }
  script << "  esac\n}\n_beampipe \"$@\"\n";
  return script.str();
}

}  // namespace

void add_completion_command(CommandLine& line) {
  const auto shell = std::make_shared<std::string>();
  Command command = line.add_command("completion", "Print a script that completes commands and options in a shell");
  command.add("SHELL", *shell, "the shell").one_of({"bash", "zsh"}).required();
  command.footer(
      "Installed packages have these scripts in place. Otherwise:\n"
      "  source <(beampipe completion bash)                   (in ~/.bashrc)\n"
      "  beampipe completion zsh > ~/.zfunc/_beampipe         (with ~/.zfunc in $fpath)");
  command.set_work(
      [shell, &line] { std::cout << (*shell == "bash" ? bash_script(line.help()) : zsh_script(line.help())); });
}

}  // namespace beampipe

// beampipe man: the manual page, made from what --help says.
#include <iostream>
#include <sstream>

#include "tools/cli/commands.h"
#include "tools/evaluate/results.h"

namespace beampipe {
namespace {

// As text of a roff document: backslashes and hyphens are themselves, and no line starts a request.
std::string roff(const std::string& text) {
  std::string escaped;
  bool starts_line = true;
  for (const char c : text) {
    if (starts_line && (c == '.' || c == '\'')) escaped += "\\&";
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
    starts_line = c == '\n';
  }
  return escaped;
}

// Lines as they are, as an example.
void verbatim(std::ostream& page, const std::string& text) {
  if (!text.empty()) page << ".PP\n.nf\n" << roff(text) << "\n.fi\n";
}

void describe(std::ostream& page, const OptionHelp& option) {
  page << ".TP\n";
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + ("\\fB" + roff(name) + "\\fR");
  page << names;
  if (!option.is_argument && !option.value.empty()) page << " \\fI" << roff(option.value) << "\\fR";
  page << "\n" << roff(option.text) << "\n";
  if (option.choices.empty()) return;
  page << "One of";
  for (std::size_t i = 0; i < option.choices.size(); ++i) page << (i ? ", " : " ") << roff(option.choices[i]);
  page << ".\n";
}

std::string man_page(const CommandLine& line) {
  std::ostringstream page;
  page << ".TH BEAMPIPE 1 \"\" \"beampipe " << roff(program_version()) << "\" \"User Commands\"\n"
       << ".SH NAME\nbeampipe \\- simulate the beam rasterization pipeline and other antialiasing techniques\n"
       << ".SH SYNOPSIS\n\\fBbeampipe\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n"
       << ".SH DESCRIPTION\n"
       << roff(line.description()) << "\n"
       << ".SH COMMANDS\n";
  for (const CommandHelp& command : line.help()) {
    page << ".SS beampipe " << roff(command.name) << "\n" << roff(command.description) << ".\n";
    for (const OptionHelp& option : command.options) describe(page, option);
    verbatim(page, command.footer);
  }
  verbatim(page, line.footer());
  return page.str();
}

}  // namespace

void add_man_command(CommandLine& line) {
  Command command = line.add_command("man", "Print the manual page, for man");
  command.footer("Example:\n  beampipe man | man -l -");
  command.set_work([&line] { std::cout << man_page(line); });
}

}  // namespace beampipe

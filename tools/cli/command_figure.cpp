// beampipe figure: makes a figure for a paper. The work is done by the Python package in tools/python.

#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/python_scripts.h"

namespace beampipe {

namespace {

// The package's folder takes the place of the current one, whose files could have the names of Python's modules.
constexpr const char* kStart = R"(
import sys
try:
    sys.path = [sys.argv.pop(1), *filter(None, sys.path)]
    from beampipe.figure_command import main
    main()
except KeyboardInterrupt:
    print("beampipe: stopped", file=sys.stderr)
    sys.exit(130)
)";

}  // namespace

void add_figure_command(CommandLine& line) {
  const auto words = std::make_shared<std::vector<std::string>>();
  Command command =
      line.add_command("figure", "Make a figure for a paper from results: pictures, crops, maps of errors", *words);
  command.set_work([words] {
    const std::filesystem::path package =
        scripts_folder(BEAMPIPE_PACKAGE_FOLDER, BEAMPIPE_PACKAGE_SOURCE, "beampipe/figure_command.py");
    std::vector<std::string> arguments = {"-c", kStart, std::filesystem::absolute(package).string()};
    arguments.insert(arguments.end(), words->begin(), words->end());
    become_python(arguments);
  });
}

}  // namespace beampipe

// beampipe capture: makes a trace from a real program. The work is done by the Python scripts in tools/capture.

#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/python_scripts.h"

namespace beampipe {

void add_capture_command(CommandLine& line) {
  const auto words = std::make_shared<std::vector<std::string>>();
  Command command = line.add_command("capture", "Make a trace from a frame of a real OpenGL or Vulkan program", *words);
  command.set_work([words] {
    std::vector<std::string> arguments = {
        scripts_folder("share/beampipe/capture", BEAMPIPE_CAPTURE_SCRIPTS, "__main__.py").string()};
    arguments.insert(arguments.end(), words->begin(), words->end());
    become_python(arguments);
  });
}

}  // namespace beampipe

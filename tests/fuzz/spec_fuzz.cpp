// Any words as techniques: one error, or techniques with a framebuffer and folders of their own.
#include <CLI/CLI.hpp>
#include <set>

#include "tests/fuzz/fuzz_input.h"
#include "tools/commands.h"
#include "tools/report.h"
#include "tools/run_plan.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  std::vector<std::string> specs;
  for (std::string_view rest = text_of(data, size); !rest.empty();) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    specs.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  try {
    std::set<std::string> folders;
    for (const Technique& technique : parse_techniques(specs)) {
      if (technique.framebuffer_bytes_per_pixel() == 0) std::abort();
      const std::string folder = spec_folder(technique.spec);
      if (folder.empty() || folder[0] == '.' || folder.find('/') != folder.npos) std::abort();
      if (!folders.insert(folder).second) std::abort();
    }
  } catch (const UsageError&) {
  } catch (const SpecError&) {
  }
  return 0;
}

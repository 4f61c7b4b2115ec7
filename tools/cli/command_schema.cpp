// beampipe schema: the JSON Schemas of all files that the program reads and writes, from the forms that it checks with.

#include <iostream>

#include "tools/cli/camera_file.h"
#include "tools/cli/commands.h"
#include "tools/evaluate/hardware.h"
#include "tools/inspect/inspection_json.h"
#include "tools/report/report_json.h"
#include "tools/sweep/sweep_plan.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

struct NamedSchema {
  const char* name;
  Json (*schema)();
};
constexpr NamedSchema kSchemas[] = {{"trace", trace_schema},   {"hardware", hardware_schema},
                                    {"camera", camera_schema}, {"sweep", sweep_plan_schema},
                                    {"report", report_schema}, {"inspections", inspections_schema}};

}  // namespace

void add_schema_command(CommandLine& line) {
  Command command =
      line.add_command("schema", "Print the JSON Schema of a kind of file, or a description of hardware to start from");
  const auto name = std::make_shared<std::string>();
  std::vector<std::string> names;
  for (const NamedSchema& each : kSchemas) names.push_back(each.name);
  command.add("KIND", *name, "of which files").required().one_of(names);
  const auto built_in = std::make_shared<std::string>();
  command
      .add("--built-in", *built_in,
           "with hardware: print this description, which is built in, to start one of your own from")
      .one_of(hardware_names());
  command.footer("Describes every key, for editors and other programs that know JSON Schema.");
  command.set_work([name, built_in] {
    if (!built_in->empty()) {
      if (*name != "hardware") throw UsageError("--built-in: expected the kind hardware, found " + *name);
      std::cout << json_text(read_hardware(*built_in).json);
      return;
    }
    for (const auto& [each, schema] : kSchemas)
      if (*name == each) std::cout << json_text(schema());
  });
}

}  // namespace beampipe

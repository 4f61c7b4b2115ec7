#include "tools/report/finished_run.h"

#include "tools/evaluate/remodel.h"
#include "traces/files/trace_io.h"

namespace beampipe {

Report finished_run(const ReportFile& file, const Hardware* other) {
  const std::string name = (file.folder / "report.json").string();
  if (!file.json.contains("hardware"))
    throw ReportError(name + ": expected a run whose times can be modelled, found one without hardware");
  try {
    Report report = read_from_report(file.folder, [&] { return remodelled(file.json, other); });
    if (!report.memory.modelled)
      throw ReportError(name + ": expected a run that modelled memory, found one with --no-memory-model");
    return report;
  } catch (const OtherMemory& error) {
    throw ReportError(name + ": " + error.what());
  } catch (const TraceError& error) {  // it names report.json alone
    throw ReportError((file.folder / error.what()).string());
  }
}

Report finished_run(const std::filesystem::path& folder, const Hardware* other) {
  return finished_run(read_report(folder), other);
}

}  // namespace beampipe

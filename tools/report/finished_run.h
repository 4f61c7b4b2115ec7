// Folders of finished runs whose times can be modelled.
#pragma once

#include <filesystem>

#include "tools/evaluate/results.h"
#include "tools/report/report_file.h"

namespace beampipe {

// A report as remodelled() reads it. Throws ReportError.
Report finished_run(const ReportFile& file, const Hardware* other = nullptr);

// That in FOLDER/report.json. Throws ReportError, or TraceError if the file is not JSON.
Report finished_run(const std::filesystem::path& folder, const Hardware* other = nullptr);

}  // namespace beampipe

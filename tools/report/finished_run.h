// Folders of finished runs whose times can be modelled.
#pragma once

#include <filesystem>

#include "tools/evaluate/results.h"

namespace beampipe {

// FOLDER/report.json as remodelled() reads it. Throws ReportError, or TraceError if the file is not JSON.
Report finished_run(const std::filesystem::path& folder, const Hardware* other = nullptr);

}  // namespace beampipe

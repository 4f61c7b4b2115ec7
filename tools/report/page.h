// The page that an architect reads.
#pragma once

#include <string>

#include "tools/report/figures.h"
#include "tools/report/report_file.h"
#include "tools/report/tables.h"
#include "traces/json.h"

namespace beampipe {

// HTML that needs no other file and no network: styles, scripts, numbers and pictures are in it. `layers` is what
// report_layers gives.
std::string page_html(const ReportFile& report, const std::vector<Table>& tables, const std::vector<Figure>& figures,
                      const Json& layers);

}  // namespace beampipe

// The report as a page for a browser.
#pragma once

#include <string>

#include "tools/report/figures.h"
#include "tools/report/overview.h"
#include "tools/report/report_file.h"
#include "tools/report/tables.h"
#include "traces/files/json.h"

namespace beampipe {

// HTML that contains its styles, scripts, numbers and pictures and needs no other file and no network. `layers` comes
// from page_layers, `inspections` from report_inspections. `shown`: the index of the frame that is shown first.
std::string page_html(const ReportFile& report, const std::vector<Table>& tables, const std::vector<Figure>& figures,
                      const Json& layers, std::size_t shown, const Json& inspections);

// The same for several runs. `command`: the one that makes this page.
std::string overview_html(const Overview& overview, const std::string& command);

}  // namespace beampipe

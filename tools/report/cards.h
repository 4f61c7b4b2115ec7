// What each technique costs and how wrong it is, beside a baseline: the cards on top of the page.
#pragma once

#include <string>

#include "tools/report/report_file.h"
#include "traces/files/json.h"

namespace beampipe {

// The technique that the others are compared with: msaa:8, else the first of msaa, else the first.
std::string baseline_of(const ReportFile& report);

// {"baseline": SPEC, "implementations": [NAME, ...], "cards": [CARD, ...]}. The baseline's card comes first. A CARD has
// "technique", "color", "on_chip_bytes_per_pixel", "on_chip_bytes" (of the largest bin), "bytes_per_pixel" (off chip),
// and where the report has them "dram_bytes", "modelled_ms" ({NAME: {"at_once", "in_turn", "busiest"}}), "rmse", "emr"
// and "emr_bound". Numbers are per frame. Throws JsonError.
Json report_cards(const ReportFile& report);

}  // namespace beampipe

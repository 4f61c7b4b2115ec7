#include "tools/inspect/recorded.h"

#include "tools/inspect/inspection_json.h"
#include "tools/inspect/inspection_picture.h"
#include "tools/inspect/inspection_text.h"

namespace beampipe {

Json recorded_inspections(const std::vector<PixelInspection>& inspections, const std::string& trace) {
  Json pixels = Json::array();
  for (const PixelInspection& each : inspections) {
    Json pixel = to_json(each);
    pixel["cause_shares"] = cause_shares_text(each);
    pixel["svg"] = inspections_svg({each}, trace);
    pixel["text"] = inspection_text(each, trace, true);
    pixels.push_back(std::move(pixel));
  }
  return {{"beampipe_inspect", 1}, {"trace", trace}, {"pixels", pixels}};
}

}  // namespace beampipe

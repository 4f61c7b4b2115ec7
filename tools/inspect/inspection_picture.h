// Inspections as a picture: the pixel enlarged with the edges of its triangles and its positions by owner, and the
// weights as bars beside those of the reference.
#pragma once

#include <string>
#include <vector>

#include "tools/inspect/inspection.h"

namespace beampipe {

// An SVG file with one panel for each inspection, from top to bottom.
std::string inspections_svg(const std::vector<PixelInspection>& inspections, const std::string& trace);

// A page with the same pictures, each with the text of its inspection. It opens offline.
std::string inspections_html(const std::vector<PixelInspection>& inspections, const std::string& trace);

}  // namespace beampipe

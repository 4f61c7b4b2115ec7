// Where in a pixel the texture of a cutout is looked up (stages/beam/alpha_mask.h).
#pragma once

namespace beampipe {

// In the middle of the pixel, of each quarter, of each sixteenth, or at all mask positions.
enum class AlphaPlaces { one, quarters, sixteenths, all };

}  // namespace beampipe

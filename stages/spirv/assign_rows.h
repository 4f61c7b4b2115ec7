// assign_rows: lane operations as they were decoded -> a program whose values share registers
//
// What has no effect is left out. A value has a register from where it is made to where it is used last, in the order
// of blocks; where lanes leave a loop at different times, for the whole loop.
#pragma once

#include "stages/spirv/draft.h"

namespace beampipe {

LaneProgram assign_rows(Draft draft);

}  // namespace beampipe

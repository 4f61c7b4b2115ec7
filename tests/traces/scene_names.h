// A scene's name in the names of tests, where its bytes would be otherwise.
#pragma once

#include <ostream>

#include "traces/scenes.h"

namespace beampipe {

inline void PrintTo(const SceneKind& kind, std::ostream* out) { *out << kind.name; }

}  // namespace beampipe

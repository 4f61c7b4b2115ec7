// Makes googletest print a scene as its name. It would print its bytes otherwise.
#pragma once

#include <ostream>

#include "traces/scenes.h"

namespace beampipe {

inline void PrintTo(const SceneKind& kind, std::ostream* out) { *out << kind.name; }

}  // namespace beampipe

// JSON objects that hold a digest of themselves, so that a damaged file is noticed.
#pragma once

#include "traces/files/json.h"

namespace beampipe {

// The object with a member "digest", that of its text without it.
Json sealed(Json object);

// The object without the digest; null if it has changed since it was sealed, or if it is no object.
Json unsealed(Json object);

}  // namespace beampipe

// Fields of CSV files.
#pragma once

#include <string>

#include "traces/files/json.h"

namespace beampipe {

// A value as a field by RFC 4180: in quotes where it has to be; null is empty.
std::string csv_field(const Json& value);

}  // namespace beampipe

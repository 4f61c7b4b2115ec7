// Bytes as text: base64 of RFC 4648, section 4, on one line.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace beampipe {

std::string to_base64(std::string_view bytes);

// Nothing if the text is not base64, whole and with its padding.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace beampipe

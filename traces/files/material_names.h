// How traces name what materials and their textures have, in the order of the enumerators.
#pragma once

#include <string_view>

namespace beampipe {

inline constexpr std::string_view kWrapNames[] = {"repeat", "clamp", "mirror"};
inline constexpr std::string_view kFilterNames[] = {"nearest", "linear"};
inline constexpr std::string_view kMipFilterNames[] = {"none", "nearest", "linear"};
inline constexpr std::string_view kAlphaModeNames[] = {"opaque", "mask", "blend"};

}  // namespace beampipe

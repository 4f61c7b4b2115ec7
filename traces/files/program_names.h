// How traces name what the programs of draws have, in the order of the enumerators.
#pragma once

#include <string_view>

namespace beampipe {

inline constexpr std::string_view kInterpolationNames[] = {"smooth", "linear", "flat"};
inline constexpr std::string_view kImageShapeNames[] = {"1d", "2d", "3d", "cube"};
inline constexpr std::string_view kTexelFormatNames[] = {
    "R8_UNORM",      "R8G8_UNORM",          "R8G8B8A8_UNORM",    "R8G8B8A8_SRGB",       "B8G8R8A8_UNORM",
    "B8G8R8A8_SRGB", "R16_SFLOAT",          "R16G16_SFLOAT",     "R16G16B16A16_SFLOAT", "R16G16B16A16_UNORM",
    "R32_SFLOAT",    "R32G32B32A32_SFLOAT", "R32G32B32A32_UINT", "R32G32B32A32_SINT",   "D32_SFLOAT"};
inline constexpr std::string_view kSamplerWrapNames[] = {"repeat", "mirror", "clamp_to_edge", "clamp_to_border",
                                                         "mirror_clamp"};
inline constexpr std::string_view kColorTargetNames[] = {"srgb", "unorm", "float"};
inline constexpr std::string_view kSwizzleLetters = "rgba01";

}  // namespace beampipe

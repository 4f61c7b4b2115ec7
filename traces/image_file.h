// Reading the images of textures: PNG and JPEG.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "traces/material.h"

namespace beampipe {

// Reads a whole image, of 1..16384 texels a side, which is checked before memory is taken. Channels that the file lacks
// are filled: grey becomes R, G and B, and alpha is 255. The image has no name. Throws TraceError, with one line that
// starts with `where`.
TextureImage read_image(const std::filesystem::path& file, const std::string& where);

// The same for the bytes of a file.
TextureImage decode_image(std::string_view bytes, const std::string& where);

}  // namespace beampipe

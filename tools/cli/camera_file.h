// The file of --camera: a camera as a trace has it.
#pragma once

#include <string>

#include "tools/cli/framing.h"
#include "traces/files/json.h"

namespace beampipe {

inline constexpr const char* kCameraHelp =
    "a JSON file with the camera, as in a trace: {\"eye\": [3,2,5], \"target\": [0,1,0]}, and \"up\", \"fovy_deg\", "
    "\"near\" and \"far\" unless they are to be chosen";

// The JSON Schema of the file.
Json camera_schema();

// Reads it. Throws TraceError, one line that names the file and the key.
CameraWishes read_camera_file(const std::string& file);

}  // namespace beampipe

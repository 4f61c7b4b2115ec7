// glTF models that other programs wrote: those of Debian's package assimp-testmodels, some of which are broken on
// purpose.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

namespace beampipe {

inline const std::filesystem::path kModels = "/usr/share/assimp/models/glTF2";

// All glTF files in a folder, in the order of their names.
inline std::vector<std::filesystem::path> models_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> models;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension == ".gltf" || extension == ".glb") models.push_back(entry.path());
  }
  std::sort(models.begin(), models.end());
  return models;
}

}  // namespace beampipe

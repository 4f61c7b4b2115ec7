// Reading glTF files with tinygltf, which checks the types of most values but no ranges: whatever uses a number of the
// result checks it first.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <string>

#include "traces/files/model_folder.h"
#include "traces/files/model_import.h"

namespace beampipe {

// The parsed file with its buffers, and its images as the bytes of their files (tinygltf::Image::image), unless these
// are in a buffer. Files that it names must be in its folder.
struct GltfFile {
  ModelFolder folder;
  std::string where;  // how messages start
  tinygltf::Model model;

  // "FILE: /LIST/INDEX", the place of an element for messages.
  std::string place(const char* list, std::size_t index) const {
    return where + ": /" + list + "/" + std::to_string(index);
  }
};

// Throws TraceError if the file is no glTF 2, or requires an extension that is not read.
GltfFile read_gltf_file(const std::filesystem::path& path, bool follow_links, NotRead& not_read);

// Returns `index` as an index into a list of `count` elements. Throws TraceError if it is none.
std::size_t checked_index(int index, std::size_t count, const std::string& where, const char* of_what);

}  // namespace beampipe

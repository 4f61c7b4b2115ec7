// The parts of a trace that say what surfaces are made of: its images and materials.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "traces/files/json_form.h"
#include "traces/files/trace_io.h"

namespace beampipe {

// Of meshes, images or materials: each name's index.
using NameIndex = std::map<std::string, std::uint32_t>;

template <class Item>
NameIndex index_of(const std::vector<Item>& items) {
  NameIndex index;
  for (std::size_t i = 0; i < items.size(); ++i) index[items[i].name] = static_cast<std::uint32_t>(i);
  return index;
}

// The index of the name at `at`. Throws TraceError, which expects `what`, if there is no such name.
std::uint32_t read_name(const JsonCursor& at, const NameIndex& index, const char* what);

// The same as a form. What forms refer to must outlive them.
Form<std::uint32_t> name_form(const NameIndex& index, const char* what);

// All images of a trace, by name, which may have kMostTexels together.
Form<std::vector<TextureImage>> images_form(const std::filesystem::path& trace_file, const ReadOptions& options);

// All materials of a trace, by name.
Form<std::vector<Material>> materials_form(const NameIndex& images);

// Throws TraceError if a texture of the material, which `at` gives to the mesh, uses coordinates that the mesh lacks.
void expect_uvs(const JsonCursor& at, const Material& material, const Mesh& mesh);

}  // namespace beampipe

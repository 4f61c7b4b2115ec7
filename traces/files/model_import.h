// Reading models that other programs wrote: OBJ and glTF 2.0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "traces/trace.h"

namespace beampipe {

// By the end of the file's name: .obj, or also .gltf or .glb, in small or capital letters.
bool is_obj_file(const std::filesystem::path& file);
bool is_model_file(const std::filesystem::path& file);

// What a model has that beampipe does not read: a name for each kind of thing, and how many of them there are.
using NotRead = std::map<std::string, std::size_t>;

// Which triangles of an OBJ get real materials, with normals and texture coordinates. All others are flat, in Kd.
//   none      none
//   textured  those whose material has a map that beampipe reads
//   all       all
enum class ObjMaterials { none, textured, all };

struct ObjOptions {
  ObjMaterials materials = ObjMaterials::none;
  bool follow_links = false;  // the files that it names may be links to others outside its folder
  std::string named_by = {};  // the place in a trace that names the OBJ, with which errors start
};

// Adds an OBJ with its .mtl to a trace: one mesh, the materials that its triangles use, and their images. Polygons are
// triangulated; faces without a material, and materials without Kd, are 0.8 grey. A missing .mtl counts as no material
// and as not read, and so does an unknown usemtl; a .mtl outside the OBJ's folder is an error, and so is an image that
// is missing or outside the folder. The mesh gets the file's name without ".obj". Throws TraceError.
//
// The .mtl's materials become glTF's (traces/files/obj_material.h says how). With ObjMaterials::none, normals, texture
// coordinates and all keywords of materials except Kd count as comments.
void read_obj(const std::filesystem::path& file, const ObjOptions& options, Trace& trace, NotRead& not_read);

struct GltfOptions {
  std::uint32_t width = 320, height = 180;  // of the frames, in pixels
  std::uint32_t frames = 1;                 // frame i shows the animation at i / frames of its length
  std::string animation = {};               // its name, or its number from 0; empty: the first one, or none
  bool animation_if_any = false;            // without a named animation: show the first one if there is any
  bool follow_links = false;                // the files that it names may be links to others outside its folder
};

// A model as a trace, whose frames have no background.
struct ImportedModel {
  Trace trace;
  bool has_camera = false;  // the frames have the model's camera; otherwise they have none
  NotRead not_read;
};

// Reads the scene that a .gltf or .glb file shows by default. Its frames have lights if the model has directional
// lights, and no ambient light. Meshes that are skinned or morphed are stored once for each shape that they take, all
// others once. What materials and images the model has, the trace has too if something uses them.
//
// Lights: a directional light of 1 lux makes a white diffuse surface reflect 1 / pi. Cameras: the first one in the
// scene; its aspect ratio is that of the frames. Throws TraceError.
ImportedModel read_gltf(const std::filesystem::path& file, const GltfOptions& options);

}  // namespace beampipe

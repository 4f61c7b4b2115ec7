#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string_view>

#include "traces/files/base64.h"
#include "traces/files/capture_writer.h"
#include "traces/files/draw_state_writer.h"
#include "traces/files/image_file.h"
#include "traces/files/material_names.h"
#include "traces/files/program_names.h"
#include "traces/files/program_writer.h"
#include "traces/files/trace_text.h"
#include "traces/unit_vector.h"

namespace beampipe {
namespace {

bool needs_version_2(const Mesh& mesh) {
  return !mesh.ws.empty() || !mesh.materials.empty() || !mesh.normals.empty() || !mesh.tangents.empty() ||
         !mesh.uvs[0].empty() || !mesh.uvs[1].empty() || !mesh.vertex_colors.empty() || !mesh.varyings.empty();
}

bool needs_version_2(const Frame& frame) {
  const auto& [lights, ambient] = frame.lighting;
  return lights.size() > 1 || (lights.size() == 1 && lights[0].color != glm::vec3(1.0f)) || ambient ||
         frame.capture != CaptureRecord{} || frame.target != ColorTarget::srgb ||
         frame.background_alpha != Frame{}.background_alpha || std::ranges::any_of(frame.draws, [](const Draw& draw) {
           return draw.material.has_value() || draw.state != DrawState{} || draw.program.has_value();
         });
}

// Version 1 of the format knows flat triangles with three coordinates, one white light and the default state of draws.
int version_of(const Trace& trace, ArrayStorage storage) {
  const auto any = [](const auto& items) {
    return std::ranges::any_of(items, [](const auto& item) { return needs_version_2(item); });
  };
  const bool needs_2 = storage == ArrayStorage::binary || trace.source || !trace.images.empty() ||
                       !trace.materials.empty() || !trace.program_images.empty() || !trace.program_samplers.empty() ||
                       !trace.programs.empty() || any(trace.meshes) || any(trace.frames);
  return needs_2 ? 2 : 1;
}

class TraceWriter : TraceText {
 public:
  using TraceText::TraceText;

  void write(const Trace& trace) {
    check(trace);
    version_ = version_of(trace, storage());
    put("{\"beampipe_trace\": " + std::to_string(version_));
    if (trace.source) write_source(*this, *trace.source);
    if (!trace.images.empty()) {
      put(",\n\"images\": {");
      list(trace.images, [&](const TextureImage& image) { write_image(image); });
      put("}");
    }
    write_programs(*this, trace);
    if (!trace.materials.empty()) {
      put(",\n\"materials\": {");
      list(trace.materials, [&](const Material& material) { write_material(material, trace.images); });
      put("}");
    }
    put(",\n\"meshes\": {");
    list(trace.meshes, [&](const Mesh& mesh) { write_mesh(mesh, trace.materials); });
    put("},\n\"frames\": [");
    list(trace.frames, [&](const Frame& frame) { write_frame(frame, trace); });
    put("]");
    finish_arrays();
    put("}\n");
    finish();
  }

 private:
  void check(const Trace& trace) const {
    if (trace.frames.empty()) fail("it has no frame");
    check_names(trace.images, "images");
    check_names(trace.materials, "materials");
    check_names(trace.meshes, "meshes");
    for (const TextureImage& image : trace.images) {
      if (image.texels.empty() || image.texels.size() != std::size_t{image.width} * image.height) {
        fail("image " + in_quotes(image.name) + " has not the texels of its size");
      }
    }
    for (const Material& material : trace.materials) {
      for (const auto& [name, texture] : kTextureSlots)
        if (material.*texture && (material.*texture)->image >= trace.images.size()) fail("a texture names no image");
    }
    for (const Mesh& mesh : trace.meshes) check(mesh, trace.materials.size());
    for (const Frame& frame : trace.frames) {
      if (frame.capture.pictures.color && *frame.capture.pictures.color >= trace.images.size()) {
        fail("a captured picture names no image");
      }
      for (const Draw& draw : frame.draws) {
        if (draw.mesh >= trace.meshes.size()) fail("a draw names no mesh");
        if (draw.material && *draw.material >= trace.materials.size()) fail("a draw names no material");
        if (draw.material && draw.kd) fail("a draw has both kd and a material");
        if (draw.program) check_program(draw, trace);
      }
    }
  }

  void check_program(const Draw& draw, const Trace& trace) const {
    if (draw.program->program >= trace.programs.size()) fail("a draw names no program");
    if (draw.material || draw.kd) fail("a draw has both a program and kd or a material");
    const Mesh& mesh = trace.meshes[draw.mesh];
    if (mesh.varyings.size() != varyings_of(trace.programs[draw.program->program]) * mesh.positions.size())
      fail("mesh " + in_quotes(mesh.name) + " lacks varyings of a program that draws it");
  }

  template <class Item>
  void check_names(const std::vector<Item>& items, const char* what) const {
    std::set<std::string> names;
    for (const Item& item : items)
      if (!names.insert(item.name).second) fail(std::string("two ") + what + " are named " + in_quotes(item.name));
  }

  void check(const Mesh& mesh, std::size_t materials) const {
    const std::string name = "mesh " + in_quotes(mesh.name);
    if (!mesh.ws.empty() && mesh.ws.size() != mesh.positions.size()) fail(name + " lacks w of some positions");
    if (mesh.colors.size() != mesh.triangles.size()) fail(name + " lacks colours");
    if (!mesh.materials.empty() && mesh.materials.size() != mesh.triangles.size()) fail(name + " lacks materials");
    for (const std::uint32_t material : mesh.materials)
      if (material != kNoMaterial && material >= materials) fail(name + " names no material");
    for (const std::size_t size : {mesh.normals.size(), mesh.tangents.size(), mesh.uvs[0].size(), mesh.uvs[1].size(),
                                   mesh.vertex_colors.size()}) {
      if (size != 0 && size != mesh.positions.size()) fail(name + " lacks attributes of some positions");
    }
    // A reader would normalise the others, which changes bits.
    for (const glm::vec3& normal : mesh.normals)
      if (!is_unit(normal)) fail(name + " has a normal whose length is not 1");
    for (const glm::vec4& tangent : mesh.tangents) {
      if (!is_unit(glm::vec3(tangent))) fail(name + " has a tangent whose length is not 1");
      if (std::abs(tangent.w) != 1) fail(name + " has a tangent whose w is not 1 or -1");
    }
  }

  // An image is part of the trace's own file, so that a trace stays one file, which appears whole or not at all and can
  // be moved. PNG keeps that small.
  void write_image(const TextureImage& image) {
    put_name("an image", image.name);
    put(": {\"data\": \"");
    put(to_base64(encode_png(image)));
    put("\"}");
  }

  void write_texture(const Texture& texture, const std::vector<TextureImage>& images) {
    const Texture defaults;
    open_object();
    put_key("image");
    put_name("an image", images[texture.image].name);
    put_member("uv_set", texture.uv_set, defaults.uv_set);
    put_choice("wrap_u", texture.wrap_u, defaults.wrap_u, kWrapNames);
    put_choice("wrap_v", texture.wrap_v, defaults.wrap_v, kWrapNames);
    put_choice("magnify", texture.magnify, defaults.magnify, kFilterNames);
    put_choice("minify", texture.minify, defaults.minify, kFilterNames);
    put_choice("mip", texture.mip, defaults.mip, kMipFilterNames);
    put_member("anisotropy", texture.anisotropy, defaults.anisotropy);
    close_object();
  }

  void write_material(const Material& material, const std::vector<TextureImage>& images) {
    const Material defaults;
    put_name("a material", material.name);
    put(": ");
    open_object();
    put_member("base_color", material.base_color, defaults.base_color);
    put_member("metallic", material.metallic, defaults.metallic);
    put_member("roughness", material.roughness, defaults.roughness);
    put_member("normal_scale", material.normal_scale, defaults.normal_scale);
    put_member("emissive", material.emissive, defaults.emissive);
    put_choice("alpha_mode", material.alpha_mode, defaults.alpha_mode, kAlphaModeNames);
    put_member("alpha_cutoff", material.alpha_cutoff, defaults.alpha_cutoff);
    put_member("double_sided", material.double_sided, defaults.double_sided);
    put_member("unlit", material.unlit, defaults.unlit);
    for (const auto& [name, texture] : kTextureSlots) {
      if (!(material.*texture)) continue;
      put_key(name);
      write_texture(*(material.*texture), images);
    }
    put("}");
  }

  void write_mesh(const Mesh& mesh, const std::vector<Material>& materials) {
    put_name("a mesh", mesh.name);
    if (mesh.ws.empty()) {
      put_numbers(": {\"positions\": ", mesh.positions);
    } else {
      std::vector<glm::vec4> positions;
      for (std::size_t i = 0; i < mesh.ws.size(); ++i) positions.emplace_back(mesh.positions[i], mesh.ws[i]);
      put_numbers(": {\"positions4\": ", positions);
    }
    put_numbers(",\n\"indices\": ", mesh.triangles);
    const auto is_default = [](const glm::vec3& color) { return color == kDefaultColor; };
    if (version_ == 1 || !std::ranges::all_of(mesh.colors, is_default)) put_numbers(",\n\"colors\": ", mesh.colors);
    if (!mesh.normals.empty()) put_numbers(",\n\"normals\": ", mesh.normals);
    if (!mesh.tangents.empty()) put_numbers(",\n\"tangents\": ", mesh.tangents);
    if (!mesh.uvs[0].empty()) put_numbers(",\n\"uv0\": ", mesh.uvs[0]);
    if (!mesh.uvs[1].empty()) put_numbers(",\n\"uv1\": ", mesh.uvs[1]);
    if (!mesh.vertex_colors.empty()) put_numbers(",\n\"vertex_colors\": ", mesh.vertex_colors);
    if (!mesh.varyings.empty()) {
      put(",\n\"varyings\": ");
      put_bits(mesh.varyings);
    }
    if (!mesh.materials.empty()) write_materials_of(mesh, materials);
    put("}");
  }

  // Those that the mesh uses, in the order of their first triangles, and which of them each triangle has.
  void write_materials_of(const Mesh& mesh, const std::vector<Material>& materials) {
    std::vector<std::uint32_t> used;
    std::map<std::uint32_t, std::uint32_t> place;
    for (const std::uint32_t material : mesh.materials)
      if (place.emplace(material, static_cast<std::uint32_t>(used.size())).second) used.push_back(material);
    put(",\n\"materials\": [");
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (i > 0) put(",");
      used[i] == kNoMaterial ? put("null") : put_name("a material", materials[used[i]].name);
    }
    put("]");
    if (used.size() == 1) return;
    std::vector<std::uint32_t> places;
    for (const std::uint32_t material : mesh.materials) places.push_back(place[material]);
    put_numbers(",\n\"material_of_triangle\": ", places);
  }

  void write_frame(const Frame& frame, const Trace& trace) {
    put("{\"width\": " + std::to_string(frame.width) + ", \"height\": " + std::to_string(frame.height));
    put_array(", \"background\": ", frame.background);
    if (frame.background_alpha != Frame{}.background_alpha) {
      put(", \"background_alpha\": ");
      put_number(frame.background_alpha);
    }
    if (frame.camera) {
      write_camera(*frame.camera);
    } else {
      put_array(",\n\"view\": ", frame.view);
      put_array(",\n\"projection\": ", frame.projection);
    }
    if (frame.target != ColorTarget::srgb) {
      put(",\n\"target\": \"");
      put(kColorTargetNames[static_cast<std::size_t>(frame.target)]);
      put("\"");
    }
    version_ == 1 ? write_light(frame.lighting) : write_lighting(frame.lighting);
    put(",\n\"draws\": [");
    list(frame.draws, [&](const Draw& draw) { write_draw(draw, trace); });
    put("]");
    write_capture_record(*this, frame.capture, trace);
    put("}");
  }

  void write_light(const Lighting& lighting) {
    if (lighting.lights.empty()) return;
    put_array(",\n\"light\": {\"direction\": ", lighting.lights[0].direction);
    put("}");
  }

  void write_lighting(const Lighting& lighting) {
    if (!lighting.lights.empty()) {
      put(",\n\"lights\": [");
      list(lighting.lights, [&](const Light& light) {
        put_array("{\"direction\": ", light.direction);
        if (light.color != glm::vec3(1.0f)) put_array(", \"color\": ", light.color);
        put("}");
      });
      put("]");
    }
    if (!lighting.ambient) return;
    put_array(",\n\"ambient\": {\"sky\": ", lighting.ambient->sky);
    put_array(", \"ground\": ", lighting.ambient->ground);
    put_array(", \"up\": ", lighting.ambient->up);
    put("}");
  }

  void write_camera(const Camera& camera) {
    put_array(",\n\"camera\": {\"eye\": ", camera.eye);
    put_array(", \"target\": ", camera.target);
    put_array(", \"up\": ", camera.up);
    put(", \"fovy_deg\": ");
    put_number(camera.fovy_deg);
    put(", \"near\": ");
    put_number(camera.near);
    put(", \"far\": ");
    put_number(camera.far);
    put("}");
  }

  void write_draw(const Draw& draw, const Trace& trace) {
    put("{\"mesh\": ");
    put_name("a mesh", trace.meshes[draw.mesh].name);
    if (draw.transform != glm::dmat4(1.0)) put_array(", \"transform\": ", draw.transform);
    if (draw.kd) put_array(", \"kd\": ", *draw.kd);
    if (draw.cull != Cull::none) put(draw.cull == Cull::back ? ", \"cull\": \"back\"" : ", \"cull\": \"front\"");
    if (draw.shading == Shading::lambert) put(", \"shading\": \"lambert\"");
    if (draw.material) {
      put(", \"material\": ");
      put_name("a material", trace.materials[*draw.material].name);
    }
    if (draw.state != DrawState{}) write_draw_state(*this, draw.state);
    if (draw.program) write_program_use(*this, *draw.program, trace);
    put("}");
  }

  int version_ = 1;
};

}  // namespace

std::filesystem::path arrays_file_of(const std::filesystem::path& trace) {
  return std::filesystem::path(trace).replace_extension(".bin");
}

void write_trace(const Trace& trace, const std::filesystem::path& file, ArrayStorage storage) {
  TraceWriter(file, storage).write(trace);
}

}  // namespace beampipe

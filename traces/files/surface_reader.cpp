#include "traces/files/surface_reader.h"

#include "traces/files/base64.h"
#include "traces/files/image_file.h"
#include "traces/files/input_file.h"
#include "traces/files/side_file.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

TextureImage read_image_file(const JsonCursor& at, const fs::path& file, std::uint64_t most_texels) {
  try {
    return decode_image(read_input_file(file, file.string(), kMostImageBytes), most_texels);
  } catch (const BadImage& bad) {
    fail_trace(at.where() + ": " + file.string(), bad.expected, bad.found);
  } catch (const TraceError& error) {  // finding the place takes time, and is done only where it is needed
    throw TraceError(at.where() + ": " + error.what());
  }
}

TextureImage read_inline_image(const JsonCursor& at, std::uint64_t most_texels) {
  const std::optional<std::string> bytes = from_base64(at.string());
  if (!bytes) at.fail("base64 text");
  try {
    return decode_image(*bytes, most_texels);
  } catch (const BadImage& bad) {
    at.fail(bad.expected, bad.found);
  }
}

TextureImage read_image(const JsonCursor& at, const fs::path& trace_file, const ReadOptions& options,
                        std::uint64_t most_texels) {
  if (!at.has("file") && !at.has("data")) at.fail("the key \"file\" or \"data\"", "none");
  if (at.has("data")) {
    at.expect_keys({"data"});
    return read_inline_image(at["data"], most_texels);
  }
  at.expect_keys({"file"});
  return read_image_file(at["file"], side_file(at["file"], trace_file, options.allow_outside), most_texels);
}

Texture read_texture(const JsonCursor& at, const NameIndex& images) {
  at.expect_keys({"image", "uv_set", "wrap_u", "wrap_v", "magnify", "minify", "mip", "anisotropy"});
  const auto wrap = [&](const char* key, Wrap& result) {
    if (const auto found = at.find(key)) result = Wrap(found->choice({"repeat", "clamp", "mirror"}));
  };
  const auto filter = [&](const char* key, Filter& result) {
    if (const auto found = at.find(key)) result = Filter(found->choice({"nearest", "linear"}));
  };
  Texture texture;
  texture.image = read_name(at["image"], images, "the name of an image in /images");
  if (const auto uv_set = at.find("uv_set")) texture.uv_set = uv_set->integer(0, 1);
  wrap("wrap_u", texture.wrap_u);
  wrap("wrap_v", texture.wrap_v);
  filter("magnify", texture.magnify);
  filter("minify", texture.minify);
  if (const auto mip = at.find("mip")) texture.mip = MipFilter(mip->choice({"none", "nearest", "linear"}));
  if (const auto probes = at.find("anisotropy")) texture.anisotropy = probes->integer(1, 16);
  return texture;
}

Material read_material(const JsonCursor& at, const NameIndex& images) {
  at.expect_keys({"base_color", "base_texture", "metallic", "roughness", "metallic_roughness_texture", "normal_texture",
                  "normal_scale", "emissive", "emissive_texture", "alpha_mode", "alpha_cutoff", "double_sided",
                  "unlit"});
  Material material;
  if (const auto color = at.find("base_color")) material.base_color = color->rgba();
  if (const auto metallic = at.find("metallic")) material.metallic = metallic->fraction();
  if (const auto roughness = at.find("roughness")) material.roughness = roughness->fraction();
  if (const auto scale = at.find("normal_scale"))
    material.normal_scale = scale->real(-kMostNormalScale, kMostNormalScale);
  if (const auto emissive = at.find("emissive")) material.emissive = emissive->color();
  if (const auto mode = at.find("alpha_mode")) {
    material.alpha_mode = AlphaMode(mode->choice({"opaque", "mask", "blend"}));
  }
  if (const auto cutoff = at.find("alpha_cutoff")) material.alpha_cutoff = cutoff->fraction();
  if (const auto both = at.find("double_sided")) material.double_sided = both->boolean();
  if (const auto unlit = at.find("unlit")) material.unlit = unlit->boolean();
  for (const auto& [key, texture] : kTextureSlots)
    if (const auto found = at.find(key)) material.*texture = read_texture(*found, images);
  return material;
}

}  // namespace

std::uint32_t read_name(const JsonCursor& at, const NameIndex& index, const char* what) {
  const auto found = index.find(at.string());
  if (found == index.end()) at.fail(what);
  return found->second;
}

std::vector<TextureImage> read_images(const JsonCursor& at, const fs::path& trace_file, const ReadOptions& options) {
  std::vector<TextureImage> images;
  std::uint64_t texels = 0;
  for (const auto& [name, image] : at.members()) {
    images.push_back(read_image(image, trace_file, options, kMostTexels - texels));
    images.back().name = name;
    texels += images.back().texels.size();
  }
  return images;
}

std::vector<Material> read_materials(const JsonCursor& at, const NameIndex& images) {
  std::vector<Material> materials;
  for (const auto& [name, material] : at.members()) {
    materials.push_back(read_material(material, images));
    materials.back().name = name;
  }
  return materials;
}

void expect_uvs(const JsonCursor& at, const Material& material, const Mesh& mesh) {
  if (mesh.triangles.empty()) return;
  for (const auto& [key, slot] : kTextureSlots) {
    const std::optional<Texture>& texture = material.*slot;
    if (!texture || !mesh.uvs[texture->uv_set].empty()) continue;
    at.fail("\"uv" + std::to_string(texture->uv_set) + "\" in mesh " + in_quotes(mesh.name) + ", for the " + key +
                " of material " + in_quotes(material.name),
            "none");
  }
}

}  // namespace beampipe

#include "traces/files/gltf/gltf_material.h"

#include <algorithm>
#include <cmath>

#include "traces/files/image_file.h"
#include "traces/files/input_file.h"
#include "traces/files/json.h"
#include "traces/files/trace_images.h"

namespace beampipe {
namespace {

constexpr double kUnbounded = 1e30;

// Numbers between 0 and `most`.
float factor(double value, double most, const std::string& where) {
  if (!(value >= 0 && value <= most))
    fail_trace(where, most < kUnbounded ? "a number from 0 to 1" : "a finite number of 0 and up", "another one");
  return static_cast<float>(value);
}

glm::vec3 color(const std::vector<double>& values, double most, const std::string& where) {
  if (values.size() < 3) fail_trace(where, "three numbers", std::to_string(values.size()));
  return {factor(values[0], most, where), factor(values[1], most, where), factor(values[2], most, where)};
}

Wrap wrap_of(int wrap, const std::string& where) {
  switch (wrap) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirror;
    default:
      fail_trace(where, "a wrap mode of glTF 2.0", std::to_string(wrap));
  }
}

void set_filters(Texture& texture, const tinygltf::Sampler& sampler, const std::string& where) {
  switch (sampler.magFilter) {
    case -1:  // the reader may choose
    case TINYGLTF_TEXTURE_FILTER_LINEAR:
      break;
    case TINYGLTF_TEXTURE_FILTER_NEAREST:
      texture.magnify = Filter::nearest;
      break;
    default:
      fail_trace(where, "a magFilter of glTF 2.0", std::to_string(sampler.magFilter));
  }
  const auto set = [&](Filter minify, MipFilter mip) {
    texture.minify = minify;
    texture.mip = mip;
  };
  switch (sampler.minFilter) {
    case -1:
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR:
      return;
    case TINYGLTF_TEXTURE_FILTER_NEAREST:
      return set(Filter::nearest, MipFilter::none);
    case TINYGLTF_TEXTURE_FILTER_LINEAR:
      return set(Filter::linear, MipFilter::none);
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
      return set(Filter::nearest, MipFilter::nearest);
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
      return set(Filter::linear, MipFilter::nearest);
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR:
      return set(Filter::nearest, MipFilter::linear);
    default:
      fail_trace(where, "a minFilter of glTF 2.0", std::to_string(sampler.minFilter));
  }
}

AlphaMode alpha_mode_of(const std::string& name, const std::string& where) {
  if (name == "OPAQUE") return AlphaMode::opaque;
  if (name == "MASK") return AlphaMode::mask;
  if (name == "BLEND") return AlphaMode::blend;
  fail_trace(where + "/alphaMode", "OPAQUE, MASK or BLEND", in_quotes(name));
}

double number_of(const tinygltf::Value& value, const std::string& where) {
  constexpr double kMost = 1e9;
  const double number = value.IsNumber() ? value.GetNumberAsDouble() : 2 * kMost;
  if (!(std::abs(number) <= kMost)) fail_trace(where, "a number from -1e9 to 1e9", "another value");
  return number;
}

// An array of two numbers under a key.
glm::dvec2 pair_of(const tinygltf::Value& object, const std::string& key, const glm::dvec2& otherwise,
                   const std::string& where) {
  if (!object.Has(key)) return otherwise;
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() != 2) fail_trace(where + "/" + key, "two numbers", "another value");
  return {number_of(value.Get(0), where + "/" + key), number_of(value.Get(1), where + "/" + key)};
}

}  // namespace

glm::vec2 GltfUvs::operator()(const glm::vec2& uv) const {
  constexpr double kMost = 1e30;  // a float holds it
  const glm::dvec2 scaled = scale * glm::dvec2(uv);
  const double c = std::cos(rotation), s = std::sin(rotation);
  const glm::dvec2 turned(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
  return glm::vec2(glm::clamp(turned + offset, -kMost, kMost));
}

glm::vec3 limited_light(const glm::vec3& light, NotRead& not_read) {
  if (std::max({light.r, light.g, light.b}) > kMostColor) ++not_read["light above 65504"];
  return glm::min(light, kMostColor);
}

std::uint32_t GltfMaterials::material(int index, const std::string& named_by) {
  if (const auto found = materials_.find(index); found != materials_.end()) return found->second;
  Material material;
  uvs_.push_back({GltfUvs{.set = 0}, GltfUvs{.set = 1}});
  if (index < 0) {
    material.metallic = 1;  // glTF's default, as below
  } else {
    const std::size_t i = checked_index(index, file_.model.materials.size(), named_by, "materials");
    material = read(file_.model.materials[i], file_.place("materials", i));
  }
  trace_.materials.push_back(std::move(material));
  return materials_[index] = static_cast<std::uint32_t>(trace_.materials.size() - 1);
}

Material GltfMaterials::read(const tinygltf::Material& from, const std::string& where) {
  const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
  Material to;
  to.name = from.name;
  const std::string base = where + "/pbrMetallicRoughness/baseColorFactor";
  if (pbr.baseColorFactor.size() != 4) fail_trace(base, "four numbers", std::to_string(pbr.baseColorFactor.size()));
  to.base_color = glm::vec4(color(pbr.baseColorFactor, 1, base), factor(pbr.baseColorFactor[3], 1, base));
  std::vector<Wish> wishes;
  read_texture(pbr.baseColorTexture, where + "/pbrMetallicRoughness/baseColorTexture", to.base_texture, wishes);
  to.metallic = factor(pbr.metallicFactor, 1, where + "/pbrMetallicRoughness/metallicFactor");
  to.roughness = factor(pbr.roughnessFactor, 1, where + "/pbrMetallicRoughness/roughnessFactor");
  read_texture(pbr.metallicRoughnessTexture, where + "/pbrMetallicRoughness/metallicRoughnessTexture",
               to.metallic_roughness_texture, wishes);
  read_texture(from.normalTexture, where + "/normalTexture", to.normal_texture, wishes);
  if (!std::isfinite(from.normalTexture.scale))
    fail_trace(where + "/normalTexture/scale", "a finite number", "another one");
  if (std::abs(from.normalTexture.scale) > kMostNormalScale) ++not_read_["normalTexture scale beyond 1000"];
  to.normal_scale = std::clamp(static_cast<float>(from.normalTexture.scale), -kMostNormalScale, kMostNormalScale);
  if (!from.emissiveFactor.empty()) to.emissive = color(from.emissiveFactor, kUnbounded, where + "/emissiveFactor");
  read_texture(from.emissiveTexture, where + "/emissiveTexture", to.emissive_texture, wishes);
  uvs_.back() = place_uvs(wishes);
  if (const auto strength = from.extensions.find("KHR_materials_emissive_strength");
      strength != from.extensions.end() && strength->second.Has("emissiveStrength")) {
    const tinygltf::Value& value = strength->second.Get("emissiveStrength");
    const std::string place = where + "/extensions/KHR_materials_emissive_strength/emissiveStrength";
    to.emissive *= factor(value.IsNumber() ? value.GetNumberAsDouble() : -1, kUnbounded, place);
  }
  to.emissive = limited_light(to.emissive, not_read_);
  if (from.occlusionTexture.index >= 0) ++not_read_["occlusionTexture"];
  to.alpha_mode = alpha_mode_of(from.alphaMode, where);
  const float cutoff = factor(from.alphaCutoff, kUnbounded, where + "/alphaCutoff");
  to.alpha_cutoff = std::min(cutoff, 1.0f);
  if (to.alpha_mode == AlphaMode::mask && cutoff > 1) to.base_color.a = 0;  // glTF: nothing of it is visible
  to.double_sided = from.doubleSided;
  to.unlit = from.extensions.contains("KHR_materials_unlit");
  return to;
}

template <class TextureInfo>
void GltfMaterials::read_texture(const TextureInfo& info, const std::string& where, std::optional<Texture>& to,
                                 std::vector<Wish>& wishes) {
  if (info.index < 0) return;  // there is no texture
  int set = info.texCoord;
  GltfUvs uvs;
  if (const auto found = info.extensions.find("KHR_texture_transform"); found != info.extensions.end()) {
    const std::string place = where + "/extensions/KHR_texture_transform";
    const tinygltf::Value& transform = found->second;
    uvs.offset = pair_of(transform, "offset", uvs.offset, place);
    uvs.scale = pair_of(transform, "scale", uvs.scale, place);
    if (transform.Has("rotation")) uvs.rotation = number_of(transform.Get("rotation"), place + "/rotation");
    if (transform.Has("texCoord")) set = static_cast<int>(number_of(transform.Get("texCoord"), place + "/texCoord"));
  }
  if (set < 0 || set > 1) {
    ++not_read_["texture with texCoord above 1"];
    return;
  }
  uvs.set = static_cast<std::uint32_t>(set);
  to = texture(info.index, where);
  if (to) wishes.push_back({&to, uvs});
}

// Gives each texture one of a mesh's two sets. Coordinates that are not moved keep their number.
std::array<GltfUvs, 2> GltfMaterials::place_uvs(const std::vector<Wish>& wishes) {
  std::array<std::optional<GltfUvs>, 2> taken;
  for (const bool moved : {false, true}) {
    for (const Wish& wish : wishes) {
      if (wish.uvs.is_moved() != moved) continue;
      std::uint32_t set = wish.uvs.set;
      if (taken[set] && *taken[set] != wish.uvs) set = 1 - set;
      if (taken[set] && *taken[set] != wish.uvs) {
        ++not_read_["KHR_texture_transform beside two others"];
        set = wish.uvs.set;
      } else {
        taken[set] = wish.uvs;
      }
      (*wish.texture)->uv_set = set;
    }
  }
  return {taken[0].value_or(GltfUvs{.set = 0}), taken[1].value_or(GltfUvs{.set = 1})};
}

std::optional<Texture> GltfMaterials::texture(int index, const std::string& where) {
  const tinygltf::Model& model = file_.model;
  const std::size_t i = checked_index(index, model.textures.size(), where, "textures");
  const tinygltf::Texture& from = model.textures[i];
  const std::string place = file_.place("textures", i);
  if (from.source < 0) {
    ++not_read_["texture without a PNG or JPEG"];
    return {};
  }
  Texture texture;
  if (from.sampler >= 0) {
    const std::size_t s = checked_index(from.sampler, model.samplers.size(), place, "samplers");
    texture.wrap_u = wrap_of(model.samplers[s].wrapS, file_.place("samplers", s));
    texture.wrap_v = wrap_of(model.samplers[s].wrapT, file_.place("samplers", s));
    set_filters(texture, model.samplers[s], file_.place("samplers", s));
  }
  texture.image = image(from.source, place);
  return texture;
}

std::uint32_t GltfMaterials::image(int index, const std::string& named_by) {
  if (const auto found = images_.find(index); found != images_.end()) return found->second;
  const tinygltf::Model& model = file_.model;
  const std::size_t i = checked_index(index, model.images.size(), named_by, "images");
  const tinygltf::Image& from = model.images[i];
  const std::string place = file_.place("images", i);
  const auto text_of = [](const unsigned char* bytes, std::size_t size) {
    return std::string_view(reinterpret_cast<const char*>(bytes), size);
  };
  TextureImage image;
  if (from.bufferView >= 0) {
    const std::size_t v = checked_index(from.bufferView, model.bufferViews.size(), place, "bufferViews");
    const tinygltf::BufferView& view = model.bufferViews[v];
    const std::string view_place = file_.place("bufferViews", v);
    const auto& data = model.buffers[checked_index(view.buffer, model.buffers.size(), view_place, "buffers")].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
      fail_trace(view_place, "bytes in its buffer of " + std::to_string(data.size()), "others");
    image = decode_image(text_of(data.data() + view.byteOffset, view.byteLength), place);
  } else if (!from.image.empty()) {
    image = decode_image(text_of(from.image.data(), from.image.size()), place);
  } else {  // tinygltf could not read the file, which is read again for the message
    image = decode_image(file_.folder.read(from.uri, place), place);
  }
  image.name = !from.name.empty() ? from.name : from.uri;
  return images_[index] = add_image(trace_, std::move(image), place);
}

std::vector<Texture> textures_of(const Material& material) {
  std::vector<Texture> textures;
  for (const auto* texture : {&material.base_texture, &material.metallic_roughness_texture, &material.normal_texture,
                              &material.emissive_texture}) {
    if (*texture) textures.push_back(**texture);
  }
  return textures;
}

}  // namespace beampipe

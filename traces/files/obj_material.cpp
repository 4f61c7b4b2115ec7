#include "traces/files/obj_material.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>

#include "traces/files/image_file.h"
#include "traces/files/input_file.h"
#include "traces/files/trace_images.h"

namespace beampipe {
namespace {

// All texels have nearly the same red, green and blue.
bool is_grey(const TextureImage& image) {
  return std::all_of(image.texels.begin(), image.texels.end(), [](const glm::u8vec4& t) {
    return std::max({t.r, t.g, t.b}) - std::min({t.r, t.g, t.b}) <= 8;
  });
}

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::lround(127.5f + 127.5f * value)); }

float number(float value, float least, float most, const std::string& where, const std::string& keyword) {
  if (!(value >= least && value <= most)) fail_trace(where, keyword + " in its range", "another one");
  return value;
}

}  // namespace

bool has_map(const tinyobj::material_t& m) {
  return !m.diffuse_texname.empty() || !m.alpha_texname.empty() || !m.normal_texname.empty() ||
         !m.bump_texname.empty() || !m.emissive_texname.empty();
}

std::uint32_t ObjMaterialReader::add(const tinyobj::material_t& from) {
  constexpr float kMost = 1e30f;
  const std::string where = where_ + ": material " + from.name;
  const auto ranged = [&](float value, float most, const char* keyword) {
    return number(value, 0.0f, most, where, keyword);
  };
  Material to;
  to.name = from.name;
  const float opacity = ranged(from.dissolve, 1, "d");
  for (int i = 0; i < 3; ++i) to.base_color[i] = ranged(from.diffuse[i], kMostColor, "Kd");
  to.base_color.a = opacity;
  if (opacity < 1) to.alpha_mode = AlphaMode::blend;
  to.base_texture = texture(from.diffuse_texname, from.diffuse_texopt, "map_Kd");
  if (const auto alpha = texture(from.alpha_texname, from.alpha_texopt, "map_d")) {
    if (!to.base_texture) to.base_texture = alpha;
    const std::optional<Texture> base = from.diffuse_texname.empty() ? std::nullopt : to.base_texture;
    to.base_texture->image = with_alpha(base, alpha->image);
    if (to.alpha_mode == AlphaMode::opaque) to.alpha_mode = AlphaMode::mask;
  }
  const float highlight = std::max({from.specular[0], from.specular[1], from.specular[2]});
  if (highlight > 0) to.roughness = std::pow(2.0f / (ranged(from.shininess, kMost, "Ns") + 2.0f), 0.25f);
  if (from.roughness != 0) to.roughness = ranged(from.roughness, 1, "Pr");
  to.metallic = ranged(from.metallic, 1, "Pm");
  for (int i = 0; i < 3; ++i) to.emissive[i] = ranged(from.emission[i], kMostColor, "Ke");
  to.emissive_texture = texture(from.emissive_texname, from.emissive_texopt, "map_Ke");
  if (to.emissive_texture && to.emissive == glm::vec3(0.0f)) to.emissive = glm::vec3(1.0f);

  to.normal_texture = texture(from.normal_texname, from.normal_texopt, "norm");
  if (to.normal_texture) {
    to.normal_scale = number(from.normal_texopt.bump_multiplier, -kMostNormalScale, kMostNormalScale, where, "-bm");
  } else if ((to.normal_texture = texture(from.bump_texname, from.bump_texopt, "map_Bump"))) {
    const float scale = number(from.bump_texopt.bump_multiplier, -kMostNormalScale, kMostNormalScale, where, "-bm");
    if (is_grey(trace_.images[to.normal_texture->image])) {
      to.normal_texture->image = normals_from(to.normal_texture->image, scale, to.normal_texture->wrap_u);
    } else {
      to.normal_scale = scale;
    }
  }
  to.double_sided = true;  // faces of OBJ files have no back
  trace_.materials.push_back(std::move(to));
  return static_cast<std::uint32_t>(trace_.materials.size() - 1);
}

std::optional<Texture> ObjMaterialReader::texture(const std::string& name, const tinyobj::texture_option_t& options,
                                                  const std::string& keyword) {
  if (name.empty()) return {};
  const auto differ = [](const float(&values)[3], float usual) {
    return std::any_of(std::begin(values), std::end(values), [usual](float value) { return value != usual; });
  };
  if (differ(options.scale, 1)) ++not_read_["option -s of " + keyword];
  if (differ(options.origin_offset, 0)) ++not_read_["option -o of " + keyword];
  if (differ(options.turbulence, 0)) ++not_read_["option -t of " + keyword];
  if (options.brightness != 0 || options.contrast != 1) ++not_read_["option -mm of " + keyword];
  Texture texture;
  texture.image = image(name);
  if (options.clamp) texture.wrap_u = texture.wrap_v = Wrap::clamp;
  return texture;
}

std::uint32_t ObjMaterialReader::image(const std::string& name) {
  if (const auto found = images_.find(name); found != images_.end()) return found->second;
  std::string path = name;
  std::replace(path.begin(), path.end(), '\\', '/');  // of Windows
  TextureImage image = decode_image(folder_.read(path, where_), where_ + ": " + name);
  image.name = name;
  return keep(name, std::move(image));
}

std::uint32_t ObjMaterialReader::keep(const std::string& key, TextureImage image) {
  return images_[key] = add_image(trace_, std::move(image), where_);
}

// The colours of one image (or white) with the alpha of another, whose nearest texels are taken if the sizes differ.
std::uint32_t ObjMaterialReader::with_alpha(const std::optional<Texture>& base, std::uint32_t alpha_index) {
  const std::string key =
      "alpha of " + std::to_string(alpha_index) + " for " + (base ? std::to_string(base->image) : std::string("white"));
  if (const auto found = images_.find(key); found != images_.end()) return found->second;
  const TextureImage& alpha = trace_.images[alpha_index];
  const bool has_alpha =
      std::any_of(alpha.texels.begin(), alpha.texels.end(), [](const glm::u8vec4& texel) { return texel.a < 255; });
  TextureImage image = base ? trace_.images[base->image] : alpha;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::uint64_t from_x = std::uint64_t{x} * alpha.width / image.width;
      const std::uint64_t from_y = std::uint64_t{y} * alpha.height / image.height;
      const glm::u8vec4 from = alpha.texels[from_y * alpha.width + from_x];
      glm::u8vec4& to = image.texels[std::size_t{y} * image.width + x];
      if (!base) to = glm::u8vec4(255);
      to.a = has_alpha ? from.a : from.r;
    }
  }
  return keep(key, std::move(image));
}

// Central differences; the image repeats or ends at its borders as its texture does.
std::uint32_t ObjMaterialReader::normals_from(std::uint32_t heights_index, float scale, Wrap wrap) {
  const std::string key = "normals of " + std::to_string(heights_index) + " times " + std::to_string(scale) +
                          (wrap == Wrap::clamp ? " clamped" : "");
  if (const auto found = images_.find(key); found != images_.end()) return found->second;
  const TextureImage& heights = trace_.images[heights_index];
  const auto neighbour = [wrap](std::uint32_t i, int step, std::uint32_t size) {
    if (wrap == Wrap::clamp) {
      return static_cast<std::uint32_t>(std::clamp(static_cast<int>(i) + step, 0, static_cast<int>(size) - 1));
    }
    return (i + size + static_cast<std::uint32_t>(step)) % size;
  };
  const auto height = [&](std::uint32_t x, std::uint32_t y) {
    return scale * static_cast<float>(heights.texels[std::size_t{y} * heights.width + x].r) / 255.0f;
  };
  TextureImage normals = heights;
  for (std::uint32_t y = 0; y < heights.height; ++y) {
    const std::uint32_t above = neighbour(y, -1, heights.height), below = neighbour(y, 1, heights.height);
    for (std::uint32_t x = 0; x < heights.width; ++x) {
      const std::uint32_t left = neighbour(x, -1, heights.width), right = neighbour(x, 1, heights.width);
      const float slope_right = (height(right, y) - height(left, y)) / 2;
      const float slope_up = (height(x, above) - height(x, below)) / 2;
      const glm::vec3 normal = glm::normalize(glm::vec3(-slope_right, -slope_up, 1.0f));
      normals.texels[std::size_t{y} * heights.width + x] =
          glm::u8vec4(to_byte(normal.x), to_byte(normal.y), to_byte(normal.z), 255);
    }
  }
  return keep(key, std::move(normals));
}

}  // namespace beampipe

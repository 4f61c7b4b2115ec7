// Traces of rectangles with materials, and all that a stage needs to shade them.
#pragma once

#include "stages/geometry/vertex_setup.h"
#include "stages/surface/sheets.h"
#include "stages/surface/surface_shader.h"
#include "tests/pipeline/test_traces.h"
#include "tests/simd/random.h"

namespace beampipe {

inline TextureImage filled_image(std::uint32_t width, std::uint32_t height, const glm::u8vec4& texel) {
  return {"filled", width, height, std::vector<glm::u8vec4>(std::size_t{width} * height, texel)};
}

inline TextureImage random_image(Random& random, std::uint32_t width, std::uint32_t height) {
  TextureImage image{"random", width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i) {
    const std::uint32_t word = random.word();
    image.texels.emplace_back(word & 255, word >> 8 & 255, word >> 16 & 255, word >> 24);
  }
  return image;
}

// Frame of an orthographic camera that looks along +z at pixel coordinates; depths from 0 to 1. Rectangles are added as
// meshes of two triangles with one draw each; (u, v) go from (0, 0) in the upper left corner to (1, 1).
struct SurfaceTrace {
  Trace trace;

  explicit SurfaceTrace(std::uint32_t width, std::uint32_t height) : trace(pixel_trace(width, height, {})) {
    trace.meshes.clear();
    frame().draws.clear();
  }

  Frame& frame() { return trace.frames[0]; }
  Mesh& mesh() { return trace.meshes.back(); }
  Texture& base_texture() { return *trace.materials[0].base_texture; }

  std::uint32_t add_image(const TextureImage& image) {
    trace.images.push_back(image);
    return static_cast<std::uint32_t>(trace.images.size() - 1);
  }

  void add_rectangle(double x0, double y0, double x1, double y1, double z, const Material& material) {
    Mesh rectangle;
    for (const glm::dvec2& p : {glm::dvec2(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}})
      rectangle.positions.emplace_back(glm::dvec3(p, z));
    rectangle.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    rectangle.triangles = {{0, 1, 2}, {0, 2, 3}};
    rectangle.colors.resize(2, kDefaultColor);
    rectangle.materials.resize(2, static_cast<std::uint32_t>(trace.materials.size()));
    trace.materials.push_back(material);
    trace.materials.back().double_sided = true;
    Draw draw;
    draw.mesh = static_cast<std::uint32_t>(trace.meshes.size());
    trace.meshes.push_back(rectangle);
    frame().draws.push_back(draw);
  }

  // Adds the last mesh once more, at another depth, as part of itself: one draw has both.
  void add_to_draw(double z) {
    const auto first = static_cast<std::uint32_t>(mesh().positions.size());
    for (std::uint32_t i = 0; i < 4; ++i) {
      mesh().positions.emplace_back(mesh().positions[i].x, mesh().positions[i].y, z);
      mesh().uvs[0].push_back(mesh().uvs[0][i]);
    }
    for (const glm::uvec3& corners : {glm::uvec3(0, 1, 2), {0, 2, 3}}) mesh().triangles.push_back(first + corners);
    mesh().colors.resize(mesh().triangles.size(), kDefaultColor);
    mesh().materials.resize(mesh().triangles.size(), mesh().materials[0]);
  }
};

inline Material unlit_material(const glm::vec4& color, AlphaMode mode = AlphaMode::opaque) {
  Material material;
  material.base_color = color, material.unlit = true, material.alpha_mode = mode;
  return material;
}

inline Material textured_material(std::uint32_t image, AlphaMode mode = AlphaMode::opaque) {
  Material material = unlit_material(glm::vec4(1.0f), mode);
  material.base_texture = Texture{.image = image};
  return material;
}

// A white image; `alpha(i)`: of its texels, in codes.
template <class Alpha>
TextureImage image_with_alphas(std::uint32_t width, std::uint32_t height, Alpha&& alpha) {
  TextureImage image = filled_image(width, height, glm::u8vec4(255));
  for (std::size_t i = 0; i < image.texels.size(); ++i) image.texels[i].a = static_cast<std::uint8_t>(alpha(i));
  return image;
}

// A rectangle with an image that fills a frame of side x side pixels.
inline SurfaceTrace full_of(const TextureImage& image, AlphaMode mode = AlphaMode::opaque, std::uint32_t side = 8) {
  SurfaceTrace scene(side, side);
  scene.add_rectangle(0, 0, side, side, 0.5, textured_material(scene.add_image(image), mode));
  return scene;
}

inline void expect_near(const glm::dvec3& found, const glm::dvec3& expected, double bound) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], bound) << found.x << ' ' << found.y << ' ' << found.z;
}

// Everything lives as long as this does.
struct ShadedScene {
  Trace trace;
  StageCounters setup;
  SetupTriangles triangles;
  TextureSet textures;
  SurfaceShader shader;

  explicit ShadedScene(const Trace& of, const ShadingRules& rules = {})
      : trace(of),
        triangles(vertex_setup(trace, trace.frames[0], setup)),
        textures(trace),
        shader(triangles, trace, trace.frames[0], &textures, rules) {
    textures.test_alphas(trace, std::vector<bool>(trace.materials.size(), true));
    StageCounters ignored;
    shader.set_sheets(number_sheets(triangles, trace.frames[0], ignored));
  }
  ShadedScene(const ShadedScene&) = delete;
  ShadedScene& operator=(const ShadedScene&) = delete;

  Tile frame_tile() const {
    return {0, 0, static_cast<std::int32_t>(trace.frames[0].width), static_cast<std::int32_t>(trace.frames[0].height)};
  }
};

}  // namespace beampipe

// The shader of surfaces: what it reads where, normal maps, back faces, G-buffers and what an invocation costs.
#include "stages/surface/surface_shader.h"

#include <glm/gtc/matrix_transform.hpp>

#include "stages/cost/counting.h"
#include "stages/surface/texel_requests.h"
#include "tests/simd/every_target.h"
#include "tests/simd/random.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::surface_shader_test {

// A rectangle of 8 x 8 pixels whose red is linear in u: a gradient of 8 texels, as seen at 1 texel per pixel.
SurfaceTrace gradient() {
  TextureImage image{"gradient", 8, 1, {}};
  for (int i = 0; i < 8; ++i) image.texels.emplace_back(0, 0, 0, 32 * i);
  SurfaceTrace scene = full_of(image, AlphaMode::blend);  // alpha is stored as it is
  scene.base_texture().wrap_u = Wrap::clamp;
  return scene;
}

TEST(SurfaceShader, ALinearTextureIsLinearOnTheScreen) {
  const ShadedScene scene(gradient().trace);
  for (std::int32_t x = 1; x < 7; ++x)
    for (const float u : {0.0f, 0.25f, 0.5f, 0.875f}) {
      const std::uint32_t triangle = x < 4 ? 1 : 0;  // of row 4: the lower left half, and the upper right one
      EXPECT_NEAR(scene.shader.color_and_alpha(triangle, {x, 4, u, 0.5f}).a,
                  32.0 / 255 * (static_cast<double>(x) + u - 0.5), 1e-6);
      EXPECT_EQ(scene.shader.alpha(triangle, {x, 4, u, 0.5f}, 1),
                scene.shader.color_and_alpha(triangle, {x, 4, u, 0.5f}).a);
    }
}

TEST(SurfaceShader, ByPixelItIsTheCentresWhateverPlaceIsAsked) {
  SurfaceTrace trace = gradient();
  for (glm::u8vec4& texel : trace.trace.images[0].texels) texel.r = texel.a;
  const ShadedScene by_place(trace.trace), by_pixel(trace.trace, {.colors = SurfaceColors::by_pixel});
  const glm::vec3 centre = by_place.shader.color(0, {6, 2, 0.5f, 0.5f});
  for (const float u : {0.0f, 0.5f, 0.9f}) {
    EXPECT_EQ(by_pixel.shader.color(0, {6, 2, u, 1 - u}, 0.125f), centre);
    // Opacity is a part of visibility, and stays that of the place.
    EXPECT_EQ(by_pixel.shader.color_and_alpha(0, {6, 2, u, 1 - u}).a,
              by_place.shader.color_and_alpha(0, {6, 2, u, 1 - u}).a);
  }
  EXPECT_NE(by_place.shader.color(0, {6, 2, 0.0f, 0.5f}), centre);
}

// Where a centre lies outside, the weights of the second and third vertex are cut off at 0 and at what is left of 1.
TEST(SurfaceShader, ByPixelCentresBesideATriangleTakeAPointOnItsBorder) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 4, 4, 0.5, unlit_material(glm::vec4(1.0f)));
  scene.mesh().vertex_colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {0, 0, 0, 1}};
  const ShadedScene shaded(scene.trace, {.colors = SurfaceColors::by_pixel});
  // Triangle (0, 0), (4, 0), (4, 4) has the weights 1 - x / 4, (x - y) / 4 and y / 4 at (x, y).
  expect_near(shaded.shader.color(0, {3, 1}), {0.125, 0.5, 0.375}, 1e-6);
  expect_near(shaded.shader.color(0, {4, 1}), {0, 0.75, 0.25}, 1e-6);    // -1/8, 3/4, 3/8
  expect_near(shaded.shader.color(0, {1, 2}), {0.375, 0, 0.625}, 1e-6);  // 5/8, -1/4, 5/8
  expect_near(shaded.shader.color(0, {2, -1}), {0.25, 0.75, 0}, 1e-6);   // 3/8, 3/4, -1/8
  expect_near(shaded.shader.color(0, {5, 0}), {0, 1, 0}, 1e-6);          // -3/8, 5/4, 1/8
}

// Textures with coordinates of their own; which set has which does not matter.
TEST(SurfaceShader, EachTextureIsReadAtItsOwnCoordinates) {
  SurfaceTrace scene(16, 16);
  Random random(6);
  Material material = textured_material(scene.add_image(random_image(random, 16, 16)));
  material.unlit = false;
  material.emissive = glm::vec3(1.0f);
  material.emissive_texture = material.base_texture;
  material.emissive_texture->uv_set = 1;
  material.normal_texture = material.emissive_texture;
  scene.add_rectangle(0, 0, 16, 16, 0.5, material);
  scene.trace.frames[0].lighting = {{{glm::normalize(glm::vec3(1, 2, 3)), glm::vec3(1.0f)}},
                                    Ambient{glm::vec3(1.0f), glm::vec3(1.0f)}};
  Mesh& mesh = scene.trace.meshes[0];
  for (const glm::vec2& uv : mesh.uvs[0]) mesh.uvs[1].push_back(0.5f * uv + 0.3f);
  Trace turned = scene.trace;
  std::swap(turned.meshes[0].uvs[0], turned.meshes[0].uvs[1]);
  turned.materials[0].base_texture->uv_set = 1;
  turned.materials[0].emissive_texture->uv_set = turned.materials[0].normal_texture->uv_set = 0;
  const ShadedScene one(scene.trace), other(turned);
  const glm::vec3 color = one.shader.color(0, {9, 4});
  EXPECT_EQ(other.shader.color(0, {9, 4}), color);
  const float range = one.shader.light_range(0, {9, 4}, 1.0f);
  EXPECT_EQ(other.shader.light_range(0, {9, 4}, 1.0f), range);
  for (const auto texture : {&Material::base_texture, &Material::emissive_texture, &Material::normal_texture}) {
    Trace same = scene.trace;
    (same.materials[0].*texture)->uv_set ^= 1;
    const ShadedScene at_one_place(same);
    EXPECT_NE(at_one_place.shader.color(0, {9, 4}), color);
    EXPECT_EQ(at_one_place.shader.light_range(0, {9, 4}, 1.0f) != range, texture == &Material::normal_texture);
  }
}

// On a plane that faces the camera, texture coordinates are linear, so analytic slopes and quad differences agree.
TEST(SurfaceShader, DerivativesAgreeOnAPlaneThatFacesTheCamera) {
  Random random(1);
  const SurfaceTrace scene = full_of(random_image(random, 64, 64), AlphaMode::opaque, 16);
  const Footprint square, skewed(0.9f, 0.4f, 0.5f);
  for (const int taps : {ShadingRules{}.texture_taps, 16}) {
    const ShadedScene analytic(scene.trace, {.texture_taps = taps}),
        quad(scene.trace, {.derivatives = Derivatives::quad, .texture_taps = taps});
    for (const Footprint& footprint : {square, skewed})
      for (std::int32_t y = 0; y < 16; ++y)
        for (std::int32_t x = 0; x < 16; ++x) {
          const glm::vec3 a = analytic.shader.color(0, {x, y}, footprint), b = quad.shader.color(0, {x, y}, footprint);
          for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5);
        }
  }
}

// A floor in perspective. The level that is read follows from the differences of texture coordinates between the
// centres of a quad's pixels, which are computed here in double precision from the eye's rays.
struct Floor {
  static constexpr double kHeight = 1, kScale = 0.5;  // of the eye above the floor; texture coordinates per unit
  static constexpr std::uint32_t kSize = 64;

  Trace trace;

  Floor() {
    SurfaceTrace scene(kSize, kSize);
    scene.add_rectangle(0, 0, 1, 1, 0, textured_material(scene.add_image(filled_image(256, 256, {9, 9, 9, 255}))));
    scene.mesh().positions = {{-40, 0, -60}, {40, 0, -60}, {40, 0, 5}, {-40, 0, 5}};
    for (std::size_t i = 0; i < 4; ++i)
      scene.mesh().uvs[0][i] = {scene.mesh().positions[i].x * kScale, scene.mesh().positions[i].z * kScale};
    set_camera(scene.frame(), {{0, kHeight, 0}, {0, kHeight, -1}, {0, 1, 0}, 90, 0.5, 100});
    trace = scene.trace;
  }

  // Texture coordinates at a point of the screen: f is 1 at 90 degrees.
  static glm::dvec2 uv(double x, double y) {
    const double right = 2 * x / kSize - 1, up = 1 - 2 * y / kSize, z = kHeight / up;  // negative below the horizon
    return glm::dvec2(-z * right, z) * kScale;
  }

  static double level(const glm::dvec2& dx, const glm::dvec2& dy) {
    return std::log2(256 * std::max(glm::length(dx), glm::length(dy)));
  }
};

// The levels of image 0 that a colour is filtered from.
struct Levels {
  std::uint32_t finest = ~0u, coarsest = 0;
  std::uint64_t texels = 0;
};

Levels levels_read(const ShadedScene& scene, std::uint32_t triangle, const ShadingPlace& place, float width) {
  const TextureLayout layout(scene.textures);
  TexelRequests texels(&layout);
  scene.shader.color(triangle, place, width, &texels);
  texels.end_request();
  Levels found{.texels = texels.texels()};
  const auto level_count = static_cast<std::uint32_t>(scene.textures.chain(0, ColorSpace::srgb).levels.size());
  texels.for_each([&](const auto& sectors) {
    for (const std::uint64_t sector : sectors) {
      std::uint32_t level = 0;
      while (level + 1 < level_count && layout.sector_of({0, ColorSpace::srgb, level + 1, 0, 0}) <= sector) ++level;
      found.finest = std::min(found.finest, level), found.coarsest = std::max(found.coarsest, level);
    }
  });
  return found;
}

TEST(SurfaceShader, ReadsTheLevelOfItsDerivatives) {
  const Floor floor;
  const ShadedScene analytic(floor.trace), quad(floor.trace, {.derivatives = Derivatives::quad});
  std::size_t tested = 0;
  for (std::uint32_t t = 0; t < analytic.triangles.triangles.size(); ++t)
    for (std::int32_t y = 40; y < 64; ++y)
      for (std::int32_t x = 0; x < 64; ++x) {
        const auto at = [&](double px, double py) { return Floor::uv(px + 0.5, py + 0.5); };
        const double h = 1e-4;
        const double by_slope =
            Floor::level((at(x + h, y) - at(x - h, y)) / (2 * h), (at(x, y + h) - at(x, y - h)) / (2 * h));
        const int even_x = x & ~1, even_y = y & ~1;
        const double by_quad = Floor::level(at(even_x + 1, y) - at(even_x, y), at(x, even_y + 1) - at(x, even_y));
        const auto expect = [&](const ShadedScene& scene, double level) {
          if (std::abs(level - std::round(level)) < 0.02 || level > 7.9) return;
          const Levels read = levels_read(scene, t, {x, y}, 1);
          EXPECT_EQ(read.texels, level < 0 ? 4u : 8u) << x << ", " << y;
          EXPECT_EQ(read.finest, std::floor(std::max(level, 0.0))) << x << ", " << y << ": " << level;
          EXPECT_EQ(read.coarsest, level < 0 ? 0 : std::floor(level) + 1) << x << ", " << y << ": " << level;
          ++tested;
        };
        expect(analytic, by_slope), expect(quad, by_quad);
      }
  EXPECT_GT(tested, 1000u);
}

TEST(SurfaceShader, AreaNarrowsTheFootprint) {
  const Floor floor;
  const ShadedScene scene(floor.trace);
  EXPECT_EQ(levels_read(scene, 0, {30, 42}, 0.25f).finest + 2, levels_read(scene, 0, {30, 42}, 1).finest);
}

// ---- Normals

// A rectangle in the plane z = 0 that a camera at (0, 0, 5) sees; v points down, u to the right.
SurfaceTrace facing(const Material& material) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 1, 1, 0, material);
  scene.mesh().positions = {{-1, 1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
  scene.mesh().triangles = {{0, 2, 1}, {0, 3, 2}};  // counter-clockwise
  scene.mesh().normals.assign(4, glm::vec3(0, 0, 1));
  set_camera(scene.frame(), {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30, 1, 10});
  scene.frame().lighting.ambient = Ambient{};
  return scene;
}

// Ambient light shows the normal, if nothing is mirrored: `up` is bright as far as the normal points there.
glm::vec3 normal_seen(SurfaceTrace scene, const ShadingRules& rules = {}) {
  glm::vec3 normal;
  for (int axis = 0; axis < 3; ++axis) {
    Ambient& ambient = *scene.frame().lighting.ambient;
    ambient = {glm::vec3(1), glm::vec3(0), glm::vec3(0)};
    ambient.up[axis] = 1;
    const ShadedScene shaded(scene.trace, rules);
    // Roughness of 1 turns the mirrored direction to the normal: (diffuse + mirrored) x (1 + n) / 2. A metal mirrors.
    normal[axis] = shaded.shader.color(0, {4, 4}).r * 2 - 1;
  }
  return normal;
}

Material white_metal() {
  Material material;
  material.metallic = 1;
  return material;
}

TEST(SurfaceShader, NormalsOfVerticesAndOfTriangles) {
  SurfaceTrace scene = facing(white_metal());
  expect_near(normal_seen(scene), {0, 0, 1}, 1e-5);
  scene.mesh().normals.assign(4, glm::normalize(glm::vec3(3, 0, 4)));
  expect_near(normal_seen(scene), {0.6f, 0, 0.8f}, 1e-5);
  scene.mesh().normals.clear();
  expect_near(normal_seen(scene), {0, 0, 1}, 1e-5);
  // Seen from behind, both are turned to the eye.
  set_camera(scene.frame(), {{0, 0, -5}, {0, 0, 0}, {0, 1, 0}, 30, 1, 10});
  expect_near(normal_seen(scene), {0, 0, -1}, 1e-5);
  scene.mesh().normals.assign(4, glm::normalize(glm::vec3(3, 0, 4)));
  expect_near(normal_seen(scene), {-0.6f, 0, -0.8f}, 1e-5);
}

TEST(SurfaceShader, NormalsTurnWithATransformThatMirrorsOrStretches) {
  SurfaceTrace scene = facing(white_metal());
  scene.mesh().normals.assign(4, glm::normalize(glm::vec3(3, 0, 4)));
  scene.frame().draws[0].transform = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
  expect_near(normal_seen(scene), {-0.6f, 0, 0.8f}, 1e-5);
  scene.frame().draws[0].transform = glm::scale(glm::dmat4(1.0), glm::dvec3(1, 1, 2));  // along z
  expect_near(normal_seen(scene), glm::normalize(glm::vec3(0.6, 0, 0.4)), 1e-5);
}

Material bumpy(SurfaceTrace& scene, const glm::u8vec4& code) {
  Material material = white_metal();
  material.normal_texture = Texture{.image = scene.add_image(filled_image(2, 2, code))};
  return material;
}

// The normal that a texture full of this code gives; `tangents`: the mesh has some.
glm::vec3 bumped(
    const glm::u8vec4& code, const std::function<void(SurfaceTrace&)>& change = [](SurfaceTrace&) {}) {
  SurfaceTrace scene = facing(white_metal());
  scene.trace.materials[0] = bumpy(scene, code);
  scene.trace.materials[0].double_sided = true;
  change(scene);
  return normal_seen(scene);
}

constexpr glm::u8vec4 kFlat{128, 128, 255, 255};                          // 128 stands for 1 / 255, not for 0
constexpr glm::u8vec4 kToU{255, 128, 128, 255}, kUp{128, 255, 128, 255};  // red points along u, green up in the image

TEST(SurfaceShader, RedPointsAlongUAndGreenUp) {
  const auto tangents = [](const glm::vec4& tangent) {
    return [tangent](SurfaceTrace& s) { s.mesh().tangents.assign(4, tangent); };
  };
  const auto coordinates = [](const std::vector<glm::vec2>& uvs) {
    return [uvs](SurfaceTrace& s) { s.mesh().uvs[0] = uvs; };
  };
  const auto mirrored = [](SurfaceTrace& s) {
    s.frame().draws[0].transform = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
  };
  const struct {
    const char* what;
    std::function<void(SurfaceTrace&)> change;
    glm::vec3 to_u, up;
  } cases[] = {{"as it is", [](SurfaceTrace&) {}, {1, 0, 0}, {0, 1, 0}},
               {"tangents of vertices", tangents({1, 0, 0, 1}), {1, 0, 0}, {0, 1, 0}},
               {"mirrored tangents", tangents({-1, 0, 0, -1}), {-1, 0, 0}, {0, 1, 0}},
               {"u runs to the left", coordinates({{1, 0}, {0, 0}, {0, 1}, {1, 1}}), {-1, 0, 0}, {0, 1, 0}},
               {"v runs up", coordinates({{0, 1}, {1, 1}, {1, 0}, {0, 0}}), {1, 0, 0}, {0, -1, 0}},
               {"u runs down and v to the left", coordinates({{0, 1}, {0, 0}, {1, 0}, {1, 1}}), {0, -1, 0}, {1, 0, 0}},
               // A mirror in space does what mirrored coordinates do.
               {"a mirrored draw", mirrored, {-1, 0, 0}, {0, 1, 0}},
               {"a mirrored draw with tangents",
                [&](SurfaceTrace& s) {
                  mirrored(s), tangents({1, 0, 0, 1})(s);
                },
                {-1, 0, 0},
                {0, 1, 0}},
               // The bumps of a back face are those of the front face, seen from behind: a groove stays where it is in
               // the image.
               {"a back face",
                [](SurfaceTrace& s) {
                  set_camera(s.frame(), {{0, 0, -5}, {0, 0, 0}, {0, 1, 0}, 30, 1, 10});
                },
                {1, 0, 0},
                {0, 1, 0}}};
  for (const auto& [what, change, to_u, up] : cases) {
    SCOPED_TRACE(what);
    expect_near(bumped(kToU, change), to_u, 0.012);
    expect_near(bumped(kUp, change), up, 0.012);
  }
}

TEST(SurfaceShader, AFlatNormalMapLeavesTheNormal) {
  expect_near(bumped(kFlat), {0, 0, 1}, 0.006);
  expect_near(bumped(kFlat, [](SurfaceTrace& s) { s.mesh().normals.assign(4, glm::normalize(glm::vec3(3, 0, 4))); }),
              {0.6f, 0, 0.8f}, 0.006);
  // Coordinates without area leave it too.
  expect_near(bumped(kFlat, [](SurfaceTrace& s) { s.mesh().uvs[0].assign(4, glm::vec2(0.25f, 0.75f)); }), {0, 0, 1},
              0.006);
}

TEST(SurfaceShader, ScaleOfNormalMaps) {
  // (255, 128, 255): 45 degrees towards u. Half the scale: 1/2 to 1.
  expect_near(bumped({255, 128, 255, 255}), glm::normalize(glm::vec3(1, 0, 1)), 0.006);
  expect_near(bumped({255, 128, 255, 255}, [](SurfaceTrace& s) { s.trace.materials[0].normal_scale = 0.5f; }),
              glm::normalize(glm::vec3(1, 0, 2)), 0.006);
}

// ---- Materials

TEST(SurfaceShader, VertexColorsAndTexturesMultiplyTheBaseColor) {
  SurfaceTrace scene = full_of(filled_image(4, 4, {255, 188, 0, 128}), AlphaMode::blend);
  scene.trace.materials[0].base_color = {0.5f, 0.25f, 1, 0.5f};
  scene.mesh().vertex_colors.assign(4, glm::vec4(0.25f, 1, 1, 0.5f));
  const ShadedScene shaded(scene.trace);
  const glm::vec4 found = shaded.shader.color_and_alpha(0, {5, 2});
  expect_near(found, {0.5 * 0.25, 0.25 * srgb_values()[188], 0}, 1e-6);
  EXPECT_NEAR(found.a, 0.5 * 0.5 * 128 / 255, 1e-6);
  EXPECT_NEAR(shaded.shader.alpha(0, {5, 2}, 1), found.a, 1e-6);
}

// Roughness and metallic of the texture: glTF has them in G and B.
TEST(SurfaceShader, MetallicRoughnessTexture) {
  SurfaceTrace textured = facing(white_metal()), plain = facing(white_metal());
  for (SurfaceTrace* scene : {&textured, &plain}) {
    scene->frame().lighting.ambient.reset();
    scene->frame().lighting.lights = {{glm::normalize(glm::vec3(0.2f, 0.1f, -1))}};
    scene->trace.materials[0].base_color = {0.5f, 0.25f, 1, 1};
  }
  Material& material = textured.trace.materials[0];
  material.metallic_roughness_texture = Texture{.image = textured.add_image(filled_image(2, 2, {255, 204, 51, 255}))};
  material.metallic = 0.5f, material.roughness = 0.5f;
  plain.trace.materials[0].metallic = 0.5f * 0.2f, plain.trace.materials[0].roughness = 0.5f * 0.8f;
  const ShadedScene a(textured.trace), b(plain.trace);
  expect_near(a.shader.color(0, {3, 5}), b.shader.color(0, {3, 5}), 1e-6);
}

// Base colour in 8 bits of sRGB, roughness in 8 bits, metallic in 2, normals in 10: the colour is close, and not equal.
TEST(SurfaceShader, AGBufferRounds) {
  SurfaceTrace scene = facing(white_metal());
  Material& material = scene.trace.materials[0];
  material.base_color = {0.3f, 0.6f, 0.9f, 1}, material.roughness = 0.6f;
  scene.frame().lighting.lights = {{glm::normalize(glm::vec3(0.3f, 0.4f, -1))}};
  scene.mesh().normals.assign(4, glm::normalize(glm::vec3(0.3f, 0.1f, 1)));
  const ShadedScene exact(scene.trace), stored(scene.trace, {.storage = MaterialStorage::gbuffer});
  const glm::vec3 a = exact.shader.color(0, {3, 4}), b = stored.shader.color(0, {3, 4});
  EXPECT_NE(a, b);
  expect_near(a, b, 0.02);
  // Without light only the base colour counts.
  material.unlit = true;
  scene.mesh().vertex_colors.assign(4, glm::vec4(1));  // so that it is not flat
  const ShadedScene unlit(scene.trace, {.storage = MaterialStorage::gbuffer});
  for (int c = 0; c < 3; ++c)
    EXPECT_EQ(unlit.shader.color(0, {3, 4})[c], srgb_values()[srgb_code(material.base_color[c])]);
}

TEST(SurfaceShader, ColorsAreRoundedToHalf) {
  const SurfaceTrace scene = full_of(filled_image(2, 2, {100, 200, 30, 255}));
  const ShadedScene exact(scene.trace), half(scene.trace, {.stored_as = AccumulatorFormat::fp16});
  const glm::vec3 a = exact.shader.color(0, {3, 4}), b = half.shader.color(0, {3, 4});
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(a[c], b[c], a[c] * 0x1p-11f);
    EXPECT_EQ(std::ldexp(b[c], 11 - std::ilogb(b[c])), std::round(std::ldexp(b[c], 11 - std::ilogb(b[c]))));
  }
}

// Materials with and without each of their parts, lit by two lights and from all around.
SurfaceTrace all_kinds_of_materials(Random& random) {
  SurfaceTrace scene(64, 64);
  const Texture texture{.image = scene.add_image(random_image(random, 16, 16))};
  const auto real = [&](float most) { return static_cast<float>(random.real(0, most)); };
  const auto vector = [&] { return glm::vec3(real(2) - 1, real(2) - 1, real(2) - 1); };
  constexpr int kParts = 9;
  for (unsigned parts = 0; parts < 1u << kParts; ++parts) {
    const auto has = [&](unsigned part) { return (parts >> part & 1) != 0; };
    Material material;
    material.base_color = {real(1), real(1), real(1), 1};
    material.metallic = real(1), material.roughness = real(1), material.emissive = glm::vec3(real(1));
    const auto in_a_set = [&] {
      Texture placed = texture;
      placed.uv_set = random.one_in(2);
      return placed;
    };
    if (has(0)) material.base_texture = in_a_set();
    if (has(1)) material.metallic_roughness_texture = in_a_set();
    if (has(2)) material.normal_texture = in_a_set();
    if (has(3)) material.emissive_texture = in_a_set();
    material.unlit = has(4);
    material.alpha_mode = has(5) ? AlphaMode::blend : AlphaMode::opaque;
    const double x = 2 * (parts % 32), y = 4 * (parts / 32);
    scene.add_rectangle(x, y, x + 2, y + 4, 0.5, material);
    for (const glm::vec2& uv : scene.mesh().uvs[0]) scene.mesh().uvs[1].push_back(0.5f * uv + 0.3f);
    if (has(6)) scene.mesh().vertex_colors.assign(4, {real(1), real(1), real(1), real(1)});
    if (has(7)) {
      scene.mesh().normals.assign(4, vector());
      if (has(8)) scene.mesh().tangents.assign(4, {vector(), 1});
    }
  }
  const auto direction = [&] { return glm::normalize(vector()); };
  scene.frame().lighting = {{{direction(), vector() + 1.0f}, {direction()}},
                            Ambient{vector() + 1.0f, vector() + 1.0f, direction()}};
  return scene;
}

TEST(SurfaceShader, SideBySideColorsAreTheSame) {
  Random random(2);
  const SurfaceTrace materials = all_kinds_of_materials(random);
  for (const ShadingRules& rules :
       {ShadingRules{}, ShadingRules{.derivatives = Derivatives::quad},
        ShadingRules{.stored_as = AccumulatorFormat::fp16}, ShadingRules{.storage = MaterialStorage::gbuffer},
        ShadingRules{.colors = SurfaceColors::by_pixel}, ShadingRules{.texture_taps = kAnisotropic},
        ShadingRules{.texture_taps = 4}, ShadingRules{.texture_taps = 16}}) {
    const ShadedScene scene(materials.trace, rules);
    // Runs of a few invocations of one triangle, at places that need not be in it, of areas of all sizes.
    std::vector<Invocation> invocations;
    for (std::uint64_t triangle = 0; invocations.size() < 20'000; triangle = random.word())
      for (std::uint64_t left = random.word() % 8; left > 0; --left)
        invocations.push_back(
            {static_cast<std::uint32_t>(triangle % scene.triangles.surfaces.size()),
             {static_cast<std::int32_t>(random.word() % 64), static_cast<std::int32_t>(random.word() % 64),
              static_cast<float>(random.real(0, 1)), static_cast<float>(random.real(0, 1))},
             {static_cast<float>(random.real(0, 1)), static_cast<float>(random.real(-0.5, 0.5)),
              static_cast<float>(random.real(0, 1))}});
    std::uint64_t texels = 0;
    for (const auto& [triangle, place, footprint] : invocations) {
      TexelRequests one(nullptr);
      scene.shader.add_texels(triangle, place, footprint, one);
      texels += one.texels();
    }
    on_every_target([&] {
      TexelRequests of_colors(nullptr), of_ranges(nullptr), counted(nullptr);
      const std::vector<glm::vec4> colors = scene.shader.colors_and_alphas(invocations, &of_colors);
      const std::vector<float> ranges = scene.shader.light_ranges(invocations, &of_ranges);
      scene.shader.count_texels(invocations, counted);
      EXPECT_EQ(of_colors.texels(), texels);
      EXPECT_EQ(counted.texels(), texels);
      ASSERT_EQ(colors.size(), invocations.size());
      ASSERT_EQ(ranges.size(), invocations.size());
      TexelRequests of_range(nullptr);
      for (std::size_t i = 0; i < colors.size(); ++i) {
        const auto& [triangle, place, footprint] = invocations[i];
        const glm::vec4 expected = scene.shader.color_and_alpha(triangle, place, footprint);
        for (int c = 0; c < 4; ++c)
          ASSERT_EQ(std::bit_cast<std::uint32_t>(colors[i][c]), std::bit_cast<std::uint32_t>(expected[c]))
              << i << ", triangle " << triangle << ": " << colors[i][c] << " and " << expected[c];
        const float range = scene.shader.light_range(triangle, place, footprint, &of_range);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(ranges[i]), std::bit_cast<std::uint32_t>(range)) << i;
      }
      EXPECT_EQ(of_ranges.texels(), of_range.texels());
    });
    EXPECT_TRUE(scene.shader.colors_and_alphas({}).empty());
    EXPECT_TRUE(scene.shader.light_ranges({}).empty());
  }
}

// ---- Costs

using Real = Counted<float>;

// Weights in perspective by hand: three planes of two products and two sums; a division; two products, which are
// limited by two comparisons each.
constexpr OperationCounts kWeights{.mul_add = 8, .add = 10, .special = 1};
// An attribute: two products; two differences and two sums.
constexpr OperationCounts kAttribute{.mul_add = 2, .add = 4};
// Slopes of the weights: a plane and a division; four times two products and a difference.
constexpr OperationCounts kWeightSlopes{.mul_add = 10, .add = 6, .special = 1};
// The slope of an attribute: two products, two differences, a sum.
constexpr OperationCounts kSlope{.mul_add = 2, .add = 3};

OperationCounts sum_of(const std::vector<std::pair<OperationCounts, int>>& parts) {
  OperationCounts sum;
  for (const auto& [counts, times] : parts) sum += counts * static_cast<std::uint64_t>(times);
  return sum;
}

TEST(SurfaceShaderCost, OfAnUnlitTexture) {
  const SurfaceTrace scene = full_of(filled_image(2, 2, {1, 2, 3, 255}));
  const ShadedScene analytic(scene.trace), quad(scene.trace, {.derivatives = Derivatives::quad});
  const OperationCounts texel{.mul_add = 4, .fetch = 1};
  EXPECT_EQ(analytic.shader.work(0).material,
            sum_of({{kWeights, 1}, {kWeightSlopes, 1}, {kAttribute, 2}, {kSlope, 4}, {texel, 1}}));
  EXPECT_EQ(quad.shader.work(0).material, sum_of({{kWeights, 1}, {kAttribute, 2}, {{.add = 1}, 4}, {texel, 1}}));
  EXPECT_EQ(analytic.shader.work(0).light, OperationCounts{});
  EXPECT_EQ(analytic.shader.work(0).input_bytes, kSurfaceBytes + 3 * 2 * 4);
}

// A rectangle whose normals turn by `turn` to each side, in front of a light beside the eye, which sees its back.
SurfaceTrace bent(float turn, const Material& material) {
  SurfaceTrace scene(16, 16);
  scene.add_rectangle(0, 0, 16, 16, 0.5, material);
  const glm::vec3 left(std::sin(turn), 0, std::cos(turn)), right(-std::sin(turn), 0, std::cos(turn));
  scene.mesh().normals = {left, right, right, left};
  scene.frame().lighting = {{{glm::normalize(glm::vec3(0.3f, 0.1f, 1))}}, std::nullopt};
  return scene;
}

// What colours at many points of a pixel differ by.
float spread(const ShadedScene& shaded, std::int32_t x, std::int32_t y, const Footprint& footprint) {
  float least = 1e30f, most = 0;
  for (int i = 0; i < 33; ++i)
    for (int j = 0; j < 33; ++j) {
      const ShadingPlace at{x, y, 0.5f + footprint.xx * (static_cast<float>(i) / 32 - 0.5f),
                            0.5f + footprint.yy * (static_cast<float>(j) / 32 - 0.5f)};
      const float red = shaded.shader.color(y > x ? 1 : 0, at).r;
      least = std::min(least, red), most = std::max(most, red);
    }
  return most - least;
}

// Of a metal, which has highlights alone, within a third: the visibility of microfacets and the cosine vary too.
TEST(SurfaceShader, LightVariesNoMoreThanItsRange) {
  for (const float turn : {0.2f, 0.8f})
    for (const float roughness : {0.1f, 0.3f, 0.6f, 1.0f}) {
      Material metal;
      metal.metallic = 1, metal.roughness = roughness;
      const ShadedScene shaded(bent(turn, metal).trace);
      double ranges = 0, spreads = 0;
      for (const float width : {1.0f, 0.25f})
        for (std::int32_t y = 0; y < 16; ++y)
          for (std::int32_t x = 0; x < 16; ++x) {
            if (x == y) continue;  // the triangles' border
            const float found = spread(shaded, x, y, width);
            const float range = shaded.shader.light_range(y > x ? 1 : 0, {x, y}, width);
            EXPECT_LE(found, 4 * range / 3 + 0.02f) << turn << ", " << roughness << ": " << x << ", " << y;
            ranges += range, spreads += found;
          }
      EXPECT_LT(ranges, 4 * spreads + 1) << turn << ", " << roughness;  // and not much less
    }
}

TEST(SurfaceShader, LightDoesNotVaryWhereNothingTurns) {
  Material metal;
  metal.metallic = 1, metal.roughness = 0.2f;
  EXPECT_EQ(ShadedScene(bent(0, metal).trace).shader.light_range(0, {8, 2}, 1.0f), 0.0f);
  EXPECT_EQ(ShadedScene(bent(0.5f, unlit_material(glm::vec4(1))).trace).shader.light_range(0, {8, 2}, 1.0f), 0.0f);
}

// A texture of normals turns them where the surface is plane; the more of its texels a pixel shows, the more.
TEST(SurfaceShader, LightVariesWithTexturesOfNormals) {
  Random random(9);
  TextureImage image{"normals", 64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i)
    image.texels.emplace_back(random.integer(96, 160), random.integer(96, 160), 250, 255);
  Material metal;
  metal.metallic = 1, metal.roughness = 0.5f;
  SurfaceTrace scene = bent(0, metal);
  scene.trace.materials[0].normal_texture = Texture{.image = scene.add_image(image)};
  double before = 0;
  for (const float repeats : {0.01f, 0.05f, 0.25f}) {
    SurfaceTrace scaled_scene = scene;
    for (glm::vec2& uv : scaled_scene.mesh().uvs[0]) uv *= repeats;
    const ShadedScene shaded(scaled_scene.trace);
    double sum = 0;
    for (std::int32_t x = 1; x < 16; ++x) {
      TexelRequests texels(nullptr);
      sum += shaded.shader.light_range(0, {x, 0}, 1.0f, &texels);
      EXPECT_EQ(texels.texels(), 4u);
    }
    EXPECT_GT(sum, 1.2 * before) << repeats;
    before = sum;
  }
}

TEST(SurfaceShaderCost, OfTheRangeOfLight) {
  const ShadedScene curved(bent(0.5f, Material{}).trace);
  const OperationCounts range = curved.shader.work(0).range, light = curved.shader.work(0).light;
  EXPECT_GT(range.total(), light.total());
  EXPECT_EQ(range.fetch, 0u);
  EXPECT_EQ(ShadedScene(bent(0.5f, unlit_material(glm::vec4(1))).trace).shader.work(0).range, OperationCounts{});
}

TEST(SurfaceShaderCost, OfLitVertices) {
  SurfaceTrace scene = facing(white_metal());
  scene.mesh().vertex_colors.assign(4, glm::vec4(0.5f));
  const ShadedScene shaded(scene.trace);
  // A unit vector: a dot product, a limit, a root, a division and three products.
  const OperationCounts unit{.mul_add = 6, .add = 3, .special = 2};
  EXPECT_EQ(shaded.shader.work(0).material,
            sum_of({{kWeights, 1}, {kAttribute, 4 + 3 + 3}, {{.mul_add = 4}, 1}, {unit, 2}, {{.mul_add = 3}, 1}}));
  EXPECT_EQ(shaded.shader.work(0).input_bytes, kSurfaceBytes + 3 * (4 + 3 + 3) * 4);
}

TEST(SurfaceShaderCost, ASecondTextureOfTheSameSetSharesThePlace) {
  SurfaceTrace scene(8, 8);
  const Texture texture{.image = scene.add_image(filled_image(2, 2, {1, 2, 3, 255}))};
  Material material;
  material.base_texture = texture;
  scene.add_rectangle(0, 0, 8, 8, 0.5, material);
  const ShadedScene one(scene.trace);
  scene.trace.materials[0].metallic_roughness_texture = texture;
  const ShadedScene two(scene.trace);
  OperationCounts more = one.shader.work(0).material;
  more += OperationCounts{.mul_add = 2, .fetch = 1};
  EXPECT_EQ(two.shader.work(0).material, more);
  EXPECT_EQ(two.shader.work(0).input_bytes, one.shader.work(0).input_bytes);
}

// Counting numbers run the formulas of light: the counts are those of a run that shades.
TEST(SurfaceShaderCost, OfLight) {
  SurfaceTrace scene = facing(white_metal());
  scene.frame().lighting = {{{glm::vec3(0, 0, -1)}, {glm::vec3(0, -1, 0)}}, Ambient{}};
  scene.trace.materials[0].emissive = glm::vec3(1);
  const ShadedScene shaded(scene.trace);
  OperationCounts counted;
  const Triple<Real> vector{Real(0.5f, counted), Real(0.25f, counted), Real(0.75f, counted)};
  lit_color(scene.trace.materials[0],
            SurfaceMaterial<Real>{{vector, vector[0], vector[1], vector, vector}, vector, vector[0]},
            scene.frame().lighting);
  EXPECT_EQ(shaded.shader.work(0).light, counted);
  EXPECT_GT(counted.total(), 100u);
}

TEST(SurfaceShaderCost, FlatTrianglesCostWhatTheyDid) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 8, 8, 0.5, unlit_material(glm::vec4(1)));
  scene.add_rectangle(0, 0, 8, 8, 0.5, textured_material(scene.add_image(filled_image(2, 2, {1, 2, 3, 255}))));
  const ShadedScene shaded(scene.trace);
  EXPECT_TRUE(shaded.shader.is_flat(0));
  EXPECT_FALSE(shaded.shader.is_flat(2));
  EXPECT_EQ(shaded.shader.work(0).material, OperationCounts{});
  EXPECT_EQ(shaded.shader.work(0).light, OperationCounts{});
  EXPECT_EQ(shaded.shader.work(0).input_bytes, sizeof(FlatAttributes));
}

}  // namespace beampipe::surface_shader_test

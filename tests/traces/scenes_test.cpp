#include "traces/scenes.h"

#include "tests/traces/difference.h"
#include "tests/traces/scene_names.h"
#include "tests/traces/test_folder.h"

namespace beampipe::scenes_test {

std::size_t count(const Trace& trace) {
  std::size_t sum = 0;
  for (const Draw& draw : trace.frames[0].draws) sum += trace.meshes[draw.mesh].triangles.size();
  return sum;
}

// What is known of a scene: its triangles by default, and its closed meshes.
struct Known {
  double triangles;
  std::set<std::string> closed;
};
const std::map<std::string_view, Known> kKnown = {{"hairball", {150e3, {"ball", "hair"}}},
                                                  {"classroom", {100e3, {"fittings", "desks", "strings"}}},
                                                  {"boat", {60e3, {"deckhouses", "spars", "rigging", "ropes"}}},
                                                  {"pickets", {5e3, {"pickets"}}},
                                                  {"terrain", {150e3, {}}},
                                                  {"sphere", {100e3, {"sphere", "small spheres"}}},
                                                  {"fence", {60e3, {"backdrop", "fences"}}},
                                                  {"soup", {20e3, {}}},
                                                  {"foliage", {80e3, {"wood"}}},
                                                  {"bars", {4e3, {"bars"}}},
                                                  {"density", {5760, {}}},
                                                  {"stack", {64, {}}},
                                                  {"room", {40e3, {"fittings", "desks", "strings"}}},
                                                  {"rigging", {40e3, {"deckhouses", "spars", "rigging", "ropes"}}},
                                                  {"leaves", {12e3, {"stems"}}},
                                                  {"bumps", {10e3, {"ball", "left ball", "right ball"}}},
                                                  {"sheets", {2e3, {}}},
                                                  {"tiles", {74, {"boxes"}}},
                                                  {"shrubs", {60e3, {"stems"}}},
                                                  {"library", {60e3, {"wood", "books", "lamps"}}},
                                                  {"scaffold", {50e3, {"bars", "planks", "net"}}},
                                                  {"cables", {40e3, {"houses", "poles", "cables"}}},
                                                  {"crowd", {80e3, {"houses", "people"}}},
                                                  {"stairs", {20e3, {"steps", "frames", "rail"}}},
                                                  {"study", {20e3, {"wood", "books"}}}};

class ScenesTest : public FolderTest, public testing::WithParamInterface<SceneKind> {
 protected:
  Trace make(const SceneOptions& options) const { return make_scene(GetParam().name, options); }
  std::string bytes(const SceneOptions& options) const {
    write_trace(make(options), path("trace.json"));
    return read("trace.json");
  }
};

TEST_P(ScenesTest, DependsOnTheSeedOnly) {
  const std::string first = bytes({.triangles = 2000, .seed = 5});
  EXPECT_EQ(first, bytes({.triangles = 2000, .seed = 5}));
  EXPECT_NE(first, bytes({.triangles = 2000, .seed = 6}));
}

TEST_P(ScenesTest, ReadsBackToTheSameBits) {
  const Trace trace = make({.triangles = 3000});
  write_trace(trace, path("trace.json"));
  EXPECT_EQ(difference(trace, read_trace(path("trace.json"))), "");
}

TEST_P(ScenesTest, KeepsToItsTriangles) {
  for (const std::uint32_t wanted : {1000u, 3000u, 30000u, 250000u}) {
    const double made = static_cast<double>(count(make({.triangles = wanted})));
    EXPECT_NEAR(made / wanted, 1, 0.25) << wanted;
  }
}

TEST_P(ScenesTest, HasADefaultSize) {
  const double wanted = kKnown.at(GetParam().name).triangles;
  EXPECT_NEAR(static_cast<double>(count(make({}))) / wanted, 1, 0.25);
}

TEST_P(ScenesTest, TheCameraDoesNotDependOnTheTriangles) {
  const Frame few = make({.triangles = 1000}).frames[0], many = make({.triangles = 20000, .seed = 9}).frames[0];
  EXPECT_EQ(few.view, many.view);
  EXPECT_EQ(few.projection, many.projection);
  EXPECT_EQ(few.lighting.lights[0].direction, many.lighting.lights[0].direction);
}

TEST_P(ScenesTest, HasSoundMeshes) {
  const Trace trace = make({.triangles = 20000});
  for (const Mesh& mesh : trace.meshes) {
    ASSERT_EQ(mesh.colors.size(), mesh.triangles.size()) << mesh.name;
    for (const glm::vec3& p : mesh.positions) {
      ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << mesh.name;
    }
    for (const glm::uvec3& t : mesh.triangles) {
      ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.positions.size()) << mesh.name;
      ASSERT_TRUE(t.x != t.y && t.y != t.z && t.z != t.x) << mesh.name;
    }
    for (const glm::vec3& c : mesh.colors) {
      for (int i = 0; i < 3; ++i) ASSERT_TRUE(c[i] >= 0 && c[i] <= 2) << mesh.name;
    }
  }
}

TEST_P(ScenesTest, IsInThePictureAndLit) {
  const Trace trace = make({});
  const Frame& frame = trace.frames[0];
  EXPECT_EQ(frame.width, 320u);
  EXPECT_EQ(frame.height, 180u);
  ASSERT_EQ(frame.lighting.lights.size(), 1u);
  EXPECT_NEAR(glm::length(frame.lighting.lights[0].direction), 1, 1e-6);
  std::size_t inside = 0, lit = 0, all = 0;
  double left = 1, right = -1, bottom = 1, top = -1;  // of what is inside
  for (const Draw& draw : frame.draws) {
    const Mesh& mesh = trace.meshes[draw.mesh];
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
      const glm::dvec4 p = frame.projection * frame.view * glm::dvec4((a + b + c) / 3.0, 1);
      ++all;
      if (!(std::abs(p.x) <= p.w && std::abs(p.y) <= p.w && std::abs(p.z) <= p.w)) continue;
      ++inside;
      left = std::min(left, p.x / p.w);
      right = std::max(right, p.x / p.w);
      bottom = std::min(bottom, p.y / p.w);
      top = std::max(top, p.y / p.w);
      glm::dvec3 normal = glm::cross(b - a, c - a);
      if (glm::dot(normal, frame.camera->eye - a) < 0) normal = -normal;
      lit += glm::dot(normal, glm::dvec3(frame.lighting.lights[0].direction)) < 0;
    }
  }
  EXPECT_GT(inside, all / 2);
  EXPECT_GT(lit, inside / 2);
  EXPECT_GT(right - left, 0.9);
  EXPECT_GT(top - bottom, 0.9);
}

INSTANTIATE_TEST_SUITE_P(All, ScenesTest, testing::ValuesIn(scene_kinds()),
                         [](const auto& scene) { return std::string(scene.param.name); });

class MaterialScenesTest : public ScenesTest {};

TEST_P(MaterialScenesTest, HaveMaterialsOnEveryTriangleAndUseEachOne) {
  const Trace trace = make({});
  std::set<std::uint32_t> materials, images;
  for (const Mesh& mesh : trace.meshes) {
    ASSERT_EQ(mesh.materials.size(), mesh.triangles.size()) << mesh.name;
    for (const std::uint32_t material : mesh.materials) {
      ASSERT_LT(material, trace.materials.size()) << mesh.name;
      materials.insert(material);
    }
  }
  EXPECT_EQ(materials.size(), trace.materials.size());
  for (const Material& material : trace.materials) {
    for (const TextureSlot& slot : kTextureSlots)
      if (const auto& texture = material.*slot.texture) images.insert(texture->image);
  }
  EXPECT_EQ(images.size(), trace.images.size());
  EXPECT_GE(images.size(), 2u);
}

TEST_P(MaterialScenesTest, HaveUnitNormalsThatAgreeWithTheirTriangles) {
  const Trace trace = make({.triangles = 20000});
  std::size_t all = 0, agree = 0;
  for (const Mesh& mesh : trace.meshes) {
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
    for (const glm::vec3& normal : mesh.normals) ASSERT_NEAR(glm::length(glm::dvec3(normal)), 1, 1e-6) << mesh.name;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a = mesh.positions[t.x];
      const glm::dvec3 normal = glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
      for (int corner = 0; corner < 3; ++corner, ++all)
        agree += glm::dot(normal, glm::dvec3(mesh.normals[t[corner]])) > 0;
    }
  }
  EXPECT_GT(static_cast<double>(agree), 0.999 * static_cast<double>(all));
}

// A texture stands upright and is not mirrored where its triangle is seen from outside: with v downwards, the triangle
// is clockwise in the image's own axes.
TEST_P(MaterialScenesTest, HaveTextureCoordinatesWhereTheyHaveTextures) {
  const Trace trace = make({.triangles = 20000});
  for (const Mesh& mesh : trace.meshes) {
    bool textured = false;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Material& material = trace.materials[mesh.materials[i]];
      if (std::ranges::none_of(kTextureSlots, [&](const TextureSlot& slot) { return bool(material.*slot.texture); })) {
        continue;
      }
      textured = true;
      ASSERT_EQ(mesh.uvs[0].size(), mesh.positions.size()) << mesh.name;
      const glm::uvec3& t = mesh.triangles[i];
      const glm::dvec2 a = mesh.uvs[0][t.x], right = glm::dvec2(mesh.uvs[0][t.y]) - a,
                       up = glm::dvec2(mesh.uvs[0][t.z]) - a;
      ASSERT_LE(right.x * up.y - right.y * up.x, 0) << mesh.name << " " << i;
      for (int corner = 0; corner < 3; ++corner) {
        const glm::vec2& uv = mesh.uvs[0][t[corner]];
        ASSERT_TRUE(std::abs(uv.x) < 2000 && std::abs(uv.y) < 2000) << mesh.name;
      }
    }
    EXPECT_EQ(textured, !mesh.uvs[0].empty()) << mesh.name;
  }
}

TEST_P(MaterialScenesTest, AreFilesOfModerateSize) {
  EXPECT_LT(bytes({}).size(), 5'000'000u);
  for (const TextureImage& image : make({}).images) EXPECT_LE(std::max(image.width, image.height), 1024u) << image.name;
}

TEST_P(MaterialScenesTest, AreLitFromEverywhere) {
  const Lighting lighting = make({}).frames[0].lighting;
  EXPECT_EQ(lighting.lights.size(), 1u);
  ASSERT_TRUE(lighting.ambient.has_value());
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_GT(lighting.ambient->sky[channel], 0.05);
    EXPECT_GT(lighting.ambient->ground[channel], 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(All, MaterialScenesTest, testing::ValuesIn(material_scenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

// The same meshes in both, apart from vertices that only texture coordinates and normals need.
TEST(Scenes, ScenesWithMaterialsShareTheShapesOfFlatOnes) {
  for (const auto& [plain, textured] : {std::pair{"classroom", "room"}, {"boat", "rigging"}}) {
    const Trace a = make_scene(plain, {.triangles = 20000}), b = make_scene(textured, {.triangles = 20000});
    EXPECT_EQ(a.frames[0].view, b.frames[0].view);
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    for (std::size_t i = 0; i < a.meshes.size(); ++i) {
      const Mesh &flat = a.meshes[i], &with_materials = b.meshes[i];
      EXPECT_TRUE(flat.materials.empty() && flat.normals.empty() && flat.uvs[0].empty());
      ASSERT_EQ(flat.triangles.size(), with_materials.triangles.size()) << flat.name;
      for (std::size_t k = 0; k < flat.triangles.size(); ++k) {
        std::set<std::array<float, 3>> corners, others;
        for (int corner = 0; corner < 3; ++corner) {
          const glm::vec3 p = flat.positions[flat.triangles[k][corner]],
                          q = with_materials.positions[with_materials.triangles[k][corner]];
          corners.insert({p.x, p.y, p.z});
          others.insert({q.x, q.y, q.z});
        }
        if (flat.name == "room") continue;  // the parquet's squares are halved along the other diagonal
        ASSERT_EQ(corners, others) << flat.name << " " << k;
      }
    }
  }
}

TEST(Scenes, SheetsAreNotDrawnFromBackToFront) {
  const Trace trace = make_scene("sheets", {});
  const Frame& frame = trace.frames[0];
  std::vector<double> depths;  // of the sheets' middles
  for (const Draw& draw : frame.draws) {
    const Mesh& mesh = trace.meshes[draw.mesh];
    const bool is_sheet = trace.materials[mesh.materials[0]].alpha_mode == AlphaMode::blend;
    EXPECT_EQ(is_sheet, mesh.name != "wall");
    if (!is_sheet) continue;
    glm::dvec3 sum(0.0);
    for (const glm::vec3& p : mesh.positions) sum += p;
    depths.push_back((frame.view * glm::dvec4(sum / static_cast<double>(mesh.positions.size()), 1)).z);
  }
  EXPECT_EQ(depths.size(), 9u);
  EXPECT_FALSE(std::ranges::is_sorted(depths));
  EXPECT_FALSE(std::ranges::is_sorted(depths, std::greater<>()));
}

TEST(Scenes, LeavesAreCutOutOfCards) {
  const Trace trace = make_scene("leaves", {});
  std::size_t cards = 0;
  for (const Mesh& mesh : trace.meshes) {
    for (const std::uint32_t material : mesh.materials) {
      const Material& made_of = trace.materials[material];
      cards += made_of.alpha_mode == AlphaMode::mask && made_of.double_sided;
    }
  }
  EXPECT_GT(cards / 2, 4000u);
  std::size_t clear = 0, covered = 0;
  for (const glm::u8vec4& texel : trace.images[0].texels) (texel.a < 128 ? clear : covered) += 1;
  EXPECT_GT(clear, trace.images[0].texels.size() / 3);
  EXPECT_GT(covered, trace.images[0].texels.size() / 4);
}

// The FNV-1a hash of all texels: they have the same bits on every machine.
TEST(Scenes, TexelsAreTheSameEverywhere) {
  std::map<std::string_view, std::uint64_t> hashes;
  for (const SceneKind& kind : material_scenes()) {
    std::uint64_t& hash = hashes[kind.name] = 0xcbf29ce484222325u;
    for (const TextureImage& image : kind.make({}).images)
      for (const glm::u8vec4& texel : image.texels)
        for (int channel = 0; channel < 4; ++channel) hash = (hash ^ texel[channel]) * 0x100000001b3u;
  }
  const std::map<std::string_view, std::uint64_t> expected = {
      {"room", 0x27b7ad02ec6643b2u},   {"rigging", 0xd9eb475cadf09b3u}, {"leaves", 0x4f93e31ee083af0cu},
      {"bumps", 0xbc474f6dcec898dfu},  {"sheets", 0xa3d6789ef7e40643u}, {"tiles", 0x8e07f6933680af65u},
      {"stairs", 0x104397802d0b1749u}, {"study", 0xd67889639ba5eb07u}};
  EXPECT_EQ(hashes, expected);
}

TEST(Scenes, DensityFillsThePictureWithItsPixelsPerTriangle) {
  const Trace trace = make_scene("density", {.triangles = 640, .width = 160, .height = 40});
  const Frame& frame = trace.frames[0];
  double left = 0, right = 0, area = 0;
  const Mesh& wall = trace.meshes[0];
  const auto pixel = [&](std::uint32_t i) {
    const glm::dvec4 p = frame.projection * frame.view * glm::dvec4(wall.positions[i], 1.0);
    return glm::dvec2((p.x / p.w + 1) * 80, (p.y / p.w + 1) * 20);
  };
  for (const glm::uvec3& t : wall.triangles) {
    const glm::dvec2 a = pixel(t.x), b = pixel(t.y), c = pixel(t.z);
    area += 0.5 * ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
    left = std::min({left, a.x, b.x, c.x}), right = std::max({right, a.x, b.x, c.x});
  }
  EXPECT_NEAR(area, 160 * 40, 1);
  EXPECT_NEAR(left, 0, 1e-3);
  EXPECT_NEAR(right, 160, 1e-3);
}

TEST(Scenes, AnOrbitKeepsTheDistanceAndTheFirstFrame) {
  Trace trace = make_scene("bars", {});
  const Frame first = trace.frames[0];
  orbit_camera(trace, 5, 90);
  ASSERT_EQ(trace.frames.size(), 5u);
  EXPECT_EQ(trace.frames[0].view, first.view);
  for (const Frame& frame : trace.frames)
    EXPECT_NEAR(glm::length(frame.camera->eye - frame.camera->target), glm::length(first.camera->eye), 1e-12);
  const glm::dvec3 eye = trace.frames[4].camera->eye;  // from +z, counter-clockwise about y
  EXPECT_NEAR(eye.x, first.camera->eye.z, 1e-12);
  EXPECT_NEAR(eye.z, 0, 1e-12);
  Trace bare;
  EXPECT_THROW(orbit_camera(bare, 5, 90), std::invalid_argument);
}

std::string refusal(std::string_view name, const SceneOptions& options) {
  return message_of<std::invalid_argument>([&] { make_scene(name, options); });
}

TEST(Scenes, RefusesWhatItCannotMake) {
  EXPECT_EQ(
      refusal("ball", {}),
      "expected one of the scenes hairball, classroom, boat, pickets, terrain, sphere, fence, soup, foliage, bars, "
      "density, stack, room, rigging, leaves, bumps, sheets, tiles, shrubs, library, scaffold, cables, crowd, stairs, "
      "study, found "
      "\"ball\"");
  EXPECT_EQ(refusal("soup", {.triangles = 100000001}), "expected at most 100000000 triangles, found 100000001");
  EXPECT_EQ(refusal("soup", {.width = 0}), "expected a width and height of 1..16384, found 0 x 180");
  EXPECT_EQ(refusal("soup", {.height = 20000}), "expected a width and height of 1..16384, found 320 x 20000");
}

// The enclosed volume; positive if triangles are counter-clockwise from outside.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    sum += glm::dot(glm::dvec3(mesh.positions[t.x]),
                    glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z]))) /
           6;
  }
  return sum;
}

TEST(Scenes, DoNotDrawTheBackFacesOfClosedMeshes) {
  for (const SceneKind& kind : scene_kinds()) {
    for (const std::uint32_t triangles : {0u, 1500u}) {
      const Trace trace = make_scene(kind.name, {.triangles = triangles});
      std::set<std::string> culled;
      for (const Draw& draw : trace.frames[0].draws) {
        if (draw.cull == Cull::none) continue;
        EXPECT_EQ(draw.cull, Cull::back);
        const Mesh& mesh = trace.meshes[draw.mesh];
        culled.insert(mesh.name);
        EXPECT_GT(volume(mesh), 0) << kind.name << " " << mesh.name;
      }
      EXPECT_EQ(culled, kKnown.at(kind.name).closed) << kind.name << " " << triangles;
    }
  }
}

}  // namespace beampipe::scenes_test

// The reference in the API's order, by hand.
#include "stages/raster/ordered_reference.h"

#include "tests/stages/screen_triangles.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::ordered_reference_test {

constexpr Tile kPixel{0, 0, 1, 1};
constexpr Blend kAdd{{BlendFactor::one, BlendFactor::one}, {}, {}};

// Each draw has one triangle, the last that was added.
struct Stream {
  Trace trace;
  Frame frame;
  SetupTriangles triangles;

  Stream() { trace.meshes.emplace_back().triangles = {{0, 1, 2}}; }

  DrawState& add(const glm::vec3& color) {
    triangles.draws.push_back(static_cast<std::uint32_t>(triangles.draws.size()));
    triangles.attributes.back().kd = color;
    return frame.draws.emplace_back().state;
  }
  glm::vec4 picture() const {
    const SurfaceShader surfaces(triangles, trace, frame, nullptr, {});
    const TileShader shader(surfaces, kPixel);
    const glm::vec3 clear(0.0f, 0.0f, 0.25f);
    const RopRules rules(trace, frame, clear);
    ReferenceTile samples(kPixel);
    StageCounters counters;
    ordered_reference({triangles, all_of(triangles), kPixel}, rules, shader, counters, samples);
    return resolve(samples, kPixel, shader, clear, counters).at(0);
  }
};

// 72/256 px are four and a half columns of samples: 4.5/16 of all.
TEST(OrderedReference, SamplesOfACellHaveColorsOfTheirOwn) {
  Stream stream;
  add_triangle(stream.triangles, everywhere(-0.5f)), stream.add({1, 0, 0});
  add_triangle(stream.triangles, everywhere(-0.75f)), stream.add({0, 0, 0.25f}).blend = kAdd;
  add_triangle(stream.triangles, left_of(72, -0.75f)), stream.add({0, 0.5f, 0}).blend = kAdd;
  add_triangle(stream.triangles, everywhere(-0.75f)), stream.add({0, 0, 0.5f}).blend = kAdd;
  for (Draw& draw : stream.frame.draws) draw.state.depth.function = Compare::less_equal;
  const glm::vec4 found = stream.picture();
  EXPECT_FLOAT_EQ(found.r, 1);
  EXPECT_FLOAT_EQ(found.g, 0.5f * 4.5f / 16);
  EXPECT_FLOAT_EQ(found.b, 0.75f);
}

// A draw that only marks depth leaves the colour to the next one, and what it failed at has that of the clear.
TEST(OrderedReference, DrawsWithoutColorOnlyMark) {
  Stream stream;
  add_triangle(stream.triangles, left_of(64, -0.75f)), stream.add({1, 0, 0}).color_mask = 0;
  add_triangle(stream.triangles, everywhere(-0.5f)), stream.add({0, 1, 0}).blend = kAdd;
  add_triangle(stream.triangles, everywhere(-0.875f)), stream.add({0.5f, 0, 0}).blend = kAdd;
  const glm::vec4 found = stream.picture();
  EXPECT_FLOAT_EQ(found.r, 0.5f);
  EXPECT_FLOAT_EQ(found.g, 0.75f);
  EXPECT_FLOAT_EQ(found.b, 0.25f);
}

// The left half is in front of the second draw, which marks it with 1 and the rest with 2.
TEST(OrderedReference, StencilTellsSamplesThatFailFromThoseThatPass) {
  Stream stream;
  add_triangle(stream.triangles, left_of(128, -0.75f)), stream.add({1, 0, 0});
  add_triangle(stream.triangles, everywhere(-0.5f));
  stream.add({0, 0, 0}).stencil = Stencil{.function = Compare::always,
                                          .reference = 2,
                                          .depth_fail = StencilOperation::increment,
                                          .pass = StencilOperation::replace};
  for (const std::uint32_t mark : {1u, 2u}) {
    add_triangle(stream.triangles, everywhere(-0.875f));
    DrawState& state = stream.add(mark == 1 ? glm::vec3(0, 0.25f, 0) : glm::vec3(0, 0, 0.5f));
    state.depth.test = false, state.blend = kAdd;
    state.stencil = Stencil{.function = Compare::equal, .reference = mark};
  }
  const glm::vec4 found = stream.picture();
  EXPECT_FLOAT_EQ(found.r, 0.5f);
  EXPECT_FLOAT_EQ(found.g, 0.125f);
  EXPECT_FLOAT_EQ(found.b, 0.25f);
}

TEST(OrderedReference, DepthsAreLimited) {
  Stream stream;
  add_triangle(stream.triangles, everywhere(-1.5f)), stream.add({1, 0, 0});
  add_triangle(stream.triangles, everywhere(-1.25f)), stream.add({0, 1, 0}).depth.function = Compare::equal;
  EXPECT_FLOAT_EQ(stream.picture().g, 1) << "both are at the near plane";
}

// Red grows from the upper side to the lower one, green from the left to the right one.
TEST(OrderedReference, BlendedSurfacesAreShadedInEachCell) {
  SurfaceTrace scene(2, 2);
  const std::uint32_t down = scene.add_image({"down", 1, 2, {{0, 0, 0, 255}, {255, 0, 0, 255}}}),
                      across = scene.add_image({"across", 2, 1, {{0, 0, 0, 255}, {0, 255, 0, 255}}});
  scene.add_rectangle(0, 0, 2, 2, 0.5, textured_material(down));
  scene.mesh().uvs[0] = {{0, 0.25f}, {1, 0.25f}, {1, 0.75f}, {0, 0.75f}};
  scene.add_rectangle(0, 0, 2, 2, 0.25, textured_material(across));
  scene.mesh().uvs[0] = {{0.25f, 0}, {0.75f, 0}, {0.75f, 1}, {0.25f, 1}};
  const ShadedScene shaded(scene.trace);
  for (Draw& draw : scene.frame().draws) draw.state.blend = kAdd, draw.state.depth.test = false;
  const Tile tile = shaded.frame_tile();
  const TileShader shader(shaded.shader, tile);
  const RopRules rules(scene.trace, scene.frame(), glm::vec3(0.0f));
  ReferenceTile samples(tile);
  StageCounters counters;
  ordered_reference({shaded.triangles, all_of(shaded.triangles), tile}, rules, shader, counters, samples);
  const std::vector<glm::vec4> found = resolve(samples, tile, shader, glm::vec3(0.0f), counters);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found[i].r, i < 2 ? 0.25 : 0.75, 1e-6) << i;
    EXPECT_NEAR(found[i].g, i % 2 == 0 ? 0.25 : 0.75, 1e-6) << i;
  }
}

}  // namespace beampipe::ordered_reference_test

// Where texels lie in the modelled memory, and which of them a request asks for.
#include "stages/surface/texel_requests.h"

#include "tests/test.h"

namespace beampipe::texel_requests_test {

constexpr ColorSpace kLinear = ColorSpace::linear, kSrgb = ColorSpace::srgb;

// Two images: 16 x 8 texels, read in both colour spaces, and 9 x 5 texels, read as sRGB alone.
TextureSet two_images() {
  Trace trace;
  for (const glm::uvec2& size : {glm::uvec2(16, 8), {9, 5}})
    trace.images.push_back({"image", size.x, size.y, std::vector<glm::u8vec4>(std::size_t{size.x} * size.y)});
  trace.materials.resize(2);
  trace.materials[0].base_texture = Texture{.image = 0};
  trace.materials[0].normal_texture = Texture{.image = 0};
  trace.materials[1].base_texture = Texture{.image = 1};
  return TextureSet(trace);
}

std::vector<std::vector<std::uint64_t>> requests_of(const TexelRequests& texels) {
  std::vector<std::vector<std::uint64_t>> requests;
  texels.for_each(
      [&](std::span<const std::uint64_t> sectors) { requests.emplace_back(sectors.begin(), sectors.end()); });
  return requests;
}

// A sector has 4 x 2 texels and a line 2 x 2 sectors. The linear image takes 4 + 1 + 1 + 1 + 1 = 8 lines.
TEST(TextureLayout, TexelsLieInSectorsAndLines) {
  const TextureSet textures = two_images();
  const TextureLayout layout(textures);
  struct Place {
    TexelRead texel;
    std::uint64_t line, sector;
  };
  for (const Place& place : {Place{{0, kLinear, 0, 0, 0}, 0, 0},
                             {{0, kLinear, 0, 3, 1}, 0, 0},
                             {{0, kLinear, 0, 4, 1}, 0, 1},
                             {{0, kLinear, 0, 3, 2}, 0, 2},
                             {{0, kLinear, 0, 7, 3}, 0, 3},
                             {{0, kLinear, 0, 8, 0}, 1, 0},
                             {{0, kLinear, 0, 0, 4}, 2, 0},
                             {{0, kLinear, 0, 15, 7}, 3, 3},
                             {{0, kLinear, 1, 0, 0}, 4, 0},
                             {{0, kLinear, 1, 7, 3}, 4, 3},
                             {{0, kLinear, 4, 0, 0}, 7, 0},
                             {{0, kSrgb, 0, 0, 0}, 8, 0},
                             {{1, kSrgb, 0, 0, 0}, 16, 0},
                             {{1, kSrgb, 0, 8, 4}, 19, 0},
                             {{1, kSrgb, 1, 3, 1}, 20, 0}})
    EXPECT_EQ(layout.sector_of(place.texel), place.line * 4 + place.sector)
        << "image " << place.texel.image << ", level " << place.texel.level << ": " << place.texel.x << ", "
        << place.texel.y;
}

// Shares lie behind all images, with levels of the same sizes; two materials with the same test share them.
TEST(TextureLayout, SharesOfAlphaTestsLieBehindTheImages) {
  Trace trace;
  trace.images.push_back({"image", 16, 8, std::vector<glm::u8vec4>(16 * 8)});
  trace.materials.resize(3);
  for (Material& material : trace.materials)
    material.base_texture = Texture{.image = 0}, material.alpha_mode = AlphaMode::mask;
  trace.materials[1].alpha_cutoff = 0.75f;
  const TextureSet textures(trace);
  const TextureLayout layout(textures);
  const auto line = [&](std::uint32_t material, std::uint32_t level) {
    return layout.sector_of({0, kLinear, level, 0, 0, textures.alpha_test(material)}) / 4;
  };
  EXPECT_EQ(layout.sector_of({0, kSrgb, 4, 0, 0}), 7u * 4);
  EXPECT_EQ(line(0, 0), 8u);
  EXPECT_EQ(line(0, 1), 12u);
  EXPECT_EQ(line(1, 0), 16u);
  EXPECT_EQ(line(2, 0), 8u);
}

// Behind the 23 lines of the materials' images: a cube of one-byte texels with faces of 40 x 8 and 20 x 4, and a volume
// of 8-byte texels, 5 x 5 x 2 and 2 x 2 x 1.
TEST(TextureLayout, ImagesOfProgramsHaveSlicesAndTexelsOfAnySize) {
  std::vector<ProgramImage> images(2);
  images[0].format = TexelFormat::R8_UNORM, images[0].width = 40, images[0].height = 8, images[0].layers = 6;
  images[0].levels = 2;
  images[1].shape = ImageShape::d3, images[1].format = TexelFormat::R16G16B16A16_SFLOAT;
  images[1].width = 5, images[1].height = 5, images[1].depth = 2, images[1].levels = 2;
  const TextureSet textures = two_images();
  const TextureLayout layout(textures, images);
  struct Place {
    ProgramTexelRead texel;
    std::uint64_t line, sector;
  };
  for (const Place& place : {Place{{0, 0, 0, 0, 0}, 0, 0},
                             {{0, 0, 0, 15, 1}, 0, 0},
                             {{0, 0, 0, 16, 2}, 0, 3},
                             {{0, 0, 0, 39, 7}, 3, 2},  // two lines a row of lines, two rows
                             {{0, 0, 5, 0, 0}, 20, 0},  // of four lines a face
                             {{0, 1, 1, 0, 0}, 25, 0},  // of one
                             {{1, 0, 0, 0, 0}, 30, 0},
                             {{1, 0, 0, 3, 0}, 30, 1},
                             {{1, 0, 0, 4, 0}, 31, 0},
                             {{1, 0, 1, 4, 4}, 37, 0},  // of 2 x 2 lines a slice
                             {{1, 1, 0, 1, 1}, 38, 0}})
    EXPECT_EQ(layout.sector_of(place.texel), (23 + place.line) * 4 + place.sector)
        << "image " << place.texel.image << ", level " << place.texel.level << ": " << place.texel.x << ", "
        << place.texel.y;
  EXPECT_EQ(layout.bytes(), (23u + 39) * 128);
}

TEST(TexelRequests, ARequestAsksForEachSectorOnce) {
  const TextureSet textures = two_images();
  const TextureLayout layout(textures);
  TexelRequests texels(&layout);
  texels.end_request();  // an empty request is none
  for (const std::uint32_t x : {4u, 3u, 5u, 0u}) texels.read({0, kLinear, 0, x, 0});
  texels.end_request();
  texels.read({0, kLinear, 0, 1, 1});
  texels.end_request();
  EXPECT_EQ(texels.texels(), 5u);
  EXPECT_EQ(requests_of(texels), (std::vector<std::vector<std::uint64_t>>{{0, 1}, {0}}));
  texels.clear();
  EXPECT_EQ(texels.texels(), 0u);
  EXPECT_TRUE(requests_of(texels).empty());
}

TEST(TexelRequests, WithoutALayoutTexelsAreCounted) {
  TexelRequests texels(nullptr);
  texels.read({0, kLinear, 0, 1, 1});
  texels.read({0, kLinear, 0, 1, 1});
  texels.end_request();
  EXPECT_EQ(texels.texels(), 2u);
  EXPECT_TRUE(requests_of(texels).empty());
}

}  // namespace beampipe::texel_requests_test

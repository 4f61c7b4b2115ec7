// How programs' shaders read images, against numbers worked out by hand from the Vulkan specification.
#include "stages/surface/program_images.h"

#include "tests/programs/program_traces.h"

namespace beampipe::program_images_test {

std::vector<std::uint8_t> bytes_of(const std::vector<float>& numbers) {
  std::vector<std::uint8_t> bytes(numbers.size() * sizeof(float));
  if (!numbers.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

// Texel n of all levels together is n.
ProgramImage numbered(ImageShape shape, std::uint32_t width, std::uint32_t height = 1, std::uint32_t depth = 1,
                      std::uint32_t layers = 1, std::uint32_t levels = 1, bool is_array = false) {
  ProgramImage image{.name = "numbers", .shape = shape, .format = TexelFormat::R32_SFLOAT, .texels = {}};
  image.width = width, image.height = height, image.depth = depth;
  image.layers = layers, image.levels = levels, image.array = is_array;
  std::vector<float> numbers(level_start(image, levels) / sizeof(float));
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i);
  image.texels = bytes_of(numbers);
  return image;
}

spv::Dim dim_of(ImageShape shape) {
  return shape == ImageShape::d1     ? spv::Dim1D
         : shape == ImageShape::d3   ? spv::Dim3D
         : shape == ImageShape::cube ? spv::DimCube
                                     : spv::Dim2D;
}

// What an invocation asks; missing numbers are left out.
struct Question {
  ImageAction action = ImageAction::sample;
  std::vector<float> at{};
  std::vector<int> texel{};  // of a fetch, in place of `at`
  std::vector<float> dx{}, dy{};
  std::vector<int> offset{};
  std::optional<float> lod{}, bias{}, least_lod{}, reference{};
  std::optional<int> level{};  // of a fetch or a query, in place of `lod`
  std::uint32_t component = 0;
};

class Reader {
 public:
  explicit Reader(ProgramImage image, ProgramSampler sampler = {}) : images_{std::move(image)}, samplers_{sampler} {
    program_.images.push_back(
        {.set = 0, .binding = 0, .dim = dim_of(images_[0].shape), .arrayed = images_[0].array, .has_sampler = true});
  }

  ProgramSampler& sampler() { return samplers_[0]; }
  BoundImage& view() { return view_; }
  std::uint64_t texels() const { return texels_; }

  std::array<std::uint32_t, 4> bits(const Question& question) {
    const BoundImages bound = bound_images(program_, {view_}, images_, samplers_);
    TexelRequests texels(nullptr);
    ProgramImages reader(program_, bound, ~std::uint64_t{0}, &texels);
    std::vector<std::unique_ptr<LaneRow>> rows;
    const auto row = [&](std::uint32_t value) {
      rows.push_back(std::make_unique<LaneRow>());
      rows.back()->bits.fill(value);
      return rows.back().get();
    };
    const auto number = [&](float value) { return row(std::bit_cast<std::uint32_t>(value)); };
    const auto integer = [&](int value) { return row(static_cast<std::uint32_t>(value)); };
    ImageRequest request{.action = question.action, .component = question.component, .lanes = 1};
    for (std::size_t i = 0; i < question.at.size(); ++i) request.coordinates[i] = number(question.at[i]);
    for (std::size_t i = 0; i < question.texel.size(); ++i) request.coordinates[i] = integer(question.texel[i]);
    for (std::size_t i = 0; i < question.dx.size(); ++i) request.dx[i] = number(question.dx[i]);
    for (std::size_t i = 0; i < question.dy.size(); ++i) request.dy[i] = number(question.dy[i]);
    for (std::size_t i = 0; i < question.offset.size(); ++i) request.offset[i] = integer(question.offset[i]);
    if (question.lod) request.lod = number(*question.lod);
    if (question.level) request.lod = integer(*question.level);
    if (question.bias) request.bias = number(*question.bias);
    if (question.least_lod) request.least_lod = number(*question.least_lod);
    if (question.reference) request.reference = number(*question.reference);
    request.active = row(~0u);
    std::array<LaneRow, 4> texel;
    reader.read(request, {&texel[0], &texel[1], &texel[2], &texel[3]});
    texels_ = texels.texels();
    return {texel[0].bits[0], texel[1].bits[0], texel[2].bits[0], texel[3].bits[0]};
  }
  std::array<float, 4> numbers(const Question& question) { return std::bit_cast<std::array<float, 4>>(bits(question)); }
  float operator()(const Question& question) { return numbers(question)[0]; }

 private:
  LaneProgram program_;
  std::vector<ProgramImage> images_;
  std::vector<ProgramSampler> samplers_;
  BoundImage view_{.set = 0, .binding = 0, .image = 0, .sampler = 0};
  std::uint64_t texels_ = 0;
};

ProgramSampler nearest(SamplerWrap wrap = SamplerWrap::repeat) {
  return {.mag = Filter::nearest, .min = Filter::nearest, .mip = Filter::nearest, .wrap = {wrap, wrap, wrap}};
}
ProgramSampler linear(SamplerWrap wrap = SamplerWrap::clamp_to_edge) { return {.wrap = {wrap, wrap, wrap}}; }

// Eight lanes read texel (2 lane, 0) of level 1: of 16-byte texels, two sectors of 16 bytes of a row each lie between
// neighbours. The first lane is not counted, and the seventh asks for nothing.
TEST(ProgramImages, FourLanesAreARequest) {
  ProgramImage image{.name = "wide", .format = TexelFormat::R32G32B32A32_SFLOAT, .texels = {}};
  image.width = 32, image.height = 4, image.levels = 2;
  image.texels.resize(level_start(image, 2));
  const std::vector<ProgramImage> images{numbered(ImageShape::d1, 4), image};
  LaneProgram program;
  program.images.push_back({.set = 0, .binding = 0, .has_sampler = true});
  const BoundImages bound = bound_images(program, {{.set = 0, .binding = 0, .image = 1}}, images, {});
  const TextureLayout layout(TextureSet(Trace{}), images);
  TexelRequests texels(&layout);
  texels.read(ProgramTexelRead{.image = 0, .level = 0, .slice = 0, .x = 0, .y = 0});  // a request that ends
  ProgramImages reader(program, bound, 0xfe, &texels);
  LaneRow x{}, zero{}, level{}, active{};
  level.bits.fill(1);
  for (std::uint32_t lane = 0; lane < 8; ++lane) x.bits[lane] = 2 * lane, active.bits[lane] = lane == 6 ? 0 : ~0u;
  ImageRequest request{.action = ImageAction::fetch, .lanes = 8, .active = &active};
  request.coordinates = {&x, &zero}, request.lod = &level;
  std::array<LaneRow, 4> texel;
  for (int i = 0; i < 2; ++i) reader.read(request, {&texel[0], &texel[1], &texel[2], &texel[3]});
  std::vector<std::vector<std::uint64_t>> found;
  texels.for_each([&](std::span<const std::uint64_t> sectors) { found.emplace_back(sectors.begin(), sectors.end()); });
  // The line of the first image; then level 0 has 16 lines, of two texels each in four rows.
  const auto sector = [](std::uint64_t lane) { return (1 + 16 + lane) * 4; };
  const std::vector<std::uint64_t> first{sector(1), sector(2), sector(3)}, second{sector(4), sector(5), sector(7)};
  EXPECT_EQ(found, (std::vector<std::vector<std::uint64_t>>{{0}, first, second, first, second}));
  EXPECT_EQ(texels.texels(), 1u + 2 * 6);
}

TEST(ProgramImages, WrapsAtEdges) {
  // Texels -5 .. 8 of a row of 4.
  const std::pair<SamplerWrap, std::vector<float>> cases[] = {
      {SamplerWrap::repeat, {3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0}},
      {SamplerWrap::mirror, {3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0, 0}},
      {SamplerWrap::clamp_to_edge, {0, 0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3, 3}},
      {SamplerWrap::clamp_to_border, {7, 7, 7, 7, 7, 0, 1, 2, 3, 7, 7, 7, 7, 7}},
      {SamplerWrap::mirror_clamp, {3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 3, 3, 3, 3}}};
  for (const auto& [wrap, expected] : cases) {
    Reader reader(numbered(ImageShape::d1, 4), nearest(wrap));
    reader.sampler().border = glm::vec4(7, 8, 9, 10);
    for (int i = 0; i < 14; ++i)
      EXPECT_EQ(reader({.at = {(static_cast<float>(i - 5) + 0.5f) / 4}}), expected[static_cast<std::size_t>(i)])
          << static_cast<int>(wrap) << " texel " << i - 5;
  }
}

TEST(ProgramImages, BordersHaveTheChannelsOfTheFormat) {
  using enum TexelFormat;
  const auto at_border = [](TexelFormat format, const glm::vec4& border) {
    ProgramImage image{.name = "zero", .shape = ImageShape::d1, .format = format, .width = 4, .texels = {}};
    image.texels.resize(level_start(image, 1));
    Reader reader(std::move(image), nearest(SamplerWrap::clamp_to_border));
    reader.sampler().border = border;
    return reader.bits({.at = {-1.0f}});
  };
  const auto numbers = [&](TexelFormat format) {
    return std::bit_cast<std::array<float, 4>>(at_border(format, {0.25f, 0.5f, 0.75f, 0.125f}));
  };
  using Numbers = std::array<float, 4>;
  for (const TexelFormat format : {R8_UNORM, R16_SFLOAT, R32_SFLOAT, D32_SFLOAT})
    EXPECT_EQ(numbers(format), (Numbers{0.25f, 0, 0, 1}));
  for (const TexelFormat format : {R8G8_UNORM, R16G16_SFLOAT}) EXPECT_EQ(numbers(format), (Numbers{0.25f, 0.5f, 0, 1}));
  for (const TexelFormat format : {R8G8B8A8_UNORM, R16G16B16A16_SFLOAT, R32G32B32A32_SFLOAT})
    EXPECT_EQ(numbers(format), (Numbers{0.25f, 0.5f, 0.75f, 0.125f}));
  using Bits = std::array<std::uint32_t, 4>;
  EXPECT_EQ(at_border(R32G32B32A32_UINT, {7, 3e9f, 0, 1}), (Bits{7, 3'000'000'000, 0, 1}));
  EXPECT_EQ(at_border(R32G32B32A32_SINT, {-2, 7, 0, 1}), (Bits{0xfffffffe, 7, 0, 1}));
}

// Others are of another set or binding, or of an element that no array has.
TEST(ProgramImages, AreBoundBySetBindingAndElement) {
  const std::vector<ProgramImage> images{numbered(ImageShape::d1, 4), numbered(ImageShape::d1, 2)};
  LaneProgram program;
  program.images.push_back({.set = 1, .binding = 2, .count = 3, .dim = spv::Dim1D});
  const BoundImages bound = bound_images(program,
                                         {{.set = 1, .binding = 2, .element = 2, .image = 1},
                                          {.set = 1, .binding = 2, .element = 0, .image = 0},
                                          {.set = 0, .binding = 2, .element = 1, .image = 0},
                                          {.set = 1, .binding = 3, .element = 1, .image = 0},
                                          {.set = 1, .binding = 2, .element = ~0u, .image = 0}},
                                         images, {});
  ASSERT_EQ(bound.images.at(0).size(), 3u);
  EXPECT_EQ(bound.images[0][0].image, &images[0]);
  EXPECT_EQ(bound.images[0][1].image, nullptr);
  EXPECT_EQ(bound.images[0][2].image, &images[1]);
}

// What a shader reads as 2D may be stored as 1D or as a cube, and a cube as six square layers.
TEST(ProgramImages, AreNotBoundIfTheShaderExpectsOtherDimensions) {
  using enum ImageShape;
  const std::vector<ProgramImage> images{numbered(d1, 4),          numbered(d2, 2, 2),    numbered(d2, 2, 2, 1, 6),
                                         numbered(d2, 2, 1, 1, 6), numbered(d3, 2, 2, 2), numbered(cube, 2, 2, 1, 6)};
  const std::vector<std::pair<spv::Dim, std::string>> expected{{spv::Dim1D, "1....."}, {spv::DimBuffer, "1....."},
                                                               {spv::Dim2D, "1111.1"}, {spv::DimRect, "1111.1"},
                                                               {spv::Dim3D, "....1."}, {spv::DimCube, "..1..1"}};
  for (const auto& [dim, fitting] : expected) {
    LaneProgram program;
    program.images.push_back({.set = 0, .binding = 0, .dim = dim});
    std::string found;
    for (std::uint32_t i = 0; i < images.size(); ++i)
      found += bound_images(program, {{.image = i}}, images, {}).images.at(0).at(0).image ? '1' : '.';
    EXPECT_EQ(found, fitting) << "dimension " << dim;
  }
}

// Each lane reads texel 5 of a row of 4 with another sampler of an array: one of its edge, one of its border, and one
// that nobody has bound.
TEST(ProgramImages, SamplersOfAnArray) {
  const std::vector<ProgramImage> images{numbered(ImageShape::d1, 4)};
  std::vector<ProgramSampler> samplers{nearest(SamplerWrap::clamp_to_edge), nearest(SamplerWrap::clamp_to_border)};
  samplers[1].border.r = 9;
  LaneProgram program;
  program.images.push_back({.set = 0, .binding = 0, .dim = spv::Dim1D});
  program.samplers.push_back({.set = 1, .binding = 2, .count = 4});
  const BoundImages bound = bound_images(program,
                                         {{.set = 0, .binding = 0, .image = 0},
                                          {.set = 1, .binding = 2, .element = 3, .sampler = 1},
                                          {.set = 1, .binding = 2, .element = 0, .sampler = 0}},
                                         images, samplers);
  ProgramImages reader(program, bound);
  LaneRow u{}, element{}, active{};
  u.bits.fill(std::bit_cast<std::uint32_t>(5.5f / 4)), active.bits.fill(~0u);
  element.bits[1] = 3, element.bits[2] = 1, element.bits[3] = 70'000;
  ImageRequest request{.action = ImageAction::sample, .lanes = 4, .active = &active};
  request.coordinates = {&u}, request.sampler = 0, request.sampler_element = &element;
  std::array<LaneRow, 4> texel;
  reader.read(request, {&texel[0], &texel[1], &texel[2], &texel[3]});
  EXPECT_EQ(texel[0].number(0), 3);
  EXPECT_EQ(texel[0].number(1), 9);
  EXPECT_EQ(texel[0].number(2), 1) << "without a sampler it repeats";
  EXPECT_EQ(texel[0].number(3), 1);
}

TEST(ProgramImages, LinearFiltersMixNeighbours) {
  Reader line(numbered(ImageShape::d1, 4), linear());
  EXPECT_EQ(line({.at = {0.5f}}), 1.5f);
  EXPECT_EQ(line({.at = {0.4375f}}), 1.25f);
  EXPECT_EQ(line({.at = {0.01f}}), 0.0f);
  EXPECT_EQ(line({.at = {0.4375f}, .offset = {1}}), 2.25f);
  EXPECT_EQ(line.texels(), 2u);
  Reader plane(numbered(ImageShape::d2, 4, 4), linear());
  EXPECT_EQ(plane({.at = {0.4375f, 0.5f}}), 1.25f + 4 * 1.5f);
  EXPECT_EQ(plane.texels(), 4u);
  Reader volume(numbered(ImageShape::d3, 4, 4, 4), linear());
  EXPECT_EQ(volume({.at = {0.4375f, 0.5f, 0.5f}}), 1.25f + 4 * 1.5f + 16 * 1.5f);
  EXPECT_EQ(volume.texels(), 8u);
  Reader layers(numbered(ImageShape::d2, 2, 2, 1, 3, 1, true), nearest());
  EXPECT_EQ(layers({.at = {0, 0, 1.4f}}), 4);
  EXPECT_EQ(layers({.at = {0, 0, 9}}), 8);
  EXPECT_EQ(layers({.at = {0, 0, -2}}), 0);
  Reader unnormalized(numbered(ImageShape::d2, 4, 4), {.unnormalized = true});
  EXPECT_EQ(unnormalized({.at = {1.5f, 2.5f}}), 9);
}

// Levels of 4, 2 and 1 texels start at 0, 4 and 6. The log2 of texels per pixel chooses.
TEST(ProgramImages, DetailComesFromDerivatives) {
  Reader reader(numbered(ImageShape::d1, 4, 1, 1, 1, 3), nearest());
  const auto at_texels_per_pixel = [&](float texels) {
    return reader({.at = {0.1f}, .dx = {texels / 4}, .dy = {0.0f}});
  };
  EXPECT_EQ(at_texels_per_pixel(0.1f), 0);
  EXPECT_EQ(at_texels_per_pixel(1.41f), 0);
  EXPECT_EQ(at_texels_per_pixel(1.42f), 4);
  EXPECT_EQ(at_texels_per_pixel(2.82f), 4);
  EXPECT_EQ(at_texels_per_pixel(2.84f), 6);
  EXPECT_EQ(at_texels_per_pixel(1000), 6);
  EXPECT_EQ(at_texels_per_pixel(0), 0);
  EXPECT_EQ(reader({.at = {0.1f}, .dx = {0}, .dy = {-0.5f}}), 4);  // the longer side
  EXPECT_EQ(reader({.at = {0.1f}, .dx = {0.25f}, .dy = {0}, .bias = 1.0f}), 4);
  EXPECT_EQ(reader({.at = {0.1f}, .lod = 1.0f}), 4);
  EXPECT_EQ(reader({.at = {0.1f}, .dx = {0}, .dy = {0}, .least_lod = 2.0f}), 6);
  reader.sampler().lod_bias = 1;
  EXPECT_EQ(at_texels_per_pixel(1), 4);
  reader.sampler().most_lod = 0.2f;
  EXPECT_EQ(at_texels_per_pixel(1), 0);
  reader.sampler() = nearest();
  reader.sampler().mip = Filter::linear;
  EXPECT_EQ(reader({.at = {0.1f}, .lod = 0.25f}), 1);  // a quarter of 4
  EXPECT_EQ(reader({.at = {0.9f}, .lod = 1.5f}), 5.5f);
  reader.view().base_level = 1;
  EXPECT_EQ(reader({.at = {0.1f}, .lod = 0.0f}), 4);
  // The view begins with level 1. Of 2 texels one pixel is 0.5.
  const std::array<float, 4> asked =
      reader.numbers({.action = ImageAction::query_lod, .at = {0.1f}, .dx = {4.0f}, .dy = {0.0f}});
  EXPECT_EQ(asked[0], 1);
  EXPECT_EQ(asked[1], 3);
  // Three texels: 9 is 8 and an eighth of it, which a line makes (3 + 1 / 8) / 2.
  EXPECT_EQ(reader.numbers({.action = ImageAction::query_lod, .at = {0.1f}, .dx = {1.5f}, .dy = {0.0f}})[1], 1.5625f);
}

// A footprint of one texel on each axis: a x^2 + c y^2 with a = c = 2 of a c = 4. Beside the texel in the middle are
// four at half of it, weight exp(-1), and four at its end, weight exp(-2).
TEST(ProgramImages, AnisotropicFootprintsHaveGaussianWeights) {
  ProgramImage image = numbered(ImageShape::d2, 8, 8);
  std::vector<float> numbers(64);
  numbers[8 * 4 + 4] = 1;
  image.texels = bytes_of(numbers);
  ProgramSampler sampler = linear(SamplerWrap::repeat);
  sampler.anisotropy = 4;
  Reader reader(image, sampler);
  const auto at_texel = [&](float x, float y) {
    return reader({.at = {(x + 0.5f) / 8, (y + 0.5f) / 8}, .dx = {0.125f, 0}, .dy = {0, 0.125f}});
  };
  const double e1 = std::exp(-1.0), e2 = std::exp(-2.0), all = 1 + 4 * e1 + 4 * e2;
  EXPECT_NEAR(at_texel(4, 4), 1 / all, 2e-4);
  EXPECT_EQ(reader.texels(), 9u);
  EXPECT_NEAR(at_texel(5, 4), e1 / all, 2e-4);
  EXPECT_NEAR(at_texel(3, 5), e2 / all, 2e-4);
  EXPECT_EQ(at_texel(4, 6), 0);
}

// Slopes of 8 and 1 texels: 2 x^2 + 65 y^2 up to 130. Level 0, because the shorter one is 1.
TEST(ProgramImages, AnisotropyAveragesAlongTheLongerSide) {
  ProgramImage image = numbered(ImageShape::d2, 32, 32, 1, 1, 6);
  std::vector<float> numbers(level_start(image, 6) / sizeof(float), 7.0f);
  for (std::size_t y = 0; y < 32; ++y)
    for (std::size_t x = 0; x < 32; ++x) numbers[32 * y + x] = x >= 16 ? 1.0f : 0.0f;  // a step
  image.texels = bytes_of(numbers);
  ProgramSampler sampler = linear();
  sampler.anisotropy = 16;
  Reader reader(image, sampler);
  const auto at_column = [&](int x) {
    return reader(
        {.at = {(static_cast<float>(x) + 0.5f) / 32, 16.5f / 32}, .dx = {8.0f / 32, 0}, .dy = {0, 1.0f / 32}});
  };
  for (const int column : {6, 7, 12, 15, 16, 20, 24}) {
    double bright = 0, all = 0;
    for (int x = -9; x <= 9; ++x)
      for (int y = -1; y <= 1; ++y) {
        const double square = x * x / 65.0 + y * y / 2.0;
        if (square > 1) continue;
        all += std::exp(-2 * square);
        if (column + x >= 16) bright += std::exp(-2 * square);
      }
    EXPECT_NEAR(at_column(column), bright / all, 1e-3) << column;
  }
  EXPECT_EQ(reader.texels(), 17 + 2 * 11u);  // |x| <= 8 where y is 0, x^2 <= 32.5 beside it
  // Along the step the mean is that of a short side, and turned by 45 degrees it is a half on the step's own edge.
  const Question along{.at = {14.5f / 32, 16.5f / 32}, .dx = {1.0f / 32, 0}, .dy = {0, 8.0f / 32}};
  EXPECT_EQ(reader(along), 0);
  const Question turned{.at = {16.0f / 32, 16.0f / 32}, .dx = {4.0f / 32, 4.0f / 32}, .dy = {1.0f / 32, -1.0f / 32}};
  EXPECT_NEAR(reader(turned), 0.5f, 1e-3);
}

// 3.9 texels on both axes: log2 is 1.96, and level 1 is read alone.
TEST(ProgramImages, AnisotropyReadsOneLevel) {
  ProgramImage image = numbered(ImageShape::d2, 16, 16, 1, 1, 5);
  std::vector<float> numbers(level_start(image, 5) / sizeof(float));
  for (std::uint32_t level = 0; level < 5; ++level)
    std::fill(numbers.begin() + static_cast<std::ptrdiff_t>(level_start(image, level) / sizeof(float)), numbers.end(),
              static_cast<float>(level));
  image.texels = bytes_of(numbers);
  ProgramSampler sampler = linear(SamplerWrap::repeat);
  sampler.anisotropy = 2;
  Reader reader(image, sampler);
  const auto at_slopes = [&](float right, float down) {
    return reader({.at = {0.3f, 0.7f}, .dx = {right / 16, 0}, .dy = {0, down / 16}});
  };
  EXPECT_FLOAT_EQ(at_slopes(3.9f, 3.9f), 1);
  EXPECT_FLOAT_EQ(at_slopes(4.1f, 4.1f), 2);
  EXPECT_FLOAT_EQ(at_slopes(100, 2.1f), 1);  // the shorter one chooses
  EXPECT_FLOAT_EQ(at_slopes(0.1f, 0), 0);
  EXPECT_FLOAT_EQ(at_slopes(1e9f, 1e9f), 4);
  EXPECT_FLOAT_EQ(at_slopes(1e9f, 0), 0);
  EXPECT_LT(reader.texels(), 3000u);  // 256 texels to both sides
}

// On the left edge of the image, without slopes: a circle of one texel around the edge holds two texels of the image
// and two of the border, all at the same distance.
TEST(ProgramImages, AnisotropicFootprintsHoldTheBorder) {
  ProgramImage image = numbered(ImageShape::d2, 4, 4);
  image.texels = bytes_of(std::vector<float>(16, 3.0f));
  ProgramSampler sampler = linear(SamplerWrap::clamp_to_border);
  sampler.border = glm::vec4(1, 0, 0, 1);
  sampler.anisotropy = 4;
  Reader reader(image, sampler);
  EXPECT_FLOAT_EQ(reader({.at = {0, 0.5f}, .dx = {0, 0}, .dy = {0, 0}}), 2);
  EXPECT_EQ(reader.texels(), 2u);
  EXPECT_FLOAT_EQ(reader({.at = {-2, 0.5f}, .dx = {0, 0}, .dy = {0, 0}}), 1);
}

// Each face has its number, and its texels grow by 0.1 along s and by 1 along t.
TEST(ProgramImages, CubesHaveSixFaces) {
  ProgramImage image = numbered(ImageShape::cube, 2, 2, 1, 6);
  Reader reader(image, nearest());
  // Face 0 is +x, with s along -z and t along -y: texels 4 face + 2 t + s.
  const std::pair<std::vector<float>, float> cases[] = {
      {{1, 0.5f, 0.5f}, 0},     {{1, 0.5f, -0.5f}, 1},  {{1, -0.5f, 0.5f}, 2},  {{-1, 0.5f, -0.5f}, 4},
      {{-1, 0.5f, 0.5f}, 5},    {{-0.5f, 1, -0.5f}, 8}, {{-0.5f, 1, 0.5f}, 10}, {{-0.5f, -1, 0.5f}, 12},
      {{-0.5f, -1, -0.5f}, 14}, {{-0.5f, 0.5f, 1}, 16}, {{0.5f, 0.5f, 1}, 17},  {{0.5f, 0.5f, -1}, 20},
      {{-0.5f, 0.5f, -1}, 21},  {{1, 1, 1}, 17},        {{-0.5f, 2, 2}, 16}};
  for (const auto& [direction, expected] : cases)
    EXPECT_EQ(reader({.at = direction}), expected) << direction[0] << ' ' << direction[1] << ' ' << direction[2];
  // On the edge between +x and +z, in the middle of the upper half: half of texel 0 (+x) and half of texel 17 (+z).
  reader.sampler() = linear();
  EXPECT_NEAR(reader({.at = {1, 0.5f, 0.99999f}}), 0.5f * 0 + 0.5f * 17, 1e-3);
  EXPECT_NEAR(reader({.at = {0.99999f, 0.5f, 1}}), 0.5f * 0 + 0.5f * 17, 1e-3);
  // At the corner, the three texels that meet there: 0 of +x, 11 of +y and 17 of +z.
  EXPECT_NEAR(reader({.at = {1, 0.99999f, 0.99999f}}), 28 / 3.0f, 1e-3);
}

TEST(ProgramImages, GathersAndFetches) {
  Reader reader(numbered(ImageShape::d2, 4, 4, 1, 1, 3), linear());
  // Around texels 5, 6, 9 and 10: lower left, lower right, upper right, upper left.
  EXPECT_EQ(reader.numbers({.action = ImageAction::gather, .at = {0.5f, 0.5f}}), (std::array<float, 4>{9, 10, 6, 5}));
  EXPECT_EQ(reader.numbers({.action = ImageAction::gather, .at = {0.5f, 0.5f}, .component = 3}),
            (std::array<float, 4>{1, 1, 1, 1}));
  const auto fetch = [&](std::vector<int> texel, int level, std::vector<int> offset = {}) {
    return reader(
        {.action = ImageAction::fetch, .texel = std::move(texel), .offset = std::move(offset), .level = level});
  };
  EXPECT_EQ(fetch({3, 2}, 0), 11);
  EXPECT_EQ(fetch({2, 2}, 0, {1, -1}), 7);
  EXPECT_EQ(fetch({1, 0}, 1), 17);
  EXPECT_EQ(fetch({0, 0}, 2), 20);
  EXPECT_EQ(fetch({0, 0}, 3), 0);  // outside
  EXPECT_EQ(fetch({2, 0}, 1), 0);
  EXPECT_EQ(fetch({-1, 0}, 0), 0);
}

TEST(ProgramImages, SizesAreTold) {
  Reader cube(numbered(ImageShape::cube, 4, 4, 1, 12, 3, true));
  EXPECT_EQ(cube.bits({.action = ImageAction::query_size, .level = 1}), (std::array<std::uint32_t, 4>{2, 2, 2, 0}));
  EXPECT_EQ(cube.bits({.action = ImageAction::query_levels})[0], 3u);
  Reader volume(numbered(ImageShape::d3, 8, 4, 2, 1, 4));
  EXPECT_EQ(volume.bits({.action = ImageAction::query_size, .level = 2}), (std::array<std::uint32_t, 4>{2, 1, 1, 0}));
}

TEST(ProgramImages, DepthsAreComparedBeforeTheyAreFiltered) {
  ProgramImage image{.name = "depths",
                     .shape = ImageShape::d2,
                     .format = TexelFormat::D32_SFLOAT,
                     .width = 2,
                     .height = 1,
                     .texels = {}};
  image.texels = bytes_of({0.25f, 0.75f});
  Reader reader(image, linear());
  reader.sampler().compare = Compare::less_equal;
  const auto lit = [&](float u, float reference) { return reader({.at = {u, 0.5f}, .reference = reference}); };
  EXPECT_EQ(lit(0.25f, 0.25f), 1);
  EXPECT_EQ(lit(0.25f, 0.5f), 0);
  EXPECT_EQ(lit(0.5f, 0.5f), 0.5f);
  EXPECT_EQ(lit(0.625f, 0.5f), 0.75f);
  EXPECT_EQ(lit(0.75f, 7), 0);
  reader.sampler().compare = Compare::greater;
  EXPECT_EQ(lit(0.625f, 0.5f), 0.25f);
}

TEST(ProgramImages, FormatsAreDecoded) {
  const auto texel = [](TexelFormat format, std::vector<std::uint8_t> bytes) {
    ProgramImage image{
        .name = "texel", .shape = ImageShape::d2, .format = format, .width = 1, .height = 1, .texels = {}};
    image.texels = std::move(bytes);
    return Reader(image, nearest()).numbers({.at = {0, 0}});
  };
  using Texel = std::array<float, 4>;
  EXPECT_EQ(texel(TexelFormat::R8_UNORM, {51}), (Texel{0.2f, 0, 0, 1}));
  EXPECT_EQ(texel(TexelFormat::R8G8_UNORM, {51, 255}), (Texel{0.2f, 1, 0, 1}));
  EXPECT_EQ(texel(TexelFormat::R8G8B8A8_UNORM, {51, 102, 255, 0}), (Texel{0.2f, 0.4f, 1, 0}));
  EXPECT_EQ(texel(TexelFormat::B8G8R8A8_UNORM, {51, 102, 255, 0}), (Texel{1, 0.4f, 0.2f, 0}));
  const float grey = static_cast<float>(linear_of_srgb(102.0 / 255));
  EXPECT_EQ(texel(TexelFormat::R8G8B8A8_SRGB, {0, 102, 255, 102}), (Texel{0, grey, 1, 0.4f}));
  EXPECT_EQ(texel(TexelFormat::B8G8R8A8_SRGB, {0, 102, 255, 102}), (Texel{1, grey, 0, 0.4f}));
  EXPECT_EQ(texel(TexelFormat::R16_SFLOAT, {0, 0x3e}), (Texel{1.5f, 0, 0, 1}));
  EXPECT_EQ(texel(TexelFormat::R16G16_SFLOAT, {0, 0x3e, 0, 0xc0}), (Texel{1.5f, -2, 0, 1}));
  EXPECT_EQ(texel(TexelFormat::R16G16B16A16_SFLOAT, {0, 0x3e, 0, 0xc0, 1, 0, 0, 0x3c}), (Texel{1.5f, -2, 0x1p-24f, 1}));
  EXPECT_EQ(texel(TexelFormat::R16G16B16A16_UNORM, {0xff, 0xff, 0x33, 0x33, 0, 0, 0xff, 0xff}), (Texel{1, 0.2f, 0, 1}));
  EXPECT_EQ(texel(TexelFormat::R32_SFLOAT, bytes_of({-3.5f})), (Texel{-3.5f, 0, 0, 1}));
  EXPECT_EQ(texel(TexelFormat::R32G32B32A32_SFLOAT, bytes_of({1, 2, 3, 4})), (Texel{1, 2, 3, 4}));
  ProgramImage integers{.name = "n",
                        .shape = ImageShape::d2,
                        .format = TexelFormat::R32G32B32A32_SINT,
                        .width = 1,
                        .height = 1,
                        .texels = {}};
  integers.texels = {255, 255, 255, 255, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 128};
  EXPECT_EQ(Reader(integers).bits({.at = {0, 0}}), (std::array<std::uint32_t, 4>{~0u, 1, 256, 0x80000000u}));
}

TEST(ProgramImages, AnyNumberIsSafe) {
  Reader reader(numbered(ImageShape::d2, 4, 4, 1, 1, 3), linear(SamplerWrap::mirror));
  for (const float value : {NAN, INFINITY, -INFINITY, 1e38f, -1e38f})
    for (const float slope : {0.0f, NAN, INFINITY, 1e38f})
      reader({.at = {value, value}, .dx = {slope, slope}, .dy = {slope, value}, .offset = {1 << 30, -(1 << 30)}});
  Reader cube(numbered(ImageShape::cube, 4, 4, 1, 6, 3), linear());
  for (const float value : {0.0f, NAN, INFINITY, -INFINITY, 1e38f})
    cube({.at = {value, 0, value}, .dx = {value, 0, 1}, .dy = {NAN, value, 0}});
  reader.sampler().anisotropy = cube.sampler().anisotropy = 16;
  for (const float value : {0.0f, NAN, INFINITY, -INFINITY, 1e38f}) {
    reader({.at = {value, 0.5f}, .dx = {value, 1}, .dy = {0, value}, .offset = {1 << 30, 0}});
    cube({.at = {1, value, 0}, .dx = {value, 0, 1}, .dy = {0, value, 0}});
  }
}

}  // namespace beampipe::program_images_test

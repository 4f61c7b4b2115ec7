// Regions of a pixel, against expectations that are worked out by hand, and against a pixel that is computed position
// by position.

#include "stages/beam/compose_regions.h"

#include "tests/simd/random.h"
#include "tests/stages/open_pixels.h"

namespace beampipe::compose_regions_test {

constexpr std::size_t kWords = 8;
constexpr glm::vec4 kClear{0.25f, 0.5f, 0.125f, 0.5f}, kRed{1, 0, 0, 1}, kGreen{0, 1, 0, 1}, kBlue{0, 0, 1, 1};
constexpr double kAreaStep = 1.0 / kWholeArea, kRounding = 0x1p-10;

RopRule plain() { return {}; }
RopRule without_depth() {
  RopRule rule;
  rule.depth = Compare::always, rule.writes_depth = false;
  return rule;
}
RopRule over() {
  RopRule rule = without_depth();
  rule.blend = Blend{{BlendFactor::source_alpha, BlendFactor::one_minus_source_alpha, BlendOperation::add}, {}, {}};
  return rule;
}
// With the same stencil for both faces, without depth.
RopRule marking(const Stencil& stencil) {
  RopRule rule = without_depth();
  rule.has_stencil = true, rule.stencil = {stencil, stencil};
  return rule;
}

// Draws in the API's order into the pixel (0, 0).
class OnePixel {
 public:
  explicit OnePixel(const glm::vec4& clear_color = kClear, float clear_depth = 0, std::size_t words = kWords)
      : words_(words), positions_(cell_positions(32 * static_cast<int>(words))) {
    rules_.clear_color = clear_color, rules_.clear_depth = clear_depth, rules_.limits_color = false;
  }

  void begin(const RopRule& rule, const glm::vec4& color) {
    rules_.draws.push_back({rule, rule});
    color_ = color;
  }
  // Of the draw's triangles from here on.
  void color(const glm::vec4& color) { color_ = color; }
  void clear_before_next(std::optional<std::uint32_t> stencil, bool depth = false) {
    rules_.clears.push_back({static_cast<std::uint32_t>(rules_.draws.size()), depth, stencil});
  }
  void triangle(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r) { add({p, q, r}); }
  void left_of(std::int32_t x, float z = -0.5f) { add(beampipe::left_of(x, z)); }
  void right_of(std::int32_t x, float z = -0.5f) { add(beampipe::right_of(x, z)); }
  void everywhere(float z = -0.5f) { add(beampipe::everywhere(z)); }
  void everywhere(const RopRule& rule, const glm::vec4& color, float z = -0.5f) {
    begin(rule, color);
    everywhere(z);
  }
  void turn_last_over() { triangles_.triangles.back().front = !triangles_.triangles.back().front; }

  glm::vec4 compose(std::size_t pool_bytes = 1 << 20) {
    const Tile tile{0, 0, 1, 1};
    const std::vector<Fragment> fragments = of_words(tile);
    std::vector<glm::vec4> colors;
    for (const Fragment& fragment : fragments) colors.push_back(colors_[fragment.triangle]);
    const RegionsBin bin{triangles_, rules_, positions_};
    RegionPixels pixels(1, ChunkPool(pool_bytes), words_, rules_.clear_depth, rules_.clear_color);
    std::vector<float> merges(1), chunks(1), bytes(1);
    RegionsResult result;
    compose_regions(bin, {fragments, colors}, counters, pixels, {merges, chunks, bytes}, result);
    StageCounters finishing;
    const glm::vec4 color =
        finish_regions(bin, glm::vec3(rules_.clear_color), finishing, pixels, {merges, chunks, bytes}, result).at(0);
    regions = pixels.pixels[0].regions;
    shaded = result.shaded.size();
    spills = result.spills.all();
    merged = static_cast<int>(merges[0]);
    return color;
  }

  std::vector<Region> regions;
  StageCounters counters;
  std::size_t shaded = 0, spills = 0;
  int merged = 0;

 private:
  void add(const ScreenTriangle& triangle) {
    add_triangle(triangles_, triangle);
    triangles_.draws.resize(triangles_.triangles.size(), static_cast<std::uint32_t>(rules_.draws.size() - 1));
    colors_.resize(triangles_.triangles.size(), color_);
  }
  std::vector<Fragment> of_words(const Tile& tile) const {
    if (words_ == 1) return fragments_in_order<1>(triangles_, all_of(triangles_), tile);
    return fragments_in_order<kWords>(triangles_, all_of(triangles_), tile);
  }

  std::size_t words_;
  const PositionSet& positions_;
  SetupTriangles triangles_;
  RopRules rules_{Trace{}, Frame{}, glm::vec3(0.0f)};
  std::vector<glm::vec4> colors_;
  glm::vec4 color_{0.0f};
};

void expect_color(const glm::vec4& found, const glm::dvec3& expected, double tolerance = kRounding) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << "channel " << c;
}

// The regions divide the positions and the area among them.
void expect_partition(const std::vector<Region>& regions, std::size_t words = kWords) {
  WideMask all;
  std::uint32_t area = 0;
  int positions = 0;
  for (const Region& region : regions) {
    EXPECT_FALSE(region.positions.none());
    all = all | region.positions;
    area += region.area;
    positions += region.positions.count();
  }
  EXPECT_EQ(all, first_words(words));
  EXPECT_EQ(positions, static_cast<int>(32 * words));
  EXPECT_EQ(area, kWholeArea);
  EXPECT_LE(regions.size(), kMostRegions);
}

TEST(Regions, AnUntouchedPixelHasTheClearedColour) {
  OnePixel pixel;
  EXPECT_EQ(pixel.compose(), glm::vec4(0.25f, 0.5f, 0.125f, 0.0f));
  expect_partition(pixel.regions);
}

TEST(Regions, AnEdgeHasItsExactArea) {
  for (int x = 3; x <= 253; x += 10) {
    OnePixel pixel;
    pixel.begin(plain(), kRed);
    pixel.left_of(x);
    const double area = x / 256.0;
    const glm::vec4 color = pixel.compose();
    expect_color(color, area * glm::dvec3(kRed) + (1 - area) * glm::dvec3(kClear), 2 * kAreaStep);
    EXPECT_NEAR(color.a, area, 2 * kAreaStep);
    EXPECT_EQ(pixel.regions.size(), 2u);
    expect_partition(pixel.regions);
  }
}

// What is behind an edge gets what the edge leaves, though it was drawn in two triangles whose border lies elsewhere.
TEST(Regions, AreasBehindAnEdgeAddUp) {
  OnePixel pixel;
  pixel.begin(plain(), kRed);
  pixel.left_of(77, -0.75f);
  pixel.begin(plain(), kGreen);
  pixel.left_of(180, -0.5f);
  pixel.right_of(180, -0.5f);
  const double red = 77 / 256.0;
  expect_color(pixel.compose(), {red, 1 - red, 0}, 3 * kAreaStep);
  expect_partition(pixel.regions);
}

// From depth -0.75 on the left to -0.25 on the right side of the pixel.
void add_crossing(OnePixel& pixel) {
  pixel.triangle({-1024, -1024, -2.75f}, {2048, -1024, 3.25f}, {-1024, 2048, -2.75f});
}

TEST(Regions, PlanesThatCrossAreComparedAtPositions) {
  OnePixel pixel;
  pixel.everywhere(plain(), kRed, -0.5f);
  pixel.begin(plain(), kGreen);
  add_crossing(pixel);
  expect_color(pixel.compose(), {0.5, 0.5, 0}, 1.0 / 256);
  EXPECT_EQ(pixel.regions.size(), 2u);
  expect_partition(pixel.regions);
}

// The right half lies behind, and its stencil value says so.
TEST(Regions, PositionsThatFailTheDepthTestTakeItsStencilOperation) {
  OnePixel pixel;
  pixel.everywhere(plain(), kRed, -0.5f);
  pixel.clear_before_next(5u);
  RopRule rule;
  rule.has_stencil = true;
  rule.stencil[0].depth_fail = rule.stencil[1].depth_fail = StencilOperation::increment;
  pixel.begin(rule, kGreen);
  add_crossing(pixel);
  pixel.compose();
  ASSERT_EQ(pixel.regions.size(), 2u);
  EXPECT_NE(pixel.regions[0].stencil, pixel.regions[1].stencil);
  for (const Region& region : pixel.regions) EXPECT_EQ(region.stencil, region.color[1] == 1 ? 5 : 6);
}

// Beyond the far plane depth is limited to it, where nothing is nearer than what is cleared to it.
TEST(Regions, DepthsAreLimitedToTheRange) {
  OnePixel pixel;
  pixel.everywhere(plain(), kRed, 0.25f);
  EXPECT_EQ(pixel.compose().r, kClear.r);
  OnePixel other;
  RopRule rule;
  rule.depth = Compare::equal;
  other.everywhere(rule, kRed, 0.25f);
  other.everywhere(plain(), kGreen, 0.0f);
  EXPECT_EQ(other.compose(), kRed) << "what lies on the far plane is not nearer than what was limited to it";
}

// A window that one draw opens and another looks through.
TEST(Regions, StencilCutsOutWhatItMarks) {
  OnePixel pixel;
  RopRule mark = marking({.reference = 1, .pass = StencilOperation::replace});
  mark.color_mask = 0;
  pixel.begin(mark, kRed);
  pixel.left_of(100);
  pixel.everywhere(marking({.function = Compare::equal, .reference = 1}), kBlue);
  const double area = 100 / 256.0;
  expect_color(pixel.compose(), area * glm::dvec3(kBlue) + (1 - area) * glm::dvec3(kClear), 2 * kAreaStep);
}

// A fan around a hub inside the pixel covers all of it, in as many triangles as it has. Blended once, it is one
// surface.
TEST(Regions, AMeshHasNoSeams) {
  Random random(41);
  for (int i = 0; i < 200; ++i) {
    OnePixel pixel;
    for (int layer = 0; layer < 3; ++layer) {
      pixel.begin(over(), {layer == 0, layer == 1, layer == 2, 0.5f});
      const ScreenPoint hub{random.int32(1, 255), random.int32(1, 255)};
      const SetupTriangles fan = fan_around(hub, 2000, random.int32(1, 3), &random);
      for (const SetupTriangle& t : fan.triangles) pixel.triangle({t.x[0], t.y[0]}, {t.x[1], t.y[1]}, {t.x[2], t.y[2]});
    }
    // Each layer halves what is there and adds half of its colour.
    expect_color(pixel.compose(), {0.25 / 8 + 0.125, 0.5 / 8 + 0.25, 0.125 / 8 + 0.5});
    EXPECT_EQ(pixel.regions.size(), 1u) << i;
    expect_partition(pixel.regions);
  }
}

// Two layers of one draw that lie over each other are two layers.
TEST(Regions, OverlapsWithinADrawAreBlendedTwice) {
  OnePixel pixel;
  pixel.begin(over(), {1, 1, 1, 0.5f});
  pixel.left_of(128);
  pixel.everywhere();
  // Left: 1 - (1 - c) / 4; right: 1 - (1 - c) / 2.
  expect_color(pixel.compose(), {1 - 0.75 * 0.375, 1 - 0.5 * 0.375, 1 - 0.875 * 0.375}, 2 * kRounding);
  EXPECT_EQ(pixel.regions.size(), 2u);
}

// A square of 1/512 px on each side lies between positions, and adds its area.
TEST(Regions, SpecksAddTheirArea) {
  OnePixel pixel(glm::vec4(0.0f));
  pixel.begin(plain(), {16, 8, 4, 1});
  int specks = 0;
  for (int i = 0; i < 16; ++i, ++specks) {
    const std::int32_t x = 16 * i + 2, y = 16 * ((5 * i) % 16) + 2;
    pixel.triangle({x, y}, {x + 1, y}, {x, y + 1});
  }
  const glm::vec4 found = pixel.compose();
  const double area = specks * 0.5 / 65536;
  expect_color(found, {16 * area, 8 * area, 4 * area}, 16 * area * 0.01);
  EXPECT_EQ(pixel.shaded, 16u);
}

// Each is half of a square of 1/256 px, and no position is near.
void add_specks(OnePixel& pixel, int count) {
  for (int i = 0; i < count; ++i) pixel.triangle({2, 2, -0.25f}, {3, 2, -0.25f}, {2, 3, -0.25f});
}
constexpr double kSpeck = 0.5 / 65536;

TEST(Regions, SpecksHaveTheirMeanColour) {
  OnePixel pixel(glm::vec4(0.0f));
  pixel.begin(without_depth(), {0, 0, 0, 1});
  add_specks(pixel, 48);
  pixel.color({0, 256, 0, 1});
  add_specks(pixel, 16);
  expect_color(pixel.compose(), {0, 16 * kSpeck * 256, 0}, 1e-4);
}

// What the draw covers has its colour already. Its specks go to the largest region that it has not touched.
TEST(Regions, SpecksGoWhereTheirDrawHasNotBeen) {
  for (const int covered : {0, 192, 256}) {
    OnePixel pixel(glm::vec4(0.0f));
    pixel.everywhere(without_depth(), kBlue);
    pixel.begin(without_depth(), kRed);
    if (covered == 256) {
      pixel.everywhere();
    } else if (covered > 0) {
      pixel.left_of(covered);
    }
    pixel.color({0, 256, 0, 1});
    add_specks(pixel, 64);
    EXPECT_NEAR(pixel.compose().g, covered == 256 ? 0 : 64 * kSpeck * 256, 1e-3) << covered;
  }
}

// A region that is joined to what the draw has not touched is not touched as a whole.
TEST(Regions, SpecksGoToWhatIsPartlyTouched) {
  OnePixel pixel(glm::vec4(0.5f));
  pixel.begin(without_depth(), glm::vec4(0.5f));
  pixel.left_of(128);
  pixel.color({0.5f, 256, 0.5f, 1});
  add_specks(pixel, 64);
  EXPECT_NEAR(pixel.compose().g, 0.5 + 64 * kSpeck * 255.5, 1e-3);
  EXPECT_EQ(pixel.regions.size(), 1u);
}

TEST(Regions, SpecksFillARegionOnce) {
  OnePixel pixel(glm::vec4(0.0f));
  pixel.begin(without_depth(), kRed);
  pixel.left_of(250);
  pixel.color({0, 16, 0, 1});
  add_specks(pixel, 8192);  // 1/16 of the pixel, and 6/256 are left
  EXPECT_NEAR(pixel.compose().g, 16 * 6 / 256.0, 16 * 2 * kAreaStep);
}

TEST(Regions, HiddenSpecksAddNothing) {
  OnePixel pixel;
  pixel.everywhere(plain(), kRed, -0.75f);
  pixel.begin(plain(), {16, 16, 16, 1});
  pixel.triangle({2, 2, -0.5f}, {3, 2, -0.5f}, {2, 3, -0.5f});
  EXPECT_EQ(pixel.compose(), kRed);
  EXPECT_EQ(pixel.shaded, 1u);
}

// A quarter and three quarters whose colours are 1/128 apart.
TEST(Regions, ColoursThatAreJoinedCountWithTheirAreas) {
  OnePixel pixel;
  pixel.begin(without_depth(), glm::vec4(0.5f));
  pixel.left_of(64);
  pixel.begin(without_depth(), glm::vec4(0.5f + 1.0f / 128));
  pixel.right_of(64);
  expect_color(pixel.compose(), glm::dvec3(0.5 + 0.75 / 128), 0x1p-11);
  EXPECT_EQ(pixel.regions.size(), 1u);
}

// The first draw has a quarter of the pixel, which the second one covers with half of it: another quarter is left.
TEST(Regions, WhatIsCoveredAsAWholeTakesItsShareFirst) {
  OnePixel pixel;
  pixel.begin(without_depth(), kRed);
  pixel.left_of(64);
  pixel.begin(without_depth(), kGreen);
  pixel.left_of(128);
  EXPECT_NEAR(pixel.compose().g, 0.5 + 0.5 * kClear.g, 3 * kAreaStep);
}

// Where depth has been cleared, nobody knows any more whose it was.
TEST(Regions, AClearOfDepthMakesRegionsAlike) {
  OnePixel pixel;
  pixel.begin(plain(), kRed);
  pixel.left_of(100);
  pixel.right_of(100);
  pixel.clear_before_next({}, true);
  pixel.everywhere(without_depth(), kGreen);
  EXPECT_EQ(pixel.compose(), kGreen);
  EXPECT_EQ(pixel.regions.size(), 1u);
}

TEST(Regions, WhatIsNoNumberIsStoredAsZero) {
  OnePixel pixel;
  pixel.everywhere(without_depth(), {NAN, 1, 0, 1});
  EXPECT_EQ(pixel.compose().r, 0);
}

// Of seventeen strips of 15/256 px, numbers 3 and 12 differ least.
float gray(int strip) { return strip == 12 ? 3.0f / 17 + 0.02f : static_cast<float>(strip) / 17; }

TEST(Regions, TooManyRegionsBecomeOneOfThoseThatAreAlike) {
  OnePixel pixel;
  double mean = 0;
  for (int strip = 0; strip < 17; ++strip) {
    pixel.begin(without_depth(), glm::vec4(glm::vec3(gray(strip)), 1));
    pixel.right_of(15 * strip);
    mean += gray(strip) * (strip == 16 ? 16 : 15) / 256.0;
  }
  expect_color(pixel.compose(), glm::dvec3(mean), kRounding);
  EXPECT_EQ(pixel.merged, 1);
  EXPECT_EQ(pixel.regions.size(), kMostRegions);
  const auto is_two = [](const Region& region) { return region.positions.count() > 24; };
  ASSERT_EQ(std::ranges::count_if(pixel.regions, is_two), 1);
  EXPECT_NEAR(std::ranges::find_if(pixel.regions, is_two)->color[0], 3.0 / 17 + 0.01, 0.002);
  expect_partition(pixel.regions);
}

// The two that differ least in colour have different stencil values, so two others become one.
TEST(Regions, MergesKeepStencilValuesApart) {
  OnePixel pixel;
  for (int strip = 0; strip < 17; ++strip) {
    pixel.begin(marking({.reference = strip == 12 ? 1u : 0u, .pass = StencilOperation::replace}),
                glm::vec4(glm::vec3(gray(strip)), 1));
    pixel.right_of(15 * strip);
  }
  pixel.compose();
  ASSERT_EQ(pixel.merged, 1);
  const auto marked = std::ranges::find(pixel.regions, 1, &Region::stencil);
  ASSERT_NE(marked, pixel.regions.end());
  EXPECT_NEAR(marked->color[0], 3.0 / 17 + 0.02, kRounding);
  EXPECT_LT(marked->positions.count(), 24u);
}

// Strips of 14/256 px, but one of 28, and the last of 18. Numbers 3 and 12 have the same colour and different depths.
TEST(Regions, AMergeKeepsTheDepthOfTheLargerRegion) {
  for (const int wide : {3, 12}) {
    OnePixel pixel;
    RopRule rule;
    rule.depth = Compare::always;
    for (int strip = 0; strip < 17; ++strip) {
      pixel.begin(rule, glm::vec4(glm::vec3(static_cast<float>(strip == 12 ? 3 : strip) / 16), 1));
      pixel.right_of(14 * (strip + (strip > wide)), strip == 12 ? -0.51f : -0.5f);
    }
    pixel.compose();
    ASSERT_EQ(pixel.merged, 1);
    const auto both = std::ranges::max_element(pixel.regions, {}, [](const Region& r) { return r.positions.count(); });
    EXPECT_NEAR(both->positions.count(), 42, 4);
    EXPECT_EQ(both->plane.z, wide == 12 ? -0.51f : -0.5f);
  }
}

// What the pool on chip has no room for lies in memory, and is the same.
TEST(Regions, TheSizeOfThePoolChangesNoColour) {
  const auto compose = [](OnePixel& pixel, std::size_t bytes) {
    for (int strip = 0; strip < 8; ++strip) {
      pixel.begin(without_depth(), glm::vec4(glm::vec3(static_cast<float>(strip) / 8), 1));
      pixel.right_of(31 * strip);
    }
    return pixel.compose(bytes);
  };
  OnePixel on_chip, in_memory;
  EXPECT_EQ(compose(on_chip, 1 << 20), compose(in_memory, 18));
  EXPECT_EQ(on_chip.spills, 0u);
  EXPECT_GT(in_memory.spills, 0u);
}

// ---- Random streams ----

RopRule random_rule(Random& random) {
  const auto any = [&](auto last) { return static_cast<decltype(last)>(random.int32(0, static_cast<int>(last))); };
  RopRule rule;
  rule.depth = any(Compare::always);
  rule.writes_depth = random.one_in(2);
  rule.has_stencil = random.one_in(2);
  rule.front_is_clockwise = random.one_in(2);
  for (Stencil& stencil : rule.stencil) {
    stencil.function = any(Compare::always);
    stencil.reference = static_cast<std::uint32_t>(random.int32(0, 3));
    stencil.mask = random.one_in(2) ? 255 : 1;
    stencil.write_mask = random.one_in(2) ? 255 : 2;
    stencil.fail = any(StencilOperation::decrement_wrap);
    stencil.depth_fail = any(StencilOperation::decrement_wrap);
    stencil.pass = any(StencilOperation::decrement_wrap);
  }
  if (random.one_in(2)) {
    const auto equation = [&] {
      return BlendEquation{any(BlendFactor::one_minus_constant_alpha), any(BlendFactor::one_minus_constant_alpha),
                           any(BlendOperation::max)};
    };
    rule.blend = Blend{equation(), {}, {}};
    if (random.one_in(2)) rule.blend->alpha = equation();
    for (int c = 0; c < 4; ++c) rule.blend->constant[c] = static_cast<float>(random.int32(0, 4)) / 4;
  }
  if (random.one_in(4)) rule.color_mask = static_cast<std::uint32_t>(random.int32(0, 15));
  return rule;
}

glm::vec4 random_color(Random& random) {
  const auto channel = [&] { return static_cast<float>(random.int32(0, 4)) / 4; };
  return {channel(), channel(), channel(), channel()};
}

// One sample, as the API has it; written without the stages' formulas.
struct Sample {
  double depth = 0;
  int stencil = 0;
  glm::dvec4 color{kClear};

  static bool holds(Compare function, double a, double b) {
    const bool answers[] = {false, a<b, a == b, a <= b, a> b, a != b, a >= b, true};
    return answers[static_cast<int>(function)];
  }
  void take(const RopRule& rule, bool is_front, double z, const glm::dvec4& source) {
    const Stencil& face = rule.stencil[is_front ? 0 : 1];
    const auto update = [&](StencilOperation operation) {
      const int values[] = {stencil,
                            0,
                            int(face.reference),
                            std::min(stencil + 1, 255),
                            std::max(stencil - 1, 0),
                            255 - stencil,
                            (stencil + 1) % 256,
                            (stencil + 255) % 256};
      const int mask = int(face.write_mask), value = values[static_cast<int>(operation)];
      if (rule.has_stencil) stencil = (value & mask) | (stencil & ~mask & 255);
    };
    if (rule.has_stencil && !holds(face.function, int(face.reference & face.mask), stencil & int(face.mask)))
      return update(face.fail);
    if (!holds(rule.depth, z, depth)) return update(face.depth_fail);
    update(face.pass);
    if (rule.writes_depth) depth = z;
    const glm::dvec4 before = color;
    for (int c = 0; c < 4; ++c) {
      double value = source[c];
      if (rule.blend) {
        const BlendEquation& equation = c == 3 && rule.blend->alpha ? *rule.blend->alpha : rule.blend->color;
        const glm::dvec4 k = rule.blend->constant;
        const auto factor = [&](BlendFactor f) {
          const double factors[] = {0,
                                    1,
                                    source[c],
                                    1 - source[c],
                                    source[3],
                                    1 - source[3],
                                    before[c],
                                    1 - before[c],
                                    before[3],
                                    1 - before[3],
                                    c == 3 ? 1 : std::min(source[3], 1 - before[3]),
                                    k[c],
                                    1 - k[c],
                                    k[3],
                                    1 - k[3]};
          return factors[static_cast<int>(f)];
        };
        const double added = source[c] * factor(equation.source), kept = before[c] * factor(equation.destination);
        const double values[] = {added + kept, added - kept, kept - added, std::min(source[c], before[c]),
                                 std::max(source[c], before[c])};
        value = values[static_cast<int>(equation.operation)];
      }
      if (rule.color_mask >> c & 1) color[c] = value;
    }
  }
};

TEST(Regions, DrawsOfWholePixelsAreExact) {
  for (unsigned seed = 0; seed < 3000; ++seed) {
    Random random(seed);
    OnePixel pixel;
    Sample sample;
    double largest = 1;
    for (int i = random.int32(1, 12); i-- > 0;) {
      const RopRule rule = random_rule(random);
      const glm::vec4 color = random_color(random);
      const float z = static_cast<float>(random.int32(-8, 0)) / 8;
      if (random.one_in(6)) pixel.clear_before_next(3u, true), sample.stencil = 3, sample.depth = 0;
      pixel.everywhere(rule, color, z);
      const bool turned = random.one_in(2);
      if (turned) pixel.turn_last_over();
      sample.take(rule, turned != rule.front_is_clockwise, z, color);
      for (int c = 0; c < 4; ++c) largest = std::max(largest, std::abs(sample.color[c]));
    }
    expect_color(pixel.compose(), sample.color, kRounding * largest);
    ASSERT_EQ(pixel.regions.size(), 1u);
    EXPECT_NEAR(pixel.regions[0].color.a, sample.color.a, kRounding * largest);
    EXPECT_EQ(pixel.regions[0].stencil, sample.stencil) << seed;
    if (testing::Test::HasFailure()) FAIL() << "seed " << seed;
  }
}

// Edges divide the pixel, so that areas are those of the mask within a few positions; all colours stay finite.
TEST(Regions, RandomStreamsKeepThePartition) {
  for (const std::size_t words : {std::size_t{1}, kWords}) {
    for (unsigned seed = 0; seed < 300; ++seed) {
      Random random(seed);
      OnePixel pixel(kClear, 0, words);
      for (int i = random.int32(1, 60); i-- > 0;) {
        pixel.begin(random_rule(random), random_color(random));
        for (int k = random.int32(1, 3); k-- > 0;) {
          const auto point = [&] {
            return ScreenPoint{random.int32(-100, 356), random.int32(-100, 356), -random.real32(0, 1)};
          };
          pixel.triangle(point(), point(), point());
        }
      }
      const glm::vec4 color = pixel.compose();
      for (int c = 0; c < 4; ++c) EXPECT_TRUE(std::isfinite(color[c]));
      expect_partition(pixel.regions, words);
      if (testing::Test::HasFailure()) FAIL() << "seed " << seed;
    }
  }
}

TEST(Regions, ThousandsOfLayersStayBounded) {
  Random random(5);
  OnePixel pixel;
  for (int i = 0; i < 5000; ++i) {
    pixel.begin(over(), random_color(random));
    const auto point = [&] { return ScreenPoint{random.int32(-200, 456), random.int32(-200, 456)}; };
    pixel.triangle(point(), point(), point());
  }
  const glm::vec4 color = pixel.compose();
  for (int c = 0; c < 4; ++c) EXPECT_TRUE(color[c] >= 0 && color[c] <= 1.01f);
  expect_partition(pixel.regions);
}

// ---- What they are charged ----

// Of so many layers, each over the whole pixel.
StageCounters counters_of_whole_layers(int layers) {
  OnePixel pixel;
  for (int i = 0; i < layers; ++i) pixel.everywhere(over(), {1, 1, 1, 0.5f});
  pixel.compose();
  return pixel.counters;
}

// A layer that covers a pixel of one region is tested and blended once, and needs no mask.
TEST(Regions, AWholeLayerCostsAsMuchAsOneSample) {
  // Of each of four channels: from fp16 and to it, two products and a sum; one minus alpha for each, too.
  const OperationCounts one = counters_of_whole_layers(1).ops, two = counters_of_whole_layers(2).ops;
  EXPECT_EQ(two.convert - one.convert, 8u);
  EXPECT_EQ(two.mul_add - one.mul_add, 8u);
  EXPECT_EQ(two.add - one.add, 8u);
  EXPECT_EQ(two.bit - one.bit, 0u);
}

// A layer over two regions cuts neither: only the word and both regions are written, and no planes.
TEST(Regions, AWholeLayerWritesNoPlanes) {
  const auto written = [](int layers) {
    OnePixel pixel;
    pixel.begin(without_depth(), kRed);
    pixel.left_of(128);
    for (int i = 0; i < layers; ++i) pixel.everywhere(over(), {1, 1, 1, 0.5f});
    pixel.compose();
    return pixel.counters.bytes_written;
  };
  EXPECT_EQ(written(1) - written(0), kPixelWordBytes + 2 * kRegionBytes);
}

// From the second layer on, the pixel has a record. Layers read a whole fragment (pixel and facing 2 bytes, triangle 3,
// depth plane and nearest depth 16), the pixel's word, its region and a link of two bytes.
TEST(Regions, AWholeLayerReadsNoPositions) {
  const std::uint64_t two = counters_of_whole_layers(2).bytes_read, three = counters_of_whole_layers(3).bytes_read;
  EXPECT_EQ(three - two, (2 + 3 + 16) + kPixelWordBytes + kRegionBytes + 2);
}

// Two regions and two chunks of positions: one chunk fits on chip, three do not. Off chip, three links are read and
// three chunks written, and the next layer reads these. It leaves one region, for which one chunk is read at most to
// move on chip, and the chunks that are given back are linked to the free ones: one write.
TEST(Regions, WhatIsLeftOfARecordMovesOnChip) {
  OnePixel pixel;
  pixel.begin(without_depth(), kRed);
  pixel.left_of(128);
  pixel.everywhere(without_depth(), kGreen);
  EXPECT_EQ(pixel.compose(18), kGreen);
  EXPECT_EQ(pixel.spills, 3u + 3 + 3 + 1 + 1);
}

TEST(Regions, RecordsHoldWhatTheLayoutSays) {
  EXPECT_EQ(region_chunks(1, false, 8), 1u);         // one region, no planes
  EXPECT_EQ(region_chunks(2, true, 8), 2u + 2 + 1);  // a plane of 32 bytes
  EXPECT_EQ(region_chunks(5, false, 8), 6u + 5);     // three
  EXPECT_EQ(region_chunks(16, false, 1), 1u + 16);   // four planes of 4 bytes in one chunk
}

}  // namespace beampipe::compose_regions_test

// Random streams of draws with all of the state that the API knows, against a supersampler that follows OpenGL 4.6
// (sections 14.9, 17.3 and 17.4) draw by draw and sample by sample, and shares no code with the stages.

#include "stages/geometry/draw_plan.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/simd/random.h"
#include "tests/thorough.h"

namespace beampipe::api_order_test {

constexpr std::uint32_t kSize = 16;  // pixels

// The colours of a pixel's regions are fp16, rounded by each draw that blends. In 5,000 streams they add up to 1/1024.
constexpr double kRegionRounding = 1.0 / 512;

struct Corner {
  int x, y;  // 1/256 px
};

struct Shape {
  std::array<Corner, 3> corners;
  double depth;  // window depth, the same everywhere: a multiple of 1/8
  glm::vec4 color;
  std::size_t draw;
};

// ---- The supersampler ----

bool holds(Compare function, double arriving, double stored) {
  const std::array<bool, 8> answers = {false, arriving<stored, arriving == stored, arriving <= stored, arriving> stored,
                                       arriving != stored, arriving >= stored, true};
  return answers[static_cast<std::size_t>(function)];
}

struct Sample {
  double depth = 1;
  int stencil = 0;
  glm::dvec4 color{0.0};

  static void update(const Stencil& of_face, StencilOperation operation, int& value) {
    const auto old = value, reference = static_cast<int>(of_face.reference);
    const std::array<int, 8> results = {
        old, 0, reference, std::min(old + 1, 255), std::max(old - 1, 0), 255 - old, (old + 1) % 256, (old + 255) % 256};
    const auto mask = static_cast<int>(of_face.write_mask);
    value = (results[static_cast<std::size_t>(operation)] & mask) | (old & ~mask & 255);
  }

  static double factor(BlendFactor factor, int c, const glm::dvec4& source, const glm::dvec4& stored,
                       const glm::dvec4& constant) {
    const std::array<double, 15> factors = {0,
                                            1,
                                            source[c],
                                            1 - source[c],
                                            source[3],
                                            1 - source[3],
                                            stored[c],
                                            1 - stored[c],
                                            stored[3],
                                            1 - stored[3],
                                            c == 3 ? 1 : std::min(source[3], 1 - stored[3]),
                                            constant[c],
                                            1 - constant[c],
                                            constant[3],
                                            1 - constant[3]};
    return factors[static_cast<std::size_t>(factor)];
  }

  void take(const DrawState& state, bool is_front, double at, const glm::dvec4& source) {
    const std::optional<Stencil>& tested = is_front || !state.stencil_back ? state.stencil : state.stencil_back;
    const bool has_stencil = state.stencil || state.stencil_back;
    const Stencil of_face = tested.value_or(Stencil{});
    if (has_stencil) {
      const auto mask = static_cast<int>(of_face.mask);
      if (!holds(of_face.function, static_cast<int>(of_face.reference) & mask, stencil & mask))
        return update(of_face, of_face.fail, stencil);
    }
    if (state.depth.test && !holds(state.depth.function, at, depth)) {
      if (has_stencil) update(of_face, of_face.depth_fail, stencil);
      return;
    }
    if (has_stencil) update(of_face, of_face.pass, stencil);
    if (state.depth.test && state.depth.write) depth = at;
    glm::dvec4 result = source;
    for (int c = 0; state.blend && c < 4; ++c) {
      const BlendEquation& equation = c == 3 && state.blend->alpha ? *state.blend->alpha : state.blend->color;
      const double added = source[c] * factor(equation.source, c, source, color, state.blend->constant);
      const double kept = color[c] * factor(equation.destination, c, source, color, state.blend->constant);
      const std::array<double, 5> results = {added + kept, added - kept, kept - added, std::min(source[c], color[c]),
                                             std::max(source[c], color[c])};
      result[c] = results[static_cast<std::size_t>(equation.operation)];
    }
    for (int c = 0; c < 4; ++c)
      if (state.color_mask >> c & 1) color[c] = result[c];
  }
};

// Twice the area that (x, y) spans with an edge; positive inside if the triangle turns that way.
long long side(const Corner& a, const Corner& b, int x, int y) {
  return static_cast<long long>(b.x - a.x) * (y - a.y) - static_cast<long long>(b.y - a.y) * (x - a.x);
}

// Is the place in the triangle? On an edge: if that is a left or an upper one.
bool covers(const Shape& shape, int x, int y) {
  std::array<Corner, 3> c = shape.corners;
  if (side(c[0], c[1], c[2].x, c[2].y) < 0) std::swap(c[1], c[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Corner &a = c[k], &b = c[(k + 1) % 3];
    const long long inside = side(a, b, x, y);
    const bool is_left_or_top = b.y < a.y || (b.y == a.y && b.x > a.x);
    if (inside < 0 || (inside == 0 && !is_left_or_top)) return false;
  }
  return true;
}

bool holds_place(const Scissor& scissor, int x, int y) {  // in 1/256 px
  const auto holds = [](std::int32_t first, std::uint32_t count, int place) {
    return place >= 256 * first && place < 256 * (first + static_cast<int>(count));
  };
  return holds(scissor.x, scissor.width, x) && holds(scissor.y, scissor.height, y);
}

// ---- Random streams ----

template <class Enum>
Enum any_of(Random& random, int count) {
  return static_cast<Enum>(random.int32(0, count - 1));
}

BlendEquation random_equation(Random& random) {
  return {any_of<BlendFactor>(random, 15), any_of<BlendFactor>(random, 15), any_of<BlendOperation>(random, 5)};
}

Stencil random_stencil(Random& random) {
  Stencil stencil;
  stencil.function = any_of<Compare>(random, 8);
  stencil.reference = static_cast<std::uint32_t>(random.int32(0, 3));
  stencil.mask = random.one_in(3) ? 255 : 3;
  stencil.write_mask = random.one_in(3) ? 1 : 255;
  stencil.fail = any_of<StencilOperation>(random, 8);
  stencil.depth_fail = any_of<StencilOperation>(random, 8);
  stencil.pass = any_of<StencilOperation>(random, 8);
  return stencil;
}

DrawState random_state(Random& random) {
  DrawState state;
  state.depth.test = !random.one_in(4);
  state.depth.write = !random.one_in(3);
  state.depth.function = random.one_in(2) ? Compare::less_equal : any_of<Compare>(random, 8);
  state.depth.cleared_before = random.one_in(6);
  state.front_is_clockwise = random.one_in(2);
  if (!random.one_in(3)) {
    state.blend = Blend{random_equation(random), {}, {}};
    if (random.one_in(2)) state.blend->alpha = random_equation(random);
    for (int c = 0; c < 4; ++c) state.blend->constant[c] = static_cast<float>(random.int32(0, 4)) / 4;
  }
  state.alpha_to_coverage = random.one_in(4);
  if (random.one_in(3)) state.color_mask = static_cast<std::uint32_t>(random.int32(0, 15));
  if (random.one_in(2)) state.stencil = random_stencil(random);
  if (state.stencil && random.one_in(2)) state.stencil_back = random_stencil(random);
  if (random.one_in(6)) state.stencil_cleared_to = static_cast<std::uint32_t>(random.int32(0, 3));
  return state;
}

// Mostly what depths express: draws that pass where they are less, with few exceptions.
DrawState calm_state(Random& random) {
  DrawState state;
  const auto rarely = [&] { return random.one_in(10); };
  if (random.one_in(2)) state.depth.function = Compare::less_equal;
  if (rarely()) state.depth.function = any_of<Compare>(random, 8);
  if (rarely()) state.depth.test = false;
  if (rarely()) state.depth.write = false;
  if (rarely()) state.depth.clip = false;
  if (rarely()) state.depth.cleared_before = true;
  if (rarely()) state.color_mask = 0;
  if (rarely()) state.blend = Blend{{BlendFactor::one, BlendFactor::zero}, {}, {}};
  if (rarely()) state.stencil = Stencil{.function = Compare::always, .pass = StencilOperation::replace};
  if (random.one_in(20)) state.stencil_back = random_stencil(random);
  return state;
}

struct Stream {
  Trace trace;
  std::vector<Shape> shapes;

  Frame& frame() { return trace.frames[0]; }

  // `makes_corners`: of the triangles of a draw.
  Stream(Random& random, const std::function<std::vector<std::array<Corner, 3>>()>& makes_corners) {
    trace = pixel_trace(kSize, kSize, {});
    trace.meshes.clear();
    frame().draws.clear();
    frame().background = {0.25f, 0.5f, 0.125f};
    frame().background_alpha = 0.5f;
    const int draws = random.int32(2, 9);
    const bool is_calm = random.one_in(2);
    for (int d = 0; d < draws; ++d) {
      Draw draw;
      draw.mesh = static_cast<std::uint32_t>(d);
      draw.state = is_calm ? calm_state(random) : random_state(random);
      if (random.one_in(10))
        draw.state.scissor =
            Scissor{random.int32(0, 8), random.int32(0, 8), static_cast<std::uint32_t>(random.int32(1, 16)),
                    static_cast<std::uint32_t>(random.int32(1, 16))};
      draw.material = static_cast<std::uint32_t>(d);
      Material material;
      material.name = "m" + std::to_string(d);
      material.unlit = material.double_sided = true;
      material.alpha_mode = draw.state.blend               ? AlphaMode::blend
                            : draw.state.alpha_to_coverage ? AlphaMode::mask
                                                           : AlphaMode::opaque;
      material.alpha_cutoff = 0;
      for (int c = 0; c < 4; ++c) material.base_color[c] = static_cast<float>(random.int32(0, 4)) / 4;
      Mesh mesh;
      mesh.name = material.name;
      // Often triangles that another draw has drawn already.
      std::vector<Shape> arriving;
      const auto earlier = static_cast<std::size_t>(random.int32(0, std::max(0, d - 1)));
      if (d > 0 && random.one_in(4)) {
        std::ranges::copy_if(shapes, std::back_inserter(arriving),
                             [&](const Shape& shape) { return shape.draw == earlier; });
      } else {
        for (const std::array<Corner, 3>& corners : makes_corners())
          arriving.push_back({corners, random.int32(0, 8) / 8.0, {}, 0});
      }
      for (const auto& [corners, depth, unused, of_draw] : arriving) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const Corner& corner : corners) mesh.positions.emplace_back(corner.x / 256.0, corner.y / 256.0, depth);
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        glm::vec4 color = material.base_color;
        if (material.alpha_mode == AlphaMode::opaque) color.a = 1;
        shapes.push_back({corners, depth, color, static_cast<std::size_t>(d)});
      }
      mesh.colors.assign(mesh.triangles.size(), glm::vec3(1));
      trace.materials.push_back(material);
      trace.meshes.push_back(mesh);
      if (d == 0) draw.state.depth.cleared_before = true;  // a frame without any state has no order
      frame().draws.push_back(draw);
    }
  }

  // At a place, in 1/256 px. `rank`: of the place in its pixel. Alpha that is larger covers it, where it is coverage.
  glm::dvec3 at(int x, int y, double clear_depth, double rank) const {
    const Frame& frame = trace.frames[0];
    Sample sample;
    sample.color = glm::dvec4(frame.background, frame.background_alpha);
    sample.depth = clear_depth;
    std::size_t next = 0;
    for (std::size_t d = 0; d < frame.draws.size(); ++d) {
      const DrawState& state = frame.draws[d].state;
      if (state.depth.cleared_before) sample.depth = clear_depth;
      if (state.stencil_cleared_to) sample.stencil = static_cast<int>(*state.stencil_cleared_to);
      for (; next < shapes.size() && shapes[next].draw == d; ++next) {
        const Shape& shape = shapes[next];
        if (state.scissor && !holds_place(*state.scissor, x, y)) continue;
        if (!covers(shape, x, y) || (state.alpha_to_coverage && shape.color.a < rank)) continue;
        const auto& c = shape.corners;
        // y points down, so what turns clockwise in the picture has a positive area here.
        const bool is_clockwise = side(c[0], c[1], c[2].x, c[2].y) > 0;
        sample.take(state, is_clockwise == state.front_is_clockwise, shape.depth, shape.color);
      }
    }
    return sample.color;
  }

  // Is the place within 1/256 px of an edge of a triangle that a scissor cuts? Corners at the cut are snapped.
  bool is_at_cut_edge(int x, int y) const {
    return std::ranges::any_of(shapes, [&](const Shape& shape) {
      if (!trace.frames[0].draws[shape.draw].state.scissor) return false;
      for (std::size_t k = 0; k < 3; ++k) {
        const Corner &a = shape.corners[k], &b = shape.corners[(k + 1) % 3];
        if (std::abs(static_cast<double>(side(a, b, x, y))) <= std::hypot(b.x - a.x, b.y - a.y)) return true;
      }
      return false;
    });
  }

  // Where triangles that write depth compare with greater, depth is cleared to 0.
  double clear_depth() const {
    long less = 0, greater = 0;
    for (const Shape& shape : shapes) {
      const DepthState& depth = trace.frames[0].draws[shape.draw].state.depth;
      if (!depth.test || !depth.write) continue;
      less += depth.function == Compare::less || depth.function == Compare::less_equal;
      greater += depth.function == Compare::greater || depth.function == Compare::greater_equal;
    }
    return greater > less ? 0 : 1;
  }
};

void expect_picture(const Stream& stream, const std::string& spec, const std::vector<std::array<int, 2>>& places,
                    double tolerance) {
  const Image image = render_unmodelled(spec, stream.trace).image;
  const double clear_depth = stream.clear_depth();
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      if (std::ranges::any_of(places, [&](const std::array<int, 2>& at) {
            return stream.is_at_cut_edge(static_cast<int>(256 * x) + at[0], static_cast<int>(256 * y) + at[1]);
          }))
        continue;
      const float* const found = &image.rgba[4 * (y * kSize + x)];
      const auto mean_of = [&](const std::array<double, 4>& ranks) {
        glm::dvec3 mean(0.0);
        for (std::size_t k = 0; k < places.size(); ++k)
          mean += stream.at(static_cast<int>(256 * x) + places[k][0], static_cast<int>(256 * y) + places[k][1],
                            clear_depth, ranks[k]) /
                  static_cast<double>(places.size());
        return mean;
      };
      const auto is_near = [&](const glm::dvec3& mean) {
        for (int c = 0; c < 3; ++c)
          if (!(std::abs(found[c] - mean[c]) <= tolerance * std::max(1.0, std::abs(mean[c])))) return false;
        return true;
      };
      // Alphas are quarters. In which order they cover the samples of a pixel is the technique's choice.
      std::array<double, 4> ranks = {0.125, 0.375, 0.625, 0.875};
      const glm::dvec3 first = mean_of(ranks);
      bool is_any = is_near(first);
      while (!is_any && std::ranges::next_permutation(ranks).found) is_any = is_near(mean_of(ranks));
      ASSERT_TRUE(is_any) << spec << " at " << x << ", " << y << ": " << found[0] << ", " << found[1] << ", "
                          << found[2] << "; in the first order " << first.x << ", " << first.y << ", " << first.z;
    }
  }
}

std::vector<std::array<Corner, 3>> random_triangles(Random& random) {
  std::vector<std::array<Corner, 3>> triangles(static_cast<std::size_t>(random.int32(1, 4)));
  for (auto& corners : triangles) do {
      for (Corner& corner : corners) corner = {random.int32(0, 4096), random.int32(0, 4096)};
    } while (side(corners[0], corners[1], corners[2].x, corners[2].y) == 0);
  return triangles;
}

// The standard positions of Direct3D and Vulkan, in 1/256 px from the upper left corner.
const std::vector<std::array<int, 2>> kOne = {{128, 128}}, kFour = {{96, 32}, {224, 96}, {32, 160}, {160, 224}};

TEST(ApiOrder, MultisamplingFollowsRandomStreams) {
  const int streams = 500 * thoroughness();
  int by_depth = 0;
  for (int seed = 0; seed < streams; ++seed) {
    Random random(static_cast<unsigned>(seed));
    const Stream stream(random, [&] { return random_triangles(random); });
    by_depth += !needs_api_order(stream.trace, stream.trace.frames[0]);
    expect_picture(stream, "msaa:1,color=rgba32f", kOne, 1e-5);
    expect_picture(stream, "msaa:4,color=rgba32f", kFour, 1e-5);
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
  EXPECT_GT(by_depth, streams / 20) << "frames that are drawn by depth count too";
}

TEST(ApiOrder, TheReferenceAndBeamFollowRandomStreams) {
  const int streams = 25 * thoroughness();
  int compared = 0;  // pixels
  for (int seed = 0; seed < streams; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<unsigned>(seed) + 1000000);
    // Boxes of whole pixels, so that one place tells of a whole pixel. Their diagonals share samples out.
    const Stream stream(random, [&] {
      const auto place = [&] { return 256 * random.int32(0, 15); };
      const int x = place(), y = place(), width = place() + 256, height = place() + 256;
      const Corner a{x, y}, b{x + width, y}, c{x + width, y + height}, d{x, y + height};
      std::vector<std::array<Corner, 3>> box = {{a, b, c}, {a, c, d}};
      if (random.one_in(2)) box = {{a, c, b}, {a, d, c}};
      return box;
    });
    // The triangles of a box have different depths, so pixels at a diagonal differ.
    const Image image = render_unmodelled("reference", stream.trace).image;
    const Image beam = render_unmodelled("beam", stream.trace).image;
    const double clear_depth = stream.clear_depth();
    for (std::uint32_t y = 0; y < kSize; ++y) {
      for (std::uint32_t x = 0; x < kSize; ++x) {
        glm::dvec3 expected(0.0);
        for (const double rank : {0.125, 0.375, 0.625, 0.875})
          expected +=
              0.25 * stream.at(static_cast<int>(256 * x) + 128, static_cast<int>(256 * y) + 128, clear_depth, rank);
        bool is_whole = true;
        for (const Shape& shape : stream.shapes) {
          const auto part = [&](int u, int v) {
            return covers(shape, static_cast<int>(256 * x) + u, static_cast<int>(256 * y) + v);
          };
          is_whole =
              is_whole && part(1, 1) == part(254, 1) && part(1, 1) == part(1, 254) && part(1, 1) == part(254, 254);
        }
        if (!is_whole) continue;
        ++compared;
        for (std::size_t c = 0; c < 3; ++c) {
          const double wanted = expected[static_cast<int>(c)], scale = std::max(1.0, std::abs(wanted));
          ASSERT_NEAR(image.rgba[4 * (y * kSize + x) + c], wanted, 1e-5 * scale) << x << ", " << y << ", channel " << c;
          ASSERT_NEAR(beam.rgba[4 * (y * kSize + x) + c], wanted, kRegionRounding * scale)
              << "beam at " << x << ", " << y << ", channel " << c;
        }
      }
    }
  }
  EXPECT_GT(compared, streams * int{kSize * kSize} / 2);
}

// Many samples converge to the reference: half the samples' error in each step of four.
TEST(ApiOrder, MultisamplingConvergesToTheReference) {
  for (int seed = 0; seed < 10; ++seed) {
    Random random(static_cast<unsigned>(seed) + 2000000);
    const Stream stream(random, [&] { return random_triangles(random); });
    const Image reference = render_unmodelled("reference", stream.trace).image;
    const auto error = [&](const char* spec) {
      const Image image = render_unmodelled(spec, stream.trace).image;
      double sum = 0, scale = 0;
      for (std::size_t i = 0; i < image.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        const double difference = image.rgba[i] - reference.rgba[i];
        sum += difference * difference;
        scale += double{reference.rgba[i]} * reference.rgba[i];
      }
      return std::sqrt(sum / (scale + 1));
    };
    EXPECT_LT(error("msaa:1024,color=rgba32f"), 0.01);
    EXPECT_LE(error("msaa:1024,color=rgba32f"), error("msaa:4,color=rgba32f"));
  }
}

// Half of a pixel shows a lamp of luminance 9, the other half white: 9/10 and 1/2, whose mean of 0.7 stands for 7/3.
TEST(ApiOrder, MultisamplingResolvesInReinhardsSpace) {
  std::vector<PixelSpaceTriangle> triangles = quad(-1, -1, 4.5, 9, 0.5, glm::vec3(9));
  append(triangles, quad(4.5, -1, 9, 9, 0.5, glm::vec3(1)));
  Trace trace = pixel_trace(8, 8, triangles);
  trace.frames[0].draws[0].state.stencil = Stencil{.function = Compare::always};
  trace.frames[0].draws[0].state.depth.function = Compare::always;
  ASSERT_TRUE(needs_api_order(trace, trace.frames[0]));
  const auto red = [&](const char* spec, std::uint32_t x) {
    return pixel(render_unmodelled(spec, trace).image, x, 4)[0];
  };
  EXPECT_NEAR(red("msaa:4,color=rgba32f,resolve=reinhard", 4), 7.0 / 3, 1e-5);
  EXPECT_NEAR(red("msaa:4,color=rgba32f", 4), 5, 1e-5);
  EXPECT_NEAR(red("msaa:4,color=rgba32f,resolve=reinhard", 2), 9, 1e-4);
}

// A triangle over the whole picture, whose window depth is `left` at the left edge and changes by `step` in each pixel.
Mesh slope(double left, double step, const glm::vec3& color) {
  const auto at = [&](double x, double y) { return glm::dvec3(x, y, left + step * x); };
  return pixel_trace(kSize, kSize, {{{at(0, 0), at(32, 0), at(0, 32)}, color}}).meshes[0];
}

Trace slopes(const std::vector<Mesh>& meshes) {
  Trace trace = pixel_trace(kSize, kSize, {});
  trace.meshes = meshes;
  trace.frames[0].draws.clear();
  for (std::uint32_t i = 0; i < meshes.size(); ++i) trace.frames[0].draws.push_back(Draw{.mesh = i});
  return trace;
}

void expect_color(const Trace& trace, std::uint32_t x, const glm::vec3& color) {
  for (const char* spec : {"msaa:1", "msaa:4", "beam", "reference"})
    EXPECT_EQ(pixel(render_unmodelled(spec, trace).image, x, 3), color) << spec << ", column " << x;
}

// A bias towards the viewer decides ties, also of a triangle that lies partly before the near plane.
TEST(ApiOrder, BiasCountsUpToTheNearPlane) {
  Trace trace = slopes({slope(-0.25, 1.0 / 32, {1, 0, 0}), slope(-0.25, 1.0 / 32, {0, 1, 0})});
  trace.frames[0].draws[1].state.depth.bias.constant = -0.01f;
  expect_color(trace, 2, trace.frames[0].background);  // before the near plane
  expect_color(trace, 12, {0, 1, 0});
}

// A bias of 0.25 takes what is farther than 0.75 to the end, which is not less than where depth was cleared to.
TEST(ApiOrder, BiasEndsWhereDepthIsCleared) {
  Trace trace = slopes({slope(0, 1.0 / 16, {1, 0, 0})});
  trace.frames[0].draws[0].state.depth.bias.constant = 0.25f;
  expect_color(trace, 6, {1, 0, 0});
  expect_color(trace, 13, trace.frames[0].background);
}

// Whole coverage by alpha does not change depths, at which the same triangle is drawn again.
TEST(ApiOrder, CoverageByAlphaKeepsDepths) {
  Trace trace = slopes({slope(0.1, 1.0 / 37, {1, 0, 0}), slope(0.1, 1.0 / 37, {1, 1, 1})});
  Material material;
  material.name = "green";
  material.unlit = material.double_sided = true;
  material.alpha_mode = AlphaMode::blend;
  material.base_color = {0, 1, 0, 1};
  trace.materials.push_back(material);
  trace.frames[0].draws[1].material = 0;
  DrawState& state = trace.frames[0].draws[1].state;
  state.depth.function = Compare::equal, state.alpha_to_coverage = true;
  state.blend = Blend{{BlendFactor::one, BlendFactor::zero}, {}, {}};
  expect_color(trace, 6, {0, 1, 0});
}

// Draws that are not clipped limit depths to their own range, 0 to 0.5 here, also after the bias: 0.45 + 0.25 is 0.5,
// nearer than 0.6.
TEST(ApiOrder, DepthsThatAreNotClippedStayInTheirRange) {
  Trace trace = slopes({slope(0.9, 0, {1, 0, 0}), slope(0.6, 0, {0, 1, 0})});
  DrawState& state = trace.frames[0].draws[0].state;
  state.depth.far = 0.5f, state.depth.clip = false, state.depth.bias.constant = 0.25f;
  expect_color(trace, 6, {1, 0, 0});
}

// What moves between the units and their caches for a tile of 8-bit RGBA: a stencil test reads a word of each pixel,
// blending reads and writes a colour.
TEST(ApiOrder, MovesWhatDrawsReadAndWrite) {
  struct Moved {
    std::uint64_t depth_test = 0, blend = 0;
  };
  const auto moved = [](const std::vector<DrawState>& states) {
    Trace trace = pixel_trace(kSize, kSize, {});
    trace.meshes.clear();
    trace.frames[0].draws.clear();
    for (std::size_t i = 0; i < states.size(); ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      trace.meshes.push_back(pixel_trace(kSize, kSize, {covering(0.5)}).meshes[0]);
      Draw draw;
      draw.mesh = number;
      draw.state = states[i];
      trace.frames[0].draws.push_back(draw);
    }
    FrameInput run;
    run.memory.compression = false;
    const FrameResult result = parse_technique("msaa:1,color=rgba8").render(trace, 0, run);
    return Moved{find_counters(result.stages, {StageId::depth_test})->sector_bytes,
                 find_counters(result.stages, {StageId::blend})->sector_bytes};
  };
  constexpr std::uint64_t kTile = kSize * kSize * 4;
  DrawState untested;
  untested.depth.test = false;
  untested.stencil = Stencil{.function = Compare::equal, .mask = 0};  // which passes
  DrawState blended = untested;
  blended.blend = Blend{{BlendFactor::one, BlendFactor::one}, {}, {}};
  DrawState written = untested;
  written.stencil->pass = StencilOperation::replace;
  DrawState free = blended;
  free.stencil.reset();
  struct Row {
    std::vector<DrawState> states;
    std::uint64_t depth_test, blend;  // tiles
  };
  for (const Row& row : {Row{{untested}, 1, 1}, Row{{written}, 2, 1}, Row{{blended}, 1, 2},
                         Row{{untested, blended}, 2, 3}, Row{{untested, free}, 1, 3}}) {
    const Moved found = moved(row.states);
    EXPECT_EQ(found.depth_test, row.depth_test * kTile);
    EXPECT_EQ(found.blend, row.blend * kTile);
  }
}

// A red surface, and then half of green is added and a quarter of all is kept.
TEST(ApiOrder, HistoriesHaveTheWeightsOfBlending) {
  Trace trace = pixel_trace(kSize, kSize, {covering(0.5, {1, 0, 0})}, glm::vec3(0.5f));
  trace.meshes.push_back(trace.meshes[0]);
  trace.meshes[1].colors = {{0, 1, 0}};
  trace.frames[0].draws.push_back(Draw{.mesh = 1});
  DrawState& state = trace.frames[0].draws[1].state;
  state.depth.test = false;
  state.stencil = Stencil{.function = Compare::equal, .mask = 0};  // which passes
  state.blend = Blend{{BlendFactor::constant_alpha, BlendFactor::constant}, {}, {0.25f, 0.25f, 0.25f, 0.5f}};
  const std::vector<PixelAddress> pixels = {{3, 4}};
  FrameInput run;
  run.pixels = &pixels;
  std::vector<PixelHistory> histories;
  parse_technique("msaa:4,color=rgba32f").render(trace, 0, run, {.histories = &histories});
  ASSERT_EQ(histories.size(), 1u);
  EXPECT_EQ(histories[0].pixel, glm::vec4(0.25f, 0.5f, 0, 1));
  double red = 0, green = 0, background = 0;
  for (const HistoryTerm& term : histories[0].terms) {
    if (term.fragment == kNobody) {
      background += term.weight;
    } else {
      (histories[0].fragments[term.fragment].draw == 0 ? red : green) += term.weight;
    }
  }
  EXPECT_NEAR(red, 0.25, 1e-9);
  EXPECT_NEAR(green, 0.5, 1e-9);
  EXPECT_NEAR(background, 0, 1e-9);
}

}  // namespace beampipe::api_order_test

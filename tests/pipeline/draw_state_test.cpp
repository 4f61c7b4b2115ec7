// Fixed-function state in pictures: random frames of quads that cover whole pixels, against a depth buffer that follows
// the rules of OpenGL draw by draw.

#include "pipeline/technique_table.h"
#include "stages/geometry/draw_plan.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/simd/random.h"
#include "tests/thorough.h"

namespace beampipe::draw_state_test {

constexpr std::int32_t kSize = 20;  // pixels

constexpr double kRounding = 4e-3;

// How far a technique may be off, by what it says that it errs by; nothing: it shows other pictures than a depth
// buffer.
std::optional<double> tolerance_of(const Technique& technique) {
  const auto errs_by = [&](ErrorSource source) { return std::ranges::count(technique.errs_by, source) > 0; };
  // The background shines through along the diagonals of quads, or all triangles of equal depth are added.
  if (errs_by(ErrorSource::independent_fragments) || errs_by(ErrorSource::double_counting)) return std::nullopt;
  // Of many frames some have what the first ones have not.
  const bool are_many = thoroughness() > 1;
  if (errs_by(ErrorSource::published_merges)) return are_many ? 0.125 : 0.0625;  // fragments that lie close in depth
  if (are_many && errs_by(ErrorSource::merges_of_layers)) return 0.25;           // where there are more than three
  // Owners become one before all have been seen.
  if (are_many && technique.counted_positions > 0) return 2.0 / technique.counted_positions;
  return std::max(kRounding, technique.rounding_error);
}

struct Box {
  std::int32_t x0, y0, x1, y1;  // pixels
  bool holds(std::int32_t x, std::int32_t y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

struct Quad {
  Box box;
  double depth;  // 0..1 in the clip volume
  glm::vec3 color;
};

// A frame, and what it shows.
class Program {
 public:
  explicit Program(Random& random) : random_(random) {
    frame_.width = frame_.height = kSize;
    frame_.background = glm::vec3(0.25f, 0.5f, 0.75f);
    color_.assign(kSize * kSize, frame_.background);
    clear_depth(1);
  }

  void clear_depth(double depth) { depth_.assign(kSize * kSize, depth); }

  DrawState random_place() {
    DrawState state;
    if (random_.one_in(3)) {
      const Box box = random_box();
      state.viewport = Viewport{float(box.x0), float(box.y0), float(box.x1 - box.x0), float(box.y1 - box.y0)};
      if (random_.one_in(3)) state.viewport->y += state.viewport->height, state.viewport->height *= -1;
    }
    if (random_.one_in(3)) {
      const Box box = random_box();
      state.scissor = Scissor{box.x0, box.y0, std::uint32_t(box.x1 - box.x0), std::uint32_t(box.y1 - box.y0)};
    }
    if (random_.one_in(3)) state.depth.near = 0.25f, state.depth.far = 0.75f;
    return state;
  }

  std::vector<Quad> random_quads() {
    std::vector<Quad> quads(static_cast<std::size_t>(random_.integer(1, 3)));
    for (Quad& quad : quads) {
      quad = {random_box(), static_cast<double>(random_.integer(1, 15)) / 16, glm::vec3(0)};
      for (int c = 0; c < 3; ++c) quad.color[c] = static_cast<float>(random_.integer(0, 8)) / 8;
    }
    return quads;
  }

  void draw(const DrawState& state, const std::vector<Quad>& quads) {
    add(state, quads);
    for (const Quad& quad : quads)
      for (std::int32_t y = 0; y < kSize; ++y)
        for (std::int32_t x = 0; x < kSize; ++x)
          if (quad.box.holds(x, y) && is_touched(state, x, y)) rasterize(state, quad, y * kSize + x);
  }

  Trace trace() const {
    Trace trace = trace_;
    trace.frames = {frame_};
    return trace;
  }
  const glm::vec3& color(std::uint32_t x, std::uint32_t y) const { return color_[y * kSize + x]; }

 private:
  Box random_box() {
    using Side = std::pair<std::int32_t, std::int32_t>;
    const auto side = [&]() -> Side {
      const std::int32_t a = random_.int32(0, kSize - 1), b = random_.int32(0, kSize - 1);
      return {std::min(a, b), std::max(a, b) + 1};
    };
    const Side x = side(), y = side();
    return {x.first, y.first, x.second, y.second};
  }

  static bool is_touched(const DrawState& state, std::int32_t x, std::int32_t y) {
    if (state.scissor) {
      const auto right = state.scissor->x + std::int32_t(state.scissor->width);
      const auto bottom = state.scissor->y + std::int32_t(state.scissor->height);
      if (!Box{state.scissor->x, state.scissor->y, right, bottom}.holds(x, y)) return false;
    }
    if (!state.viewport) return true;
    const Viewport& v = *state.viewport;
    const float top = std::min(v.y, v.y + v.height), bottom = std::max(v.y, v.y + v.height);
    return x >= v.x && x < v.x + v.width && y >= top && y < bottom;
  }

  void rasterize(const DrawState& state, const Quad& quad, std::int32_t pixel) {
    const double depth = state.depth.near + (double{state.depth.far} - state.depth.near) * quad.depth;
    double& stored = depth_[static_cast<std::size_t>(pixel)];
    if (state.depth.test) {
      switch (state.depth.function) {
        case Compare::less:
          if (!(depth < stored)) return;
          break;
        case Compare::less_equal:
          if (!(depth <= stored)) return;
          break;
        case Compare::greater:
          if (!(depth > stored)) return;
          break;
        case Compare::greater_equal:
          if (!(depth >= stored)) return;
          break;
        case Compare::equal:
          if (depth != stored) return;
          break;
        default:
          FAIL() << "not in these frames";
      }
      if (state.depth.write) stored = depth;
    }
    if (state.color_mask != 0) color_[static_cast<std::size_t>(pixel)] = quad.color;
  }

  void add(const DrawState& state, const std::vector<Quad>& quads) {
    const Viewport view = state.viewport.value_or(Viewport{0, 0, kSize, kSize});
    Mesh mesh;
    for (const Quad& quad : quads) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const glm::ivec2& corner : {glm::ivec2(quad.box.x0, quad.box.y0), glm::ivec2(quad.box.x1, quad.box.y0),
                                       glm::ivec2(quad.box.x1, quad.box.y1), glm::ivec2(quad.box.x0, quad.box.y1)}) {
        constexpr float kWs[] = {0.5f, 1.0f, 4.0f};
        const float w = kWs[mesh.ws.size() / 4 % 3];  // the same for a quad, so that crossing points have its depth
        mesh.positions.emplace_back(w * (2 * (float(corner.x) - view.x) / view.width - 1),
                                    w * (1 - 2 * (float(corner.y) - view.y) / view.height),
                                    w * static_cast<float>(2 * quad.depth - 1));
        mesh.ws.push_back(w);
      }
      mesh.triangles.emplace_back(first, first + 1, first + 2);
      mesh.triangles.emplace_back(first, first + 2, first + 3);
      mesh.colors.insert(mesh.colors.end(), 2, quad.color);
    }
    Draw& draw = frame_.draws.emplace_back();
    draw.state = state;
    draw.mesh = static_cast<std::uint32_t>(trace_.meshes.size());
    trace_.meshes.push_back(mesh);
  }

  Random& random_;
  Trace trace_;
  Frame frame_;
  std::vector<double> depth_;
  std::vector<glm::vec3> color_;
};

// Skies, the world and displays, in one to three groups between depth clears. Equal depths are frequent.
Program random_program(Random& random) {
  Program program(random);
  bool cleared = false;
  const auto state_of = [&](bool test, bool write, Compare function) {
    DrawState state = program.random_place();
    state.depth.test = test, state.depth.write = write, state.depth.function = function;
    state.depth.cleared_before = std::exchange(cleared, false);
    return state;
  };
  const bool reversed = random.one_in(3);
  const std::array functions =
      reversed ? std::array{Compare::greater, Compare::greater_equal} : std::array{Compare::less, Compare::less_equal};
  for (std::int64_t groups = random.integer(1, 3), group = 0; group < groups; ++group) {
    program.clear_depth(reversed ? 0 : 1);
    cleared = group > 0;
    for (std::int64_t i = random.integer(0, 2); i-- > 0;)
      program.draw(state_of(random.one_in(2), false, random.pick(functions)), program.random_quads());
    // The untested ones write no depth, whatever they say.
    for (std::int64_t i = random.integer(0, 1); i-- > 0;)
      program.draw(state_of(false, true, Compare::never), program.random_quads());
    for (std::int64_t i = random.integer(1, 4); i-- > 0;) {
      const DrawState state = state_of(true, true, random.pick(functions));
      const std::vector<Quad> quads = program.random_quads();
      if (random.one_in(4)) {  // a pre-pass, and perhaps something between it and its draw
        DrawState pre_pass = state, after = state;
        pre_pass.color_mask = 0, pre_pass.depth.function = functions[0];
        after.depth.cleared_before = false;
        after.depth.function = random.one_in(2) ? Compare::equal : functions[1];
        program.draw(pre_pass, quads);
        if (random.one_in(2)) program.draw(state_of(true, true, random.pick(functions)), program.random_quads());
        program.draw(after, quads);
      } else {
        program.draw(state, quads);
      }
    }
    for (std::int64_t i = random.integer(0, 2); i-- > 0;)
      program.draw(state_of(false, true, Compare::less), program.random_quads());
  }
  return program;
}

TEST(DrawStatePictures, RandomFramesEqualADepthBuffer) {
  int covered = 0, seen = 0;       // pixels
  std::map<std::string, int> off;  // channels of pixels that are off by more than rounding
  for (std::uint64_t seed = 1; seed <= 40u * static_cast<unsigned>(thoroughness()); ++seed) {
    Random random(seed);
    const Program program = random_program(random);
    const Trace trace = program.trace();
    ASSERT_TRUE(plan_draws(trace, trace.frames[0]).notes.empty()) << plan_draws(trace, trace.frames[0]).notes[0].reason;
    for (const std::string& spec : stressed_specs()) {
      const std::optional<double> tolerance = tolerance_of(parse_technique(spec));
      if (!tolerance) continue;
      const Image image = picture(spec, trace);
      for (std::uint32_t y = 0; y < kSize; ++y)
        for (std::uint32_t x = 0; x < kSize; ++x)
          for (int c = 0; c < 3; ++c) {
            const double found = pixel(image, x, y)[c], expected = program.color(x, y)[c];
            ASSERT_NEAR(found, expected, *tolerance) << spec << ", pixel " << x << ", " << y;
            off[spec] += std::abs(found - expected) > kRounding;
          }
    }
    seen += kSize * kSize;
    for (std::uint32_t y = 0; y < kSize; ++y)
      for (std::uint32_t x = 0; x < kSize; ++x) covered += program.color(x, y) != trace.frames[0].background;
  }
  EXPECT_GT(covered, 40 * kSize * kSize / 4);
  for (const auto& [spec, channels] : off) EXPECT_LE(channels, 3 * seen / 50) << spec;
}

}  // namespace beampipe::draw_state_test

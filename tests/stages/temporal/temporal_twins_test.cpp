// The scalar twins of the stages that carry pixels from one frame to the next: motion, contents, dilate, temporal. They
// process each pixel alone. In the last frame, the camera and the first draw were elsewhere.
#include <glm/gtc/matrix_transform.hpp>

#include "stages/data/half_bits.h"
#include "stages/picture/shade.h"
#include "stages/samples/dilate.h"
#include "stages/samples/sample_select.h"
#include "stages/temporal/motion.h"
#include "stages/temporal/temporal.h"
#include "tests/stages/sample_pixels.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::temporal_twins_test {

using namespace twins;

constexpr std::size_t kSamples = 8;

class TemporalTwins : public SceneTwins {
 protected:
  void SetUp() override {
    SceneTwins::SetUp();
    const Frame& frame = trace_.frames[0];
    const Sampling sampling{CellGrid{}, standard_pattern(kSamples)};
    StageCounters ignored;
    surface_ = tested_samples(triangles_, tile_, sampling);
    colors_ = shade_triangles(triangles_, frame.lighting);
    Poses before = poses_of(frame);
    before.view_projection = glm::translate(glm::dmat4(1.0), glm::dvec3(0.05, -0.03, 0)) * before.view_projection;
    before.draws[0].transform[3][0] += 0.1;
    to_last_ = to_last_frame(poses_of(frame), before);
    looks_ = looks_of(frame);
    std::vector<SampleQuad> quads =
        sample_select(surface_, tile_, triangles_.draws, {.jitter = 5, .seed = 7, .room = 3}, ignored);
    std::vector<std::uint32_t> order;
    const std::vector<std::uint32_t> triangles = triangles_of(quads);
    for (std::uint32_t i = 0; i < triangles.size(); ++i)
      if (triangles[i] != kNoTriangle) order.push_back(i);
    color_samples(colors_, tile_, sampling.pattern, order, quads);
    quads_.insert(tile_, quads);
  }

  std::size_t draw_at(std::size_t sample) {
    ++twin_.fetch;
    const std::uint32_t triangle = surface_.triangle[sample];
    return triangle == kNoTriangle ? looks_.size() - 1 : triangles_.draws[triangle];
  }

  struct Vector {
    Float x, y;
  };

  // The movement of a point at this depth in pixel i, through the last frame's clip space to its screen.
  Vector moved(std::size_t draw, std::size_t i, float depth) {
    ++twin_.fetch;  // the draw's matrix
    const glm::dmat4& m = to_last_[draw];
    const Frame& frame = trace_.frames[0];
    const Real one(1.0), two(2.0), half(0.5), width = real(double(frame.width)), height = real(double(frame.height));
    const Real center_x = real(static_cast<double>(i % frame.width) + 0.5),
               center_y = real(static_cast<double>(i / frame.width) + 0.5);
    const Real x = two * center_x / width - one, y = one - two * center_y / height;
    const Real z = two * lesser(real(double{depth}), Real(0.0)) + one;
    const auto row = [&](int r) { return real(m[0][r]) * x + real(m[1][r]) * y + real(m[2][r]) * z + real(m[3][r]); };
    const Real w = row(3), inverse = one / w;
    const Real dx = (row(0) * inverse + one) * half * width - center_x;
    const Real dy = (one - row(1) * inverse) * half * height - center_y;
    const bool in_front = w > Real(0.0);
    const auto stored = [&](const Real& distance) {
      const float value = converted(to_float(distance)).value;
      return real(in_front ? nearest_half(value) : std::numeric_limits<float>::infinity());
    };
    return {stored(dx), stored(dy)};
  }

  // Everything that `temporal` reads.
  CurrentFrame current_frame() {
    StageCounters ignored;
    CurrentFrame frame(trace_.frames[0].width, trace_.frames[0].height);
    dilate({quads_, triangles_.draws, trace_.frames[0].background}, tile_, ignored, frame);
    frame.motion = motion(surface_, {tile_, trace_.frames[0], triangles_.draws, to_last_}, ignored);
    PixelContents found = contents(surface_, {tile_, trace_.frames[0], triangles_.draws, to_last_}, looks_, ignored);
    frame.looks = std::move(found.looks), frame.speeds = std::move(found.speeds);
    return frame;
  }

  // Converts to an integer and back.
  Float floored(const Float& x) {
    to_float(to_integer(x));
    return real(std::floor(x.value));
  }

  // Calls visit(j) for the pixels around pixel i.
  template <class Visit>
  void each_neighbor(std::size_t i, Visit&& visit) const {
    const auto width = tile_.width(), x = static_cast<std::int32_t>(i) % width,
               y = static_cast<std::int32_t>(i) / width;
    for (std::int32_t ny = y - 1; ny <= y + 1; ++ny)
      for (std::int32_t nx = x - 1; nx <= x + 1; ++nx)
        if ((nx != x || ny != y) && nx >= 0 && ny >= 0 && nx < width && ny < tile_.height())
          visit(static_cast<std::size_t>(ny * width + nx));
  }

  SampleTile surface_{{}, {CellGrid{}, standard_pattern(kSamples)}};
  std::vector<glm::vec3> colors_;
  std::vector<glm::dmat4> to_last_;
  std::vector<std::uint32_t> looks_;
  QuadFrame quads_{48, 28};
};

TEST_P(TemporalTwins, Motion) {
  StageCounters counters;
  const std::vector<glm::vec2> found =
      motion(surface_, {tile_, trace_.frames[0], triangles_.draws, to_last_}, counters);
  for (std::size_t i = 0; i < tile_.pixels(); ++i) {
    std::size_t at = kSamples * i;
    Float nearest = real(surface_.depth[at]);
    for (std::size_t s = kSamples * i + 1; s < kSamples * (i + 1); ++s) {
      const Float depth = real(surface_.depth[s]);
      const bool nearer = depth < nearest;
      nearest = select(nearer, depth, nearest);
      at = nearer ? s : at;
    }
    const Vector twin = moved(draw_at(at), i, nearest.value);
    ASSERT_EQ(found[i], glm::vec2(twin.x.value, twin.y.value)) << i;
  }
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TemporalTwins, Contents) {
  StageCounters counters;
  const PixelContents found =
      contents(surface_, {tile_, trace_.frames[0], triangles_.draws, to_last_}, looks_, counters);
  for (std::size_t i = 0; i < tile_.pixels(); ++i) {
    Bits look(0u);
    Float fastest = real(0.0f);
    Int draws[kSamples];
    for (std::size_t s = 0; s < kSamples; ++s) {
      const std::size_t draw = draw_at(kSamples * i + s);
      draws[s] = integer(static_cast<std::int64_t>(draw));
      bool met = false;
      for (std::size_t before = 0; before < s; ++before) met |= draws[before] == draws[s];
      if (met) continue;
      ++twin_.fetch;
      look = look ^ bits(looks_[draw]);
      const Vector moves = moved(draw, i, surface_.depth[kSamples * i + s]);
      fastest = greater(fastest, moves.x * moves.x + moves.y * moves.y);
    }
    ASSERT_EQ(found.looks[i], look.value) << i;
    ASSERT_EQ(found.speeds[i], nearest_half(converted(square_root(fastest)).value)) << i;
  }
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TemporalTwins, CameraSpeeds) {
  StageCounters counters;
  const std::vector<float> found =
      camera_speeds(surface_, {tile_, trace_.frames[0], triangles_.draws, to_last_}, counters);
  for (std::size_t i = 0; i < tile_.pixels(); ++i) {
    const auto depths = surface_.depth.begin() + static_cast<std::ptrdiff_t>(kSamples * i);
    const float nearest = *std::min_element(depths, depths + kSamples);  // motion() has found it
    twin_.fetch -= 1;                                                    // there is one matrix for all
    const Vector moves = moved(looks_.size() - 1, i, nearest);
    ASSERT_EQ(found[i], nearest_half(converted(square_root(moves.x * moves.x + moves.y * moves.y)).value)) << i;
  }
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TemporalTwins, Dilate) {
  const std::int32_t width = tile_.width();
  struct Sample {
    Int draw;
    std::array<Float, 4> color;  // RGB is stored as fp16
  };
  const auto quad_at = [&](std::size_t i) -> const SampleQuad& {
    const auto x = static_cast<std::int32_t>(i) % width, y = static_cast<std::int32_t>(i) / width;
    return quads_.quads[static_cast<std::size_t>(y / 2 * quads_.columns + x / 2)];
  };
  const auto sample_of = [&](std::uint32_t triangle) {
    const bool none = triangle == kNoTriangle;
    const glm::vec3 color = none ? trace_.frames[0].background : colors_[triangle];
    return Sample{
        integer(none ? -1 : std::int64_t{triangles_.draws[triangle]}),
        {converted(real(color.r)), converted(real(color.g)), converted(real(color.b)), real(none ? 0.0f : 1.0f)}};
  };
  const auto sample_at = [&](std::size_t i) {
    const auto x = static_cast<std::int32_t>(i) % width, y = static_cast<std::int32_t>(i) / width;
    return sample_of(quad_at(i).triangle[y % 2 * 2 + x % 2]);
  };
  struct Shown {
    std::array<Float, 4> color, low, high;
    void include(const Sample& own, const Sample& other) {
      const bool same_draw = other.draw == own.draw;
      for (std::size_t c = 0; c < 4; ++c) {
        low[c] = lesser(low[c], select(same_draw, other.color[c], low[c]));
        high[c] = greater(high[c], select(same_draw, other.color[c], high[c]));
      }
    }
  };
  std::vector<Shown> shown;
  std::map<std::size_t, std::vector<Shown>> extras;  // by the first pixel of the quad
  for (std::size_t i = 0; i < tile_.pixels(); ++i) {
    const Sample own = sample_at(i);
    shown.push_back({own.color, own.color, own.color});
    each_neighbor(i, [&](std::size_t j) { shown.back().include(own, sample_at(j)); });
    if (i % 2 == 1 || i / static_cast<std::size_t>(width) % 2 == 1) continue;
    for (const ExtraSample& extra : quad_at(i).extras) {
      const Sample sample = sample_of(extra.triangle);
      Shown& one = extras[i].emplace_back(Shown{sample.color, sample.color, sample.color});
      const std::size_t at = i + extra.location / 8u % 2 + extra.location / 16u * static_cast<std::size_t>(width);
      one.include(sample, sample_at(at));
      each_neighbor(at, [&](std::size_t j) { one.include(sample, sample_at(j)); });
    }
  }
  CurrentFrame found(trace_.frames[0].width, trace_.frames[0].height);
  StageCounters counters;
  dilate({quads_, triangles_.draws, trace_.frames[0].background}, tile_, counters, found);
  for (std::size_t i = 0; i < tile_.pixels(); ++i) {
    const auto x = static_cast<std::int32_t>(i) % width, y = static_cast<std::int32_t>(i) / width;
    const std::size_t first = i - static_cast<std::size_t>(x % 2 + y % 2 * width);
    std::vector<Shown> samples = {shown[first], shown[first + 1], shown[first + static_cast<std::size_t>(width)],
                                  shown[first + static_cast<std::size_t>(width) + 1]};
    samples.insert(samples.end(), extras[first].begin(), extras[first].end());
    const SampleQuad& quad = quad_at(i);
    const Bits here = bits(0xffu << 8 * (x % 2 + y % 2 * 2));
    std::vector<Float> weights;
    for (const std::uint32_t mask : quad.mask) weights.push_back(bit_count(bits(mask) & here));
    for (const ExtraSample& extra : quad.extras) weights.push_back(bit_count(bits(extra.mask) & here));
    Float known = weights[0];
    for (std::size_t k = 1; k < weights.size(); ++k) known = known + weights[k];
    const Float inverse = Float(1.0f) / known;
    ASSERT_EQ(found.known[i], known.value / 8) << i;
    const auto mean = [&](std::array<Float, 4> Shown::*values, std::size_t c) {
      Float sum = (samples[0].*values)[c] * weights[0];
      for (std::size_t k = 1; k < weights.size(); ++k) sum = sum + (samples[k].*values)[c] * weights[k];
      const Float written = converted(sum * inverse);
      return known.value > 0 ? written.value : shown[i].color[c].value;  // its own sample's, if nothing is known
    };
    for (std::size_t c = 0; c < 4; ++c) {
      const auto channel = static_cast<int>(c);
      ASSERT_EQ(found.color[i][channel], mean(&Shown::color, c)) << i;
      ASSERT_EQ(found.low[i][channel], mean(&Shown::low, c)) << i;
      ASSERT_EQ(found.high[i][channel], mean(&Shown::high, c)) << i;
    }
  }
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TemporalTwins, NeighborhoodBox) {
  CurrentFrame frame = current_frame();
  StageCounters counters;
  neighborhood_box(tile_, counters, frame);
  for (std::size_t i = 0; i < tile_.pixels(); ++i) {
    for (int c = 0; c < 4; ++c) {
      const Float own = converted(real(frame.color[i][c]));
      Float low = own, high = own;
      each_neighbor(i, [&](std::size_t j) {
        const Float color = converted(real(frame.color[j][c]));
        low = lesser(low, color), high = greater(high, color);
      });
      ASSERT_EQ(frame.low[i][c], converted(low).value) << i;
      ASSERT_EQ(frame.high[i][c], converted(high).value) << i;
    }
  }
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TemporalTwins, Temporal) {
  const CurrentFrame frame = current_frame();
  History history{
      .frames = 1, .width = frame.width, .height = frame.height, .color = frame.color, .looks = frame.looks};
  for (std::size_t i = 0; i < tile_.pixels(); ++i) {  // something else was there, with a lighter colour
    for (int c = 0; c < 4; ++c) history.color[i][c] = HalfBits(0.5f + 0.5f * frame.color[(i * 7) % tile_.pixels()][c]);
    if (i % 5 == 0) history.looks[i] ^= 1;
    history.deviation.emplace_back(HalfBits(0.01f * static_cast<float>(i % 11)));
  }
  for (const Clamp clamp : {Clamp::whole, Clamp::rest, Clamp::camera, Clamp::variance}) {
    const TemporalOptions options{0.1f, clamp, 2.0f, 1.5f};
    StageCounters counters;
    Accumulated found(tile_.pixels(), clamp);
    temporal(frame, options, history, tile_, counters, found);
    twin_ = {};
    for (std::size_t i = 0; i < tile_.pixels(); ++i) {
      const Float one(1.0f), half(0.5f), width(float(frame.width)), height(float(frame.height)), zero(0.0f);
      const Float x = Float(static_cast<float>(i % std::size_t{48}) + 0.5f) + converted(real(frame.motion[i].x));
      const Float y = Float(static_cast<float>(i / std::size_t{48}) + 0.5f) + converted(real(frame.motion[i].y));
      const bool on_screen = (x >= zero) & (x <= width) & (y >= zero) & (y <= height);
      std::array<Float, 4> color;
      for (int c = 0; c < 4; ++c) color[static_cast<std::size_t>(c)] = converted(real(frame.color[i][c]));
      if (on_screen) {
        const Float in_x = x - half, in_y = y - half;
        const Float left = floored(in_x), top = floored(in_y), fx = in_x - left, fy = in_y - top;
        const Float rest_x = one - fx, rest_y = one - fy;
        const Float weights[4] = {rest_x * rest_y, fx * rest_y, rest_x * fy, fx * fy};
        std::size_t texels[4];
        for (int t = 0; t < 4; ++t) {
          const int column = std::clamp(int(left.value) + t % 2, 0, frame.width - 1);
          const int row = std::clamp(int(top.value) + t / 2, 0, frame.height - 1);
          texels[t] = static_cast<std::size_t>(row * frame.width + column);
        }
        const Float known = converted(real(frame.known[i]));
        std::size_t nearest = 0;
        if (clamp == Clamp::rest || clamp == Clamp::variance)
          for (std::size_t t = 1; t < 4; ++t)
            if (weights[t] > weights[nearest]) nearest = t;
        Float clamped = real(1.0f);
        if (clamp == Clamp::rest || clamp == Clamp::camera)
          clamped = lesser(converted(real(frame.speeds[i])) / real(options.still_px), one);
        if (clamp != Clamp::whole) clamped = select(known > zero, clamped, real(0.0f));
        if (clamp == Clamp::rest)
          clamped = select(bits(history.looks[texels[nearest]]) != bits(frame.looks[i]), real(1.0f), clamped);
        const Float blend = real(options.blend) * known;
        for (std::size_t c = 0; c < 4; ++c) {
          const auto channel = static_cast<int>(c);
          const auto texel = [&](int t) { return converted(real(history.color[texels[t]][channel])) * weights[t]; };
          const Float old = texel(0) + texel(1) + texel(2) + texel(3);
          Float low = converted(real(frame.low[i][channel])), high = converted(real(frame.high[i][channel]));
          if (clamp == Clamp::variance) {
            const Float past = converted(real(history.deviation[texels[nearest]][channel]));
            const Float reach = past * real(options.deviations), step = color[c] - old;
            low = low - reach, high = high + reach;
            const Float variance = (one - blend) * (past * past + blend * (step * step));
            ASSERT_EQ(found.deviation[i][channel], float(HalfBits(converted(square_root(variance)).value))) << i;
          }
          const Float kept = old + (greater(low, lesser(high, old)) - old) * clamped;
          color[c] = kept + (color[c] - kept) * blend;
        }
      }
      for (std::size_t c = 0; c < 4; ++c)
        ASSERT_EQ(found.color[i][static_cast<int>(c)], float(HalfBits(converted(color[c]).value))) << i;
    }
    EXPECT_EQ(counters.ops, twin_);
  }
}

BEAMPIPE_ON_EVERY_SCENE(TemporalTwins);

}  // namespace beampipe::temporal_twins_test

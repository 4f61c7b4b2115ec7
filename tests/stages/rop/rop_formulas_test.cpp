// Tests and blending, as the tables of OpenGL 4.6 (17.3.3 to 17.3.6) have them.
#include "stages/rop/rop_formulas.h"

#include "stages/cost/counting.h"
#include "tests/test.h"

namespace beampipe::rop_formulas_test {

TEST(RopFormulas, ComparesWhatArrivesWithWhatIsStored) {
  // never, less, equal, less_equal, greater, not_equal, greater_equal, always
  const std::array<bool, 8> less = {false, true, false, true, false, true, false, true},
                            equal = {false, false, true, true, false, false, true, true},
                            greater = {false, false, false, false, true, true, true, true};
  for (std::size_t i = 0; i < 8; ++i) {
    const auto function = static_cast<Compare>(i);
    EXPECT_EQ(passes(function, 1.0f, 2.0f), less[i]) << i;
    EXPECT_EQ(passes(function, 2.0f, 2.0f), equal[i]) << i;
    EXPECT_EQ(passes(function, 3.0f, 2.0f), greater[i]) << i;
  }
}

TEST(RopFormulas, StencilComparesMaskedValues) {
  // 5 and 1 agree in the lowest two bits.
  const Stencil stencil{.function = Compare::equal, .reference = 5, .mask = 3};
  EXPECT_TRUE(stencil_passes(stencil, 1u));
  EXPECT_FALSE(stencil_passes(stencil, 2u));
  EXPECT_TRUE(stencil_passes(Stencil{.function = Compare::less, .reference = 1}, 2u)) << "the reference stands left";
}

TEST(RopFormulas, StencilOperations) {
  struct Row {
    StencilOperation operation;
    std::uint32_t of_0, of_7, of_255;
  };
  const Stencil stencil{.reference = 9};
  for (const Row& row :
       {Row{StencilOperation::keep, 0, 7, 255}, Row{StencilOperation::zero, 0, 0, 0},
        Row{StencilOperation::replace, 9, 9, 9}, Row{StencilOperation::increment, 1, 8, 255},
        Row{StencilOperation::decrement, 0, 6, 254}, Row{StencilOperation::invert, 255, 248, 0},
        Row{StencilOperation::increment_wrap, 1, 8, 0}, Row{StencilOperation::decrement_wrap, 255, 6, 254}}) {
    const auto number = static_cast<int>(row.operation);
    EXPECT_EQ(stencil_after(row.operation, stencil, 0u), row.of_0) << number;
    EXPECT_EQ(stencil_after(row.operation, stencil, 7u), row.of_7) << number;
    EXPECT_EQ(stencil_after(row.operation, stencil, 255u), row.of_255) << number;
  }
  // Of 0b0110, only bit 1 is written, with that of 0b1001.
  EXPECT_EQ(stencil_after(StencilOperation::invert, Stencil{.write_mask = 2}, 0b0110u), 0b0100u);
}

constexpr float kSource[4] = {0.5f, 0.25f, 1, 0.25f}, kStored[4] = {0.125f, 0.5f, 0.75f, 0.5f};

// No two numbers that a factor may be mistaken for are equal.
TEST(RopFormulas, BlendFactors) {
  const glm::vec4 constant(0.1f, 0.2f, 0.3f, 0.4f);
  const float source[4] = {0.0625f, 0.125f, 1, 0.25f}, stored[4] = {0.5f, 0.375f, 0.75f, 0.6875f};
  // Of green and of alpha.
  const std::array<std::array<float, 2>, 15> expected = {{{0, 0},
                                                          {1, 1},
                                                          {0.125f, 0.25f},
                                                          {0.875f, 0.75f},
                                                          {0.25f, 0.25f},
                                                          {0.75f, 0.75f},
                                                          {0.375f, 0.6875f},
                                                          {0.625f, 0.3125f},
                                                          {0.6875f, 0.6875f},
                                                          {0.3125f, 0.3125f},
                                                          {0.25f, 1},
                                                          {0.2f, 0.4f},
                                                          {0.8f, 0.6f},
                                                          {0.4f, 0.4f},
                                                          {0.6f, 0.6f}}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_FLOAT_EQ(blend_factor(static_cast<BlendFactor>(i), 1, source, stored, constant), expected[i][0]) << i;
    EXPECT_FLOAT_EQ(blend_factor(static_cast<BlendFactor>(i), 3, source, stored, constant), expected[i][1]) << i;
  }
  // A saturated factor is what alpha leaves room for.
  const float opaque[4] = {0, 0, 0, 0.875f};
  EXPECT_EQ(blend_factor(BlendFactor::source_alpha_saturate, 0, source, opaque, constant), 0.125f);
}

TEST(RopFormulas, BlendOperations) {
  const auto red = [](BlendOperation operation) {
    return blended_channel(Blend{{BlendFactor::source_alpha, BlendFactor::destination_alpha, operation}, {}, {}}, 0,
                           kSource, kStored);
  };
  EXPECT_EQ(red(BlendOperation::add), 0.125f + 0.0625f);
  EXPECT_EQ(red(BlendOperation::subtract), 0.125f - 0.0625f);
  EXPECT_EQ(red(BlendOperation::reverse_subtract), 0.0625f - 0.125f);
  EXPECT_EQ(red(BlendOperation::min), 0.125f) << "without factors";
  EXPECT_EQ(red(BlendOperation::max), 0.5f);
  const Blend apart{{BlendFactor::one, BlendFactor::zero}, BlendEquation{BlendFactor::zero, BlendFactor::one}, {}};
  EXPECT_EQ(blended_channel(apart, 0, kSource, kStored), 0.5f);
  EXPECT_EQ(blended_channel(apart, 3, kSource, kStored), 0.5f) << "the stored alpha";
}

// Alpha blending of one channel: a difference, two products and a sum. Factors of 0 and 1 cost nothing.
TEST(RopFormulas, CostsOfBlending) {
  const auto cost = [](BlendFactor source, BlendFactor destination) {
    return count_operations([&](OperationCounts& counts) {
      const Counted<float> one(1.0f, counts);
      const Counted<float> color[4] = {one, one, one, one};
      blended_channel(Blend{{source, destination}, {}, {}}, 0, color, color);
    });
  };
  EXPECT_EQ(cost(BlendFactor::source_alpha, BlendFactor::one_minus_source_alpha),
            (OperationCounts{.mul_add = 2, .add = 2}));
  EXPECT_EQ(cost(BlendFactor::one, BlendFactor::one), (OperationCounts{.add = 1}));
  EXPECT_EQ(cost(BlendFactor::one, BlendFactor::zero), OperationCounts{});
}

TEST(RopFormulas, PartsOfBlending) {
  const auto parts = [](const BlendEquation& equation) {
    return blend_parts(Blend{equation, {}, {}}, {kSource[0], kSource[1], kSource[2], kSource[3]},
                       {kStored[0], kStored[1], kStored[2], kStored[3]});
  };
  const BlendParts over = parts({BlendFactor::source_alpha, BlendFactor::one_minus_source_alpha});
  EXPECT_FLOAT_EQ(over.added, 0.25f);
  EXPECT_FLOAT_EQ(over.kept, 0.75f);
  const BlendParts less = parts({BlendFactor::one, BlendFactor::destination_color, BlendOperation::subtract});
  EXPECT_FLOAT_EQ(less.added, 1);
  EXPECT_FLOAT_EQ(less.kept, -(0.125f + 0.5f + 0.75f) / 3);
  const BlendParts rest = parts({BlendFactor::destination_color, BlendFactor::one, BlendOperation::reverse_subtract});
  EXPECT_FLOAT_EQ(rest.added, -(0.125f + 0.5f + 0.75f) / 3);
  EXPECT_FLOAT_EQ(rest.kept, 1);
  EXPECT_EQ(parts({BlendFactor::one, BlendFactor::one, BlendOperation::max}).added, 1) << "the source is brighter";
  EXPECT_EQ(parts({BlendFactor::one, BlendFactor::one, BlendOperation::min}).added, 0);
}

}  // namespace beampipe::rop_formulas_test

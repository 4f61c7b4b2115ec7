// The comparison with captured pictures, on pictures whose differences are known.
#include "tools/evaluate/captured_colors.h"

#include "tests/test.h"
#include "traces/srgb.h"

namespace beampipe::captured_colors_test {

constexpr std::uint32_t kWidth = 4, kHeight = 2;

// A frame with two draws whose captured picture has this code everywhere, in all channels.
Trace trace_of(std::uint8_t code) {
  Trace trace;
  trace.images.push_back(
      {.name = "captured", .width = kWidth, .height = kHeight, .texels = {kWidth * kHeight, glm::u8vec4(code)}});
  Frame& frame = trace.frames.emplace_back();
  frame.width = kWidth;
  frame.height = kHeight;
  frame.draws.resize(2);
  frame.capture.pictures.color = 0;
  return trace;
}

float linear_of(int code) { return static_cast<float>(linear_of_srgb(code / 255.0)); }

Image image_of(int code) {
  Image image{.width = kWidth, .height = kHeight, .rgba = {}};
  image.rgba.assign(4 * kWidth * kHeight, linear_of(code));
  return image;
}

const std::vector<std::uint32_t> kDraws = {0, 0, 1, 1, 1, kNoDraw, kNoDraw, kNoDraw};

TEST(CapturedColors, TwoCodesAreCloseAndThreeAreNot) {
  const Trace trace = trace_of(100);
  for (const int code : {97, 98, 100, 102, 103}) {
    const ColorCheck check = check_colors(trace, trace.frames[0], image_of(code), kDraws);
    EXPECT_EQ(check.pixels, kWidth * kHeight);
    EXPECT_EQ(check.close_part(), std::abs(code - 100) <= 2 ? 1.0 : 0.0) << code;
    EXPECT_EQ(check.largest, std::abs(code - 100));
    EXPECT_EQ(check.draws.empty(), std::abs(code - 100) <= 2);
  }
}

TEST(CapturedColors, OneChannelIsEnoughAndDrawsAreToldApart) {
  const Trace trace = trace_of(200);
  Image image = image_of(200);
  image.rgba[4 * 3 + 1] = linear_of(190);  // the second draw's
  image.rgba[4 * 4 + 2] = linear_of(250);
  image.rgba[4 * 5 + 0] = 17;  // shown as 255; no draw's
  image.rgba[4 * 0 + 3] = 0;   // opacity is not compared
  const ColorCheck check = check_colors(trace, trace.frames[0], image, kDraws);
  EXPECT_EQ(check.close, 5u);
  EXPECT_EQ(check.largest, 55);
  ASSERT_EQ(check.draws.size(), 2u);
  EXPECT_EQ(check.draws[0].draw, 1u);
  EXPECT_EQ(check.draws[0].pixels, 3u);
  EXPECT_EQ(check.draws[0].differing, 2u);
  EXPECT_EQ(check.draws[0].largest, 50);
  EXPECT_EQ(check.draws[1].draw, kNoDraw);
  EXPECT_EQ(check.draws[1].differing, 1u);
  const std::vector<std::uint8_t> picture = color_difference_picture(trace, trace.frames[0], image);
  ASSERT_EQ(picture.size(), 3u * kWidth * kHeight);
  EXPECT_EQ(picture[3 * 3 + 1], 80);
  EXPECT_EQ(picture[3 * 4 + 2], 255);
  EXPECT_EQ(std::count(picture.begin(), picture.end(), 0), 3 * kWidth * kHeight - 3);
}

TEST(CapturedColors, PicturesHaveOneSize) {
  Trace trace = trace_of(1);
  EXPECT_THROW(check_colors(trace, trace.frames[0], image_of(1), {0, 1}), std::invalid_argument);
  trace.images[0].width = 2;
  EXPECT_THROW(check_colors(trace, trace.frames[0], image_of(1), kDraws), std::invalid_argument);
  trace.frames[0].capture.pictures.color.reset();
  EXPECT_THROW(check_colors(trace, trace.frames[0], image_of(1), kDraws), std::invalid_argument);
}

}  // namespace beampipe::captured_colors_test

#include "tools/evaluate/measures.h"

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"
#include "tools/evaluate/planes.h"
#include "tools/evaluate/powers.h"
#include "tools/evaluate/ssim.h"

namespace beampipe::measures_test {

using Color = std::array<float, 3>;

Image uniform(std::uint32_t width, std::uint32_t height, const Color& color) {
  Image image = flat_image(width, height, 1.0f);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) image.rgba[i] = color[i % 4];
  return image;
}

// 64 x 48 pixels with gradients, a disc, stripes and a bright corner. `changed`: a larger disc, lines that are too
// green and a less blue corner.
Image drawing(bool changed) {
  Image image = flat_image(64, 48, 1.0f);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      float* const rgb = image.rgba.data() + 4 * (64 * y + x);
      const bool in_disc = (x - 20) * (x - 20) + (y - 24) * (y - 24) < (changed ? 170 : 150);
      const bool in_stripe = x > 32 && (x / 3 + y / 5) % 2;
      rgb[0] = in_disc ? 1.0f : static_cast<float>(x) / 64;
      rgb[1] = in_disc ? 0.25f : static_cast<float>(y) / 64;
      rgb[2] = in_stripe ? 0.75f : 0.125f;
      if (changed && x % 7 == 3) rgb[1] += 0.0625f;
      if (x < 48 || y >= 12) continue;
      rgb[0] *= 8;
      rgb[1] *= 8;
      rgb[2] *= changed ? 6 : 8;
    }
  }
  return image;
}

TEST(Powers, AreWithinTheirBounds) {
  for (long double x = 1e-10L; x < 1e10L; x *= 1.037L) {
    const auto number = static_cast<double>(x);
    EXPECT_NEAR(log2_of(number), static_cast<double>(std::log2(static_cast<long double>(number))), 1e-13) << number;
    for (const double y : {1 / 2.4, 1.0 / 3, 0.7, 0.013, 2.4}) {
      const long double truth = std::pow(static_cast<long double>(number), static_cast<long double>(y));
      EXPECT_NEAR(static_cast<double>(power(number, y) / truth), 1.0, 1e-12) << number << " to the power of " << y;
    }
  }
  for (long double y = -1021; y < 1023; y += 0.173L) {
    const auto number = static_cast<double>(y);
    EXPECT_NEAR(static_cast<double>(exp2_of(number) / std::exp2(static_cast<long double>(number))), 1.0, 2e-14) << y;
  }
}

TEST(Powers, AreExactWhereTheyAreWhole) {
  for (int e = -30; e <= 30; ++e) {
    EXPECT_EQ(log2_of(std::ldexp(1.0, e)), e);
    EXPECT_EQ(exp2_of(e), std::ldexp(1.0, e));
  }
  EXPECT_EQ(power(0.0, 0.7), 0.0);
  EXPECT_EQ(power(1.0, 0.7), 1.0);
}

TEST(Srgb, IsThatOfTheStandard) {
  // 1.055 x^(1 / 2.4) - 0.055, evaluated in numpy.
  EXPECT_NEAR(srgb_of_linear(0.5), 0.735356983052449, 1e-12);
  EXPECT_NEAR(srgb_of_linear(0.0625), 0.27730418, 1e-8);
  EXPECT_DOUBLE_EQ(srgb_of_linear(0.002), 12.92 * 0.002);
  EXPECT_NEAR(srgb_of_linear(0.0031308), srgb_of_linear(std::nextafter(0.0031308, 1)), 1e-6);
  EXPECT_EQ(srgb_of_linear(-1), 0.0);
  EXPECT_EQ(srgb_of_linear(7), srgb_of_linear(1));
  EXPECT_NEAR(srgb_of_linear(1), 1.0, 1e-13);
}

TEST(Filtered, MovesSumsAndRepeatsTheEdge) {
  const Plane<double> plane{3, 2, {1, 2, 4, 8, 16, 32}};
  const std::vector<double> right = {0, 0, 1}, all = {1, 1, 1}, here = {0, 1, 0};
  EXPECT_EQ(filtered(plane, right, here).values, (std::vector<double>{2, 4, 4, 16, 32, 32}));
  EXPECT_EQ(filtered(plane, here, right).values, (std::vector<double>{8, 16, 32, 8, 16, 32}));
  EXPECT_EQ(filtered(plane, all, here).values, (std::vector<double>{4, 7, 10, 32, 56, 80}));
  EXPECT_EQ(filtered(plane, all, all).values[1], 7 + 7 + 56);
}

TEST(Measures, OfEqualPicturesSayThatNothingIsWrong) {
  const Image image = drawing(false);
  Image clear = image;
  for (std::size_t i = 3; i < clear.rgba.size(); i += 4) clear.rgba[i] = 0.0f;  // alpha does not count
  EXPECT_EQ(measure_all(clear, image), no_error());
  EXPECT_EQ(measures()[8].key, std::string("psnr"));
  EXPECT_EQ(measures()[8].value(no_error()), std::nullopt);
}

TEST(Measures, OfAConstantDifference) {
  const ErrorStats stats = measure_all(flat_image(20, 15, 1.0f), flat_image(20, 15, 0.5f));
  EXPECT_DOUBLE_EQ(stats.mae, 0.5);
  EXPECT_DOUBLE_EQ(stats.p999, 0.5);
  EXPECT_NEAR(stats.rel_mse, 0.25 / (0.25 + 0.01), 1e-12);
  EXPECT_NEAR(*stats.srgb_rmse, 1 - 0.735356983052449, 1e-12);
  EXPECT_NEAR(*measures()[8].value(stats), 11.546791222281529, 1e-9);  // -20 log10(1 - 0.735356983052449)
}

TEST(Measures, SquaresOverTheReference) {
  // Errors of 0.1 over a reference of 0 and of 1: 0.01 / 0.01 and 0.01 / 1.01.
  Image image = flat_image(2, 1, 0.1f), reference = flat_image(2, 1, 0.0f);
  for (std::size_t i = 4; i < 8; ++i) image.rgba[i] = 1.1f, reference.rgba[i] = 1.0f;
  EXPECT_NEAR(measure_error(image, reference).rel_mse, (1 + 0.01 / 1.01) / 2, 1e-6);
}

TEST(Measures, ThePercentileIsAtRankCeilOf999PerThousand) {
  for (const auto& [pixels, rank] : {std::pair<std::uint32_t, int>{333, 999}, {334, 1001}, {1000, 2997}}) {
    Image image = flat_image(pixels, 1, 0.0f);
    for (std::uint32_t i = 0; i < 3 * pixels; ++i)
      image.rgba[4 * (i / 3) + i % 3] = static_cast<float>((i * 7) % (3 * pixels) + 1) / 4096;
    EXPECT_EQ(measure_error(image, flat_image(pixels, 1, 0.0f)).p999 * 4096, rank) << pixels;
  }
}

TEST(Ssim, OfConstantPicturesComparesTheirMeans) {
  // (2 a b + C1) / (a^2 + b^2 + C1) with a and b the sRGB values of 0.25 and 0.5, and C1 = 0.0001. The second factor is
  // 1 because nothing varies.
  const std::vector<double> map = ssim_map(flat_image(13, 70, 0.25f), flat_image(13, 70, 0.5f));
  for (const double value : map) EXPECT_NEAR(value, 0.9526044221361724, 1e-9);
  EXPECT_NEAR(mean_ssim(map, 13), 0.9526044221361724, 1e-9);
}

TEST(Ssim, CountsOnlyWholeWindows) {
  std::vector<double> map(12 * 11, 0.0);
  map[5 * 12 + 5] = 0.5;  // two windows fit, at x = 5 and 6 in row 5
  EXPECT_DOUBLE_EQ(mean_ssim(map, 12), 0.25);
  EXPECT_DOUBLE_EQ(mean_ssim({0.5, 1.0}, 2), 0.75);
}

TEST(Ssim, IsThatOfScikitImage) {
  // structural_similarity of scikit-image 0.19.3 with the arguments that ssim.h names, on the two drawings.
  const Image image = drawing(true), reference = drawing(false);
  EXPECT_NEAR(mean_ssim(ssim_map(image, reference), 64), 0.897328498332685, 1e-12);
}

// The paper's formulas for two colours: L*a*b* with the Hunt effect, HyAB to the power of 0.7, and the redistribution
// of errors; evaluated in numpy. Uniform pictures have no features. The program's single precision leaves 1e-4.
TEST(Flip, OfUniformColorsIsTheirDistance) {
  const Color black = {0, 0, 0}, white = {1, 1, 1}, green = {0, 1, 0}, blue = {0, 0, 1};
  const auto flip = [](const Color& a, const Color& b) {
    return mean_of(flip_map(uniform(9, 7, a), uniform(9, 7, b)), 9);
  };
  EXPECT_NEAR(flip(black, white), 0.9673797614921327, 1e-4);
  EXPECT_NEAR(flip(green, blue), 1.0, 1e-4);  // the largest distance
  EXPECT_NEAR(flip({0.5f, 0.25f, 0.125f}, {0.25f, 0.5f, 0.75f}), 0.8921107090072149, 1e-4);
  EXPECT_NEAR(flip({0.5f, 0.5f, 0.5f}, {0.5625f, 0.5625f, 0.5625f}), 0.14341863872342192, 1e-4);
  EXPECT_NEAR(flip({9, 9, 9}, {1, 2, 1}), 0.0, 1e-6) << "clamped to 1";
}

TEST(Flip, HdrOfUniformColorsIsTheirDistanceOnTheScreen) {
  // The one exposure takes the reference's luminance, 0.4649, to 2.118872, which ACES shows as 0.85.
  const Image image = uniform(9, 7, {0.5f, 0.25f, 0.125f}), reference = uniform(9, 7, {0.25f, 0.5f, 0.75f});
  const Exposures exposures = exposures_for(reference);
  EXPECT_NEAR(exposures.start, 2.1883043274815828, 1e-9);
  EXPECT_EQ(exposures.start, exposures.stop);
  EXPECT_EQ(exposures.count, 2);
  EXPECT_NEAR(mean_of(hdr_flip_map(image, reference), 9), 0.5902383813722436, 1e-4);
}

// Computed with FLIP.h of https://github.com/NVlabs/flip, version 1.6, in single precision (the pixels' mean in
// double).
TEST(Flip, IsThatOfItsAuthors) {
  const Image image = drawing(true), reference = drawing(false);
  EXPECT_NEAR(mean_of(flip_map(image, reference), 64), 0.11438331, 2e-6);
  EXPECT_NEAR(mean_of(hdr_flip_map(image, reference), 64), 0.11228017, 2e-6);
  EXPECT_NEAR(mean_of(flip_map(image, reference, 20), 64), 0.10867280, 2e-6);
  EXPECT_NEAR(mean_of(hdr_flip_map(image, reference, 20), 64), 0.10894623, 2e-6);
  const Exposures exposures = exposures_for(reference);
  EXPECT_NEAR(exposures.start, -0.544695, 2e-6);
  EXPECT_NEAR(exposures.stop, 2.40369, 1e-5);
  EXPECT_EQ(exposures.count, 3);
}

TEST(Flip, ExposuresOfDarkPictures) {
  Image image = flat_image(3, 1, 0.0f);
  EXPECT_EQ(exposures_for(image).count, 1);
  EXPECT_EQ(mean_of(hdr_flip_map(image, image), 3), 0.0);
  for (std::size_t c = 0; c < 3; ++c) image.rgba[c] = 4.0f;
  const Exposures exposures = exposures_for(image);  // the only pixel that is not black is both brightest and median
  EXPECT_EQ(exposures.start, exposures.stop);
}

TEST(Maps, DoNotDependOnBands) {
  // Without its first 32 rows, a tall picture has other bands. Rows that see nothing of these 32 stay the same.
  Image image = flat_image(17, 200, 0.5f), reference = image;
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = static_cast<float>(i * 37 % 101) / 101;
  const auto lower = [](const Image& tall) {
    return Image{tall.width, 168, {tall.rgba.begin() + 4 * 17 * 32, tall.rgba.end()}};
  };
  for (const std::string& name : map_names()) {
    const auto map = find_metric(name).map;
    const std::vector<float> all = map(image, reference, kPixelsPerDegree);
    const std::vector<float> part = map(lower(image), lower(reference), kPixelsPerDegree);
    EXPECT_TRUE(std::equal(part.begin() + 17 * 12, part.end(), all.begin() + 17 * 44)) << name;
  }
}

TEST(Metrics, LargerIsWorseForAll) {
  const Image reference = drawing(false), bad = drawing(true);
  Image better = bad;
  for (std::size_t i = 0; i < better.rgba.size(); ++i) better.rgba[i] = 0.5f * (bad.rgba[i] + reference.rgba[i]);
  const ErrorStats worse_stats = measure_all(bad, reference), better_stats = measure_all(better, reference);
  for (const std::string& name : metric_names()) {
    const Measure& metric = find_metric(name);
    EXPECT_EQ(metric.error(no_error()), 0.0) << name;
    EXPECT_GT(metric.error(better_stats), 0.0) << name;
    EXPECT_GT(metric.error(worse_stats), metric.error(better_stats)) << name;
  }
  EXPECT_THROW(find_metric("bias"), std::invalid_argument);
}

}  // namespace beampipe::measures_test

#include "traces/files/image_file.h"

#include <sys/resource.h>
#include <zlib.h>

#include "tests/message_of.h"
#include "tests/test.h"
#include "tests/traces/image_samples.h"
#include "traces/files/trace_io.h"

namespace beampipe::image_file_test {

using Texels = std::vector<glm::u8vec4>;

std::string error_in(const std::string& bytes, std::uint64_t most_texels = kMostTexels) {
  try {
    decode_image(bytes, most_texels);
  } catch (const BadImage& bad) {
    return "expected " + bad.expected + ", found " + bad.found;
  }
  return "no error";
}

TextureImage random_image(std::uint32_t width, std::uint32_t height) {
  std::mt19937 random(width * 1000 + height);
  TextureImage image{.name = "", .width = width, .height = height, .texels = Texels(std::size_t{width} * height)};
  for (glm::u8vec4& texel : image.texels)
    for (int i = 0; i < 4; ++i) texel[i] = static_cast<std::uint8_t>(random());
  return image;
}

TEST(ImageFile, ReadsBackWhatItWrites) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 300u}, {301u, 1u}, {64u, 33u}}) {
    const TextureImage image = random_image(width, height);
    const TextureImage back = decode_image(encode_png(image));
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_EQ(back.texels, image.texels);
  }
  TextureImage clear = random_image(4, 4);  // colours are kept where nothing can be seen of them
  for (glm::u8vec4& texel : clear.texels) texel.a = 0;
  EXPECT_EQ(decode_image(encode_png(clear)).texels, clear.texels);
  EXPECT_THROW(encode_png(TextureImage{}), std::runtime_error);
}

TEST(ImageFile, ReadsEveryPngColorType) {
  const std::vector<png_color> palette = {{10, 20, 30}, {40, 50, 60}, {70, 80, 90}};
  const png_color_16 grey_3{.index = 0, .red = 0, .green = 0, .blue = 0, .gray = 3};
  const png_color_16 rgb_257{.index = 0, .red = 0x101, .green = 0x202, .blue = 0x303, .gray = 0};
  const std::pair<PngSample, Texels> cases[] = {
      {{.width = 3, .color_type = PNG_COLOR_TYPE_GRAY, .depth = 1, .rows = {{0b10100000}}},
       {{255, 255, 255, 255}, {0, 0, 0, 255}, {255, 255, 255, 255}}},
      {{.width = 3, .color_type = PNG_COLOR_TYPE_GRAY, .depth = 2, .rows = {{0b00011000}}},
       {{0, 0, 0, 255}, {85, 85, 85, 255}, {170, 170, 170, 255}}},
      {{.width = 2, .color_type = PNG_COLOR_TYPE_GRAY, .depth = 4, .rows = {{0x3e}}},
       {{51, 51, 51, 255}, {238, 238, 238, 255}}},
      {{.width = 2, .color_type = PNG_COLOR_TYPE_GRAY, .depth = 4, .rows = {{0x3e}}, .transparent = &grey_3},
       {{51, 51, 51, 0}, {238, 238, 238, 255}}},
      {{.width = 2, .color_type = PNG_COLOR_TYPE_GRAY, .rows = {{7, 200}}}, {{7, 7, 7, 255}, {200, 200, 200, 255}}},
      // 16 bits are rounded: 0x0180 is 384 / 257 = 1.494, and 0x0181 is 1.498; 0x0182 is 1.502.
      {{.width = 3, .color_type = PNG_COLOR_TYPE_GRAY, .depth = 16, .rows = {{1, 0x80, 1, 0x82, 0xff, 0xff}}},
       {{1, 1, 1, 255}, {2, 2, 2, 255}, {255, 255, 255, 255}}},
      {{.width = 2, .color_type = PNG_COLOR_TYPE_GRAY_ALPHA, .rows = {{7, 8, 9, 10}}}, {{7, 7, 7, 8}, {9, 9, 9, 10}}},
      {{.color_type = PNG_COLOR_TYPE_GRAY_ALPHA, .depth = 16, .rows = {{7, 7, 8, 8}}}, {{7, 7, 7, 8}}},
      {{.color_type = PNG_COLOR_TYPE_RGB, .rows = {{7, 8, 9}}}, {{7, 8, 9, 255}}},
      {{.width = 2,
        .color_type = PNG_COLOR_TYPE_RGB,
        .depth = 16,
        .rows = {{1, 1, 2, 2, 3, 3, 1, 1, 2, 2, 3, 4}},
        .transparent = &rgb_257},
       {{1, 2, 3, 0}, {1, 2, 3, 255}}},
      {{.rows = {{7, 8, 9, 10}}}, {{7, 8, 9, 10}}},
      {{.depth = 16, .rows = {{7, 7, 8, 8, 9, 9, 10, 10}}}, {{7, 8, 9, 10}}},
      {{.width = 3, .color_type = PNG_COLOR_TYPE_PALETTE, .rows = {{2, 0, 1}}, .palette = palette},
       {{70, 80, 90, 255}, {10, 20, 30, 255}, {40, 50, 60, 255}}},
      {{.width = 3,
        .color_type = PNG_COLOR_TYPE_PALETTE,
        .depth = 2,
        .rows = {{0b10000100}},
        .palette = palette,
        .palette_alpha = {5, 6}},
       {{70, 80, 90, 255}, {10, 20, 30, 5}, {40, 50, 60, 6}}},
  };
  for (const auto& [sample, texels] : cases) {
    const TextureImage image = decode_image(png_bytes(sample));
    EXPECT_EQ(image.width, sample.width);
    EXPECT_EQ(image.height, sample.height);
    EXPECT_EQ(image.texels, texels) << "colour type " << sample.color_type << ", " << sample.depth << " bits";
  }
}

TEST(ImageFile, TakesNumbersAsTheyAreStored) {
  PngSample sample{.rows = {{7, 8, 9, 10}}, .gamma = 1.0};
  EXPECT_EQ(decode_image(png_bytes(sample)).texels, (Texels{{7, 8, 9, 10}}));
  sample = {.color_type = PNG_COLOR_TYPE_GRAY, .depth = 16, .rows = {{7, 7}}, .gamma = 0.25};
  EXPECT_EQ(decode_image(png_bytes(sample)).texels, (Texels{{7, 7, 7, 255}}));
}

TEST(ImageFile, ReadsInterlacedPng) {
  const TextureImage image = random_image(13, 11);
  PngSample sample{.width = 13, .height = 11, .rows = {}, .interlaced = true};
  for (std::size_t y = 0; y < 11; ++y) {
    const std::uint8_t* row = &image.texels[y * 13].r;
    sample.rows.emplace_back(row, row + 13 * 4);
  }
  EXPECT_EQ(decode_image(png_bytes(sample)).texels, image.texels);
}

// A wave whose numbers differ little from texel to texel, which JPEG keeps to a few units.
TextureImage smooth_image(int width, int height) {
  TextureImage image{.name = "", .width = 0, .height = 0, .texels = {}};
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.texels.emplace_back(100 + x, 180 - y, 60 + x + y, 255);
  return image;
}

std::vector<std::uint8_t> bytes_of(const Texels& texels) { return {&texels[0].r, &texels[0].r + 4 * texels.size()}; }

TEST(ImageFile, ReadsJpeg) {
  const TextureImage image = smooth_image(37, 21);
  for (const TJSAMP subsampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_GRAY}) {
    for (const int flags : {0, TJFLAG_PROGRESSIVE}) {
      const TextureImage back = decode_image(jpeg_bytes(37, 21, bytes_of(image.texels), TJPF_RGBA, subsampling, flags));
      ASSERT_EQ(back.width, 37u);
      ASSERT_EQ(back.height, 21u);
      int most = 0;
      for (std::size_t i = 0; i < image.texels.size(); ++i) {
        const glm::u8vec4 old = image.texels[i];
        // ITU-R BT.601, which JFIF uses
        const double grey = 0.299 * old.r + 0.587 * old.g + 0.114 * old.b;
        for (int c = 0; c < 3; ++c) {
          const double expected = subsampling == TJSAMP_GRAY ? grey : old[c];
          most = std::max(most, static_cast<int>(std::abs(back.texels[i][c] - expected)));
        }
        EXPECT_EQ(back.texels[i].a, 255);
      }
      EXPECT_LE(most, 4) << subsampling;
    }
  }
}

TEST(ImageFile, RefusesOtherFiles) {
  EXPECT_EQ(error_in(""), "expected a PNG or JPEG file, found no bytes");
  EXPECT_EQ(error_in("GIF89a and more"), "expected a PNG or JPEG file, found one that starts with \"GIF89a a\"");
  EXPECT_EQ(error_in("\x89PNG"), "expected a PNG or JPEG file, found one that starts with \"\xef\xbf\xbdPNG\"");
  const std::vector<std::uint8_t> cmyk(4 * 64);
  EXPECT_EQ(error_in(jpeg_bytes(8, 8, cmyk, TJPF_CMYK, TJSAMP_444)), "expected a JPEG file in grey or RGB, found CMYK");
}

TEST(ImageFile, RefusesFilesThatEndEarly) {
  const TextureImage image = smooth_image(16, 16);
  const std::vector<std::uint8_t> pixels = bytes_of(image.texels);
  for (const std::string& bytes : {encode_png(image), jpeg_bytes(16, 16, pixels, TJPF_RGBA, TJSAMP_420),
                                   jpeg_bytes(16, 16, pixels, TJPF_RGBA, TJSAMP_420, TJFLAG_PROGRESSIVE)}) {
    ASSERT_EQ(error_in(bytes), "no error");
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_NE(error_in(bytes.substr(0, size)), "no error") << size << " of " << bytes.size() << " bytes";
  }
  const std::string png = encode_png(image);
  EXPECT_EQ(error_in(png.substr(0, png.size() - 1)), "expected a sound PNG file, found \"the file ends early\"");
}

TEST(ImageFile, RefusesDamagedFiles) {
  std::string png = encode_png(smooth_image(16, 16));
  png[png.find("IEND") - 5] ^= 1;  // the last byte before the length of IEND
  EXPECT_EQ(error_in(png), "expected a sound PNG file, found \"IDAT: CRC error\"");
  EXPECT_EQ(error_in(png_that_claims(0, 5)), "expected a sound PNG file, found \"Invalid IHDR data\"");
  EXPECT_EQ(error_in("\xff\xd8\xff\xd9"), "expected a sound JPEG file, found one without a picture");
  EXPECT_EQ(error_in(png_that_claims(1, 1, png_chunk("IEND"))),
            "expected a sound PNG file, found \"IEND: out of place\"");
}

TEST(ImageFile, RefusesSizesBeforeItTakesMemory) {
  EXPECT_EQ(error_in(png_that_claims(16385, 1, png_chunk("IDAT"))),
            "expected at most 16384 texels on a side, found 16385 x 1");
  EXPECT_EQ(error_in(png_that_claims(1, 1'000'000, png_chunk("IDAT"))),
            "expected at most 16384 texels on a side, found 1 x 1000000");
  // 16384 x 16384 texels of 4 bytes are 2^30 bytes, which a file of 57 bytes does not hold.
  EXPECT_EQ(error_in(png_that_claims(16384, 16384, png_chunk("IDAT"))),
            "expected at least 976128 bytes for 16384 x 16384 texels, found 45");
  EXPECT_EQ(error_in(encode_png(random_image(10, 10)), 99),
            "expected at most 268435456 texels in all images together, found 10 x 10 in this one");
  EXPECT_EQ(error_in(encode_png(random_image(10, 10)), 100), "no error");

  // The size is in the frame header: 0xff 0xc0, its length, 8 bits, height, width.
  std::string jpeg = jpeg_bytes(16, 16, bytes_of(smooth_image(16, 16).texels), TJPF_RGBA, TJSAMP_420);
  const std::size_t size = jpeg.find("\xff\xc0") + 5;
  EXPECT_EQ(error_in(jpeg, 255), "expected at most 268435456 texels in all images together, found 16 x 16 in this one");
  jpeg.replace(size, 4, "\x40\x00\x40\x00", 4);
  EXPECT_EQ(error_in(jpeg),
            "expected at least 524288 bytes for 16384 x 16384 texels, found " + std::to_string(jpeg.size()));
  jpeg.replace(size, 4, "\x40\x01\x00\x01", 4);
  EXPECT_EQ(error_in(jpeg), "expected at most 16384 texels on a side, found 1 x 16385");
}

// A text of a PNG that grows to 8 MB is no more than a line of the file. A hundred of them would take 800 MB.
TEST(ImageFile, DoesNotReadTexts) {
  const std::string long_text(7'900'000, 'a');
  uLongf size = compressBound(long_text.size());
  std::string deflated(size, '\0');
  compress(reinterpret_cast<Bytef*>(deflated.data()), &size, reinterpret_cast<const Bytef*>(long_text.data()),
           long_text.size());
  const std::string text = png_chunk("zTXt" + std::string("a\0\0", 3) + deflated.substr(0, size));
  std::string texts;
  for (int i = 0; i < 100; ++i) texts += text;
  const TextureImage image = random_image(3, 3);
  std::string bytes = encode_png(image);
  bytes.insert(8 + 25, texts);  // after the signature and IHDR
  const auto peak = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;  // KiB
  };
  const auto before = peak();
  EXPECT_EQ(decode_image(bytes).texels, image.texels);
  EXPECT_LT(peak() - before, 200 * 1024);
}

// What compresses best is still read: the limits above are no smaller than what the formats reach.
TEST(ImageFile, ReadsLargeFlatImages) {
  TextureImage image{.name = "", .width = 4096, .height = 4096, .texels = Texels(4096 * 4096, {1, 2, 3, 255})};
  EXPECT_EQ(decode_image(encode_png(image)).texels, image.texels);
  const std::vector<std::uint8_t> grey(4096 * 4096, 128);
  const std::string jpeg = jpeg_bytes(4096, 4096, grey, TJPF_GRAY, TJSAMP_GRAY, TJFLAG_PROGRESSIVE);
  EXPECT_EQ(decode_image(jpeg).texels, Texels(4096 * 4096, {128, 128, 128, 255}));
}

// Damage of any kind gives an error or an image of the size that the file names.
TEST(ImageFile, SurvivesRandomDamage) {
  const TextureImage image = smooth_image(24, 24);
  std::mt19937 random(1);
  for (const std::string& sound :
       {encode_png(image), jpeg_bytes(24, 24, bytes_of(image.texels), TJPF_RGBA, TJSAMP_420, TJFLAG_PROGRESSIVE)}) {
    for (int i = 0; i < 2000; ++i) {
      std::string bytes = sound;
      for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      try {
        const TextureImage read = decode_image(bytes, 1 << 16);
        EXPECT_EQ(read.texels.size(), std::size_t{read.width} * read.height);
      } catch (const BadImage& bad) {
        for (const char c : bad.expected + bad.found) EXPECT_GE(static_cast<unsigned char>(c), ' ');
      }
    }
  }
}

}  // namespace beampipe::image_file_test

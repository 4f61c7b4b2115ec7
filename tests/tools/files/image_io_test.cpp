#include "tools/files/image_io.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <png.h>

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"

namespace beampipe::image_io_test {

// Values that need all 32 bits and differ in every pixel and channel, so that exchanged rows, columns or channels show.
Image speaking_image(std::uint32_t width, std::uint32_t height) {
  Image image{width, height, {}};
  for (std::uint32_t i = 0; i < 4 * width * height; ++i) image.rgba.push_back(1.0f / (3.0f + static_cast<float>(i)));
  return image;
}

std::string error_of_reading(const std::filesystem::path& file) {
  return message_of<ImageError>([&] { read_exr(file); });
}

// Writes a file with the header of a test, whose float channels have one value each.
void write_exr(const std::filesystem::path& file, Imf::Header header, const std::vector<std::string>& channels) {
  const Imath::Box2i data = header.dataWindow();
  const std::size_t width = static_cast<std::size_t>(data.max.x - data.min.x + 1);
  const std::size_t height = static_cast<std::size_t>(data.max.y - data.min.y + 1);
  std::vector<float> values(width * height, 0.25f);
  Imf::FrameBuffer buffer;
  for (const std::string& channel : channels) {
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    char* first = reinterpret_cast<char*>(values.data() - data.min.x - data.min.y * static_cast<std::ptrdiff_t>(width));
    buffer.insert(channel, Imf::Slice(Imf::FLOAT, first, sizeof(float), sizeof(float) * width));
  }
  Imf::OutputFile output(file.c_str(), header);
  output.setFrameBuffer(buffer);
  output.writePixels(static_cast<int>(height));
}

struct Rgb8 {
  std::uint32_t width, height;
  std::vector<std::uint8_t> bytes;
};

Rgb8 decode_png(const std::string& bytes) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) << png.message;
  EXPECT_EQ(png.format, static_cast<std::uint32_t>(PNG_FORMAT_RGB));
  Rgb8 rgb{png.width, png.height, std::vector<std::uint8_t>(std::size_t{3} * png.width * png.height)};
  EXPECT_TRUE(png_image_finish_read(&png, nullptr, rgb.bytes.data(), 0, nullptr)) << png.message;
  return rgb;
}

using Exr = InFolder;

TEST_F(Exr, ComesBackToTheLastBit) {
  const Image image = speaking_image(5, 37);  // more rows than one ZIP block holds
  write_text(folder_ / "a.exr", encode_exr(image));
  const Image back = read_exr(folder_ / "a.exr");
  EXPECT_EQ(back.width, 5u);
  EXPECT_EQ(back.height, 37u);
  EXPECT_EQ(back.rgba, image.rgba);
}

TEST_F(Exr, ChannelsAreNamedAndRowZeroIsOnTop) {
  const Image image = speaking_image(3, 2);
  write_text(folder_ / "a.exr", encode_exr(image));
  const Planes planes = read_exr_planes(folder_ / "a.exr");
  ASSERT_EQ(planes.channels.size(), 4u);
  EXPECT_EQ(planes.channels.at("R")[0], image.rgba[0]);
  EXPECT_EQ(planes.channels.at("G")[1], image.rgba[5]);
  EXPECT_EQ(planes.channels.at("B")[3], image.rgba[14]);
  EXPECT_EQ(planes.channels.at("A")[5], image.rgba[23]);
}

TEST_F(Exr, HeadersHaveLabels) {
  write_text(folder_ / "a.exr", encode_exr(speaking_image(2, 2), {{"beampipe.technique", "msaa:8"}}));
  const Imf::InputFile file((folder_ / "a.exr").c_str());
  const auto* label = file.header().findTypedAttribute<Imf::StringAttribute>("beampipe.technique");
  ASSERT_NE(label, nullptr);
  EXPECT_EQ(label->value(), "msaa:8");
}

TEST_F(Exr, APlaneOfTheWrongSizeIsAnError) {
  EXPECT_THROW(encode_exr(Planes{2, 2, {{"fragments", {0, 1, 2}}}}), std::invalid_argument);
}

TEST_F(Exr, WithoutAlphaAlphaIsOne) {
  write_exr(folder_ / "a.exr", Imf::Header(2, 1), {"R", "G", "B"});
  EXPECT_EQ(read_exr(folder_ / "a.exr").rgba, (std::vector<float>{0.25f, 0.25f, 0.25f, 1, 0.25f, 0.25f, 0.25f, 1}));
}

TEST_F(Exr, AMissingColourChannelIsAnErrorThatNamesIt) {
  write_exr(folder_ / "a.exr", Imf::Header(2, 1), {"R", "B", "A"});
  expect_parts(error_of_reading(folder_ / "a.exr"), {"no channel G"});
}

TEST_F(Exr, ADataWindowThatIsNotTheWholePictureIsAnError) {
  const Imath::Box2i whole({0, 0}, {7, 7}), part({2, 2}, {5, 5}), shifted({1, 0}, {8, 7});
  write_exr(folder_ / "part.exr", Imf::Header(whole, part), {"R", "G", "B", "A"});
  write_exr(folder_ / "shifted.exr", Imf::Header(shifted, shifted), {"R", "G", "B", "A"});
  expect_parts(error_of_reading(folder_ / "part.exr"), {"data window"});
  expect_parts(error_of_reading(folder_ / "shifted.exr"), {"data window"});
}

TEST_F(Exr, WhatIsNoImageIsAnErrorOfOneLineThatNamesTheFile) {
  write_text(folder_ / "text.exr", "{\"not\": \"an image\"}\n");
  write_text(folder_ / "empty.exr", "");
  for (const char* name : {"text.exr", "empty.exr", "missing.exr", "."}) {
    const std::string error = error_of_reading(folder_ / name);
    expect_parts(error, {(folder_ / name).string()});
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

// Whatever a header claims, memory is allocated only for what the file can contain.
TEST_F(Exr, AClaimThatTheFileCannotHoldIsAnError) {
  const std::string bytes = encode_exr(speaking_image(9, 40));
  const auto claim = [&](std::int32_t side) {
    std::string claimed = bytes;
    for (const std::string window : {"dataWindow", "displayWindow"}) {
      const std::size_t at = claimed.find(window) + window.size() + 1 + sizeof "box2i" + 4 + 8;  // the box's maximum
      for (std::size_t i = 0; i < 8; ++i) claimed[at + i] = static_cast<char>((side - 1) >> (8 * (i % 4)));
    }
    write_text(folder_ / "a.exr", claimed + std::string(1 << 16, '\1'));  // bytes that could be its line offsets
    return error_of_reading(folder_ / "a.exr");
  };
  expect_parts(claim(16384), {"it claims 16384 x 16384 pixels"});
  EXPECT_NE(claim(16385), "no error");
  EXPECT_NE(claim(1'000'000), "no error");
}

// Flat pictures take almost no space in DWA. They are read up to a size for which every machine has memory.
TEST_F(Exr, AFlatPictureInDwaIsReadUnlessItIsLarge) {
  const auto write_flat = [&](int width) {
    Imf::Header header(width, 1024);
    header.compression() = Imf::DWAB_COMPRESSION;
    write_exr(folder_ / "a.exr", header, {"R", "G", "B"});
    return std::filesystem::file_size(folder_ / "a.exr");
  };
  EXPECT_LT(1100 * write_flat(2048), 12u * 2048 * 1024);
  EXPECT_EQ(read_exr(folder_ / "a.exr").rgba.size(), 4u * 2048 * 1024);
  write_flat(6144);
  const std::string error = error_of_reading(folder_ / "a.exr");
  expect_parts(error, {"it claims 6144 x 1024 pixels"});
}

// The library allocates what an attribute claims before it reads the attribute.
TEST_F(Exr, AnAttributeThatClaimsMoreThanItHasIsAnError) {
  const auto number = [](std::uint32_t value) {
    return std::string{char(value), char(value >> 8), char(value >> 16), char(value >> 24)};
  };
  const std::string start = number(20000630) + number(2), huge = number(1'900'000'000);
  const struct {
    std::string type, size, value;
  } attributes[] = {{"unknown", huge, "rest"},
                    {"string", huge, "rest"},
                    {"floatvector", huge, "rest"},
                    {"stringvector", number(8), huge + "rest"},
                    {"preview", number(12), number(20'000) + number(20'000) + "rest"},
                    {"box2i", number(1'000'000), "rest"}};
  for (const auto& [type, size, value] : attributes) {
    const std::string attribute = "fragm" + std::string(1, '\0') + type + '\0' + size + value;
    write_text(folder_ / "a.exr", start + attribute + std::string(1000, '\0'));
    const std::string error = error_of_reading(folder_ / "a.exr");
    expect_parts(error, {"'fragm'"});
  }
}

// The library would read past the end of this list; the core would not. The list is the last attribute of a header that
// has all others.
TEST_F(Exr, AListOfChannelsWithoutItsEndIsAnError) {
  std::string bytes = encode_exr(speaking_image(4, 3));
  constexpr std::size_t kFirst = 8, kSize = sizeof "channels" + sizeof "chlist", kFourChannels = 4 * (2 + 16) + 1;
  ASSERT_EQ(bytes.find("channels"), kFirst);
  std::string channels = bytes.substr(kFirst, kSize + 4 + kFourChannels);
  ASSERT_EQ(channels[kSize]--, static_cast<char>(kFourChannels));
  bytes.erase(kFirst, channels.size());
  const std::string last = "screenWindowWidth";
  bytes.insert(bytes.find(last) + last.size() + 1 + sizeof "float" + 4 + 4, channels);
  write_text(folder_ / "a.exr", bytes);
  const std::string error = error_of_reading(folder_ / "a.exr");
  expect_parts(error, {"list of channels does not end"});
}

TEST_F(Exr, EveryTruncatedFileIsAnError) {
  const std::string bytes = encode_exr(speaking_image(9, 40));
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    write_text(folder_ / "a.exr", bytes.substr(0, size));
    EXPECT_THROW(read_exr(folder_ / "a.exr"), ImageError) << size << " of " << bytes.size() << " bytes";
  }
}

TEST(Png, IsClampedAndFollowsTheSrgbCurve) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Image image = flat_image(4, 1, 0.0f);
  const std::vector<float> reds = {0.5f, 2.0f, -1.0f, nan};
  for (std::size_t i = 0; i < 4; ++i) image.rgba[4 * i] = reds[i];
  image.rgba[1] = 1.0f;        // white
  image.rgba[2] = 0.0031308f;  // where the two parts of the curve meet: 255 * 12.92 * 0.0031308 = 10.3
  const Rgb8 rgb = decode_png(encode_png(image));
  EXPECT_EQ(rgb.width, 4u);
  EXPECT_EQ(rgb.height, 1u);
  EXPECT_EQ(rgb.bytes, (std::vector<std::uint8_t>{188, 255, 10, 255, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(Png, RowZeroIsOnTop) {
  Image image = flat_image(1, 2, 0.0f);
  image.rgba[0] = 1.0f;
  EXPECT_EQ(decode_png(encode_png(image)).bytes, (std::vector<std::uint8_t>{255, 0, 0, 0, 0, 0}));
}

}  // namespace beampipe::image_io_test

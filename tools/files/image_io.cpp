#include "tools/files/image_io.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <openexr.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "traces/files/image_file.h"
#include "traces/size_text.h"
#include "traces/srgb.h"

namespace beampipe {
namespace {

constexpr int kMaxSide = 16384;  // as in a trace
constexpr const char* kColorChannels[4] = {"R", "G", "B", "A"};

class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("memory") {}
  void write(const char bytes[], int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (bytes_.size() < end) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, bytes, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

// Describes a channel to OpenEXR: its values lie `stride` floats apart, in rows of `width` pixels.
Imf::Slice slice_of(const float* first, std::uint32_t width, std::size_t stride, double fill = 0.0) {
  // OpenEXR takes the same char* for reading and for writing.
  char* base = const_cast<char*>(reinterpret_cast<const char*>(first));
  return Imf::Slice(Imf::FLOAT, base, stride * sizeof(float), stride * sizeof(float) * width, 1, 1, fill);
}

std::string encode_channels(std::uint32_t width, std::uint32_t height, const Imf::FrameBuffer& channels,
                            const Labels& labels) {
  MemoryStream stream;
  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, text] : labels) header.insert(name, Imf::StringAttribute(text));
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    header.channels().insert(channel.name(), Imf::Channel(Imf::FLOAT));
  }
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(channels);
    file.writePixels(static_cast<int>(height));
  }  // closing the file writes its line offsets
  return stream.take();
}

struct Size {
  std::uint32_t width, height;
};

// OpenEXR's C++ library allocates as much memory as an attribute of a header claims to need. Its core library checks
// the sizes of attributes against their types and against the file, but it continues after an error. This function runs
// the core's checks and rejects the file at the first error.
void require_sound_header(const std::filesystem::path& file) {
  std::string first_error;
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.flags = EXR_CONTEXT_FLAG_STRICT_HEADER;
  settings.user_data = &first_error;
  settings.error_handler_fn = [](exr_const_context_t context, exr_result_t, const char* message) {
    void* data = nullptr;
    if (exr_get_user_data(context, &data) != EXR_ERR_SUCCESS) return;
    auto& error = *static_cast<std::string*>(data);
    if (error.empty()) error = message;
  };
  exr_context_t context = nullptr;
  const exr_result_t result = exr_start_read(&context, file.c_str(), &settings);
  if (result == EXR_ERR_SUCCESS) exr_finish(&context);
  if (first_error.empty() && result != EXR_ERR_SUCCESS) first_error = exr_get_default_error_message(result);
  if (!first_error.empty()) throw std::runtime_error(first_error);
}

// The core also accepts a list of channels without the zero that should end it. The C++ library then reads past the end
// of the list and finds attributes whose sizes have not been checked. A header is a list of attributes; each has a name
// and a type, which both end in a zero, the size of its value in 4 bytes, lowest first, and the value. An empty name
// ends the header (OpenEXR, "File Layout").
void require_ended_channels(const std::filesystem::path& file) {
  constexpr std::streamoff kMagicAndVersion = 8;
  constexpr std::size_t kChannelFields = 16;  // bytes that follow a channel's name
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(kMagicAndVersion);
  std::string name, type;
  while (std::getline(stream, name, '\0') && !name.empty() && std::getline(stream, type, '\0')) {
    unsigned char bytes[4] = {};
    stream.read(reinterpret_cast<char*>(bytes), sizeof bytes);
    const std::uint32_t size = bytes[0] | bytes[1] << 8 | bytes[2] << 16 | std::uint32_t{bytes[3]} << 24;
    std::string value(size, '\0');  // the core has checked that the file has so many bytes
    stream.read(value.data(), size);
    if (type != "chlist") continue;
    std::size_t at = 0;
    while (at < size && value[at] != '\0') at = std::min(value.find('\0', at), value.size()) + 1 + kChannelFields;
    if (at + 1 != size) throw std::runtime_error("its list of channels does not end where its attribute does");
  }
}

void require_no_png(const std::filesystem::path& file) {
  std::string start(kPngStart.size(), '\0');
  std::ifstream(file, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start == kPngStart) throw std::runtime_error("it is a PNG; expected an EXR, such as `run` and `compare` write");
}

// How many uncompressed bytes one byte of a file can stand for: up to 1032 in deflate (RFC 1951: a match of 258 bytes
// in 2 bits), fewer in RLE, PIZ and B44. DWA can shrink a flat block of 64 pixels once more by such a factor. A picture
// of more than 64 MiB is accepted only if it is not as flat as that.
constexpr std::uint64_t kMostExpansion = 1100, kMostFlatBytes = std::uint64_t{64} << 20;

void require_plausible_size(const Imf::Header& header, Size size, std::uint64_t file_bytes) {
  std::uint64_t pixel_bytes = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
    pixel_bytes += channel.channel().type == Imf::HALF ? 2 : 4;
  const bool dwa = header.compression() == Imf::DWAA_COMPRESSION || header.compression() == Imf::DWAB_COMPRESSION;
  const std::uint64_t most = std::max(file_bytes * kMostExpansion, dwa ? kMostFlatBytes : 0);
  if (pixel_bytes * size.width * size.height <= most) return;
  throw std::runtime_error("it claims " + size_text(size.width, size.height) + " pixels, too many for its " +
                           std::to_string(file_bytes) + " bytes");
}

Size checked_size(const Imf::Header& header) {
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  if (data != display || data.min != Imath::V2i(0, 0)) {
    throw std::runtime_error("its data window is not the whole picture from (0, 0)");
  }
  if (data.max.x >= kMaxSide || data.max.y >= kMaxSide) {
    throw std::runtime_error("it is larger than " + std::to_string(kMaxSide) + " pixels on a side");
  }
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
      throw std::runtime_error(std::string("its channel ") + channel.name() + " is subsampled");
    }
  }
  return {static_cast<std::uint32_t>(data.max.x + 1), static_cast<std::uint32_t>(data.max.y + 1)};
}

// Opens `file`, checks its header, and calls `load(input, size)` to read the pixels. Every failure becomes an
// ImageError.
template <typename Load>
auto read_file(const std::filesystem::path& file, Load load) {
  try {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) throw std::runtime_error("no such file");
    if (!std::filesystem::is_regular_file(file, ignored)) throw std::runtime_error("not a file");
    Imf::Header::setMaxImageSize(kMaxSide, kMaxSide);  // must be set before the library allocates what a header claims
    require_no_png(file);
    require_sound_header(file);
    require_ended_channels(file);
    Imf::InputFile input(file.c_str());
    const Size size = checked_size(input.header());
    require_plausible_size(input.header(), size, std::filesystem::file_size(file));
    return load(input, size);
  } catch (const std::exception& error) {
    throw ImageError(file.string() + ": not a readable EXR image: " + error.what());
  }
}

void read_all(Imf::InputFile& input, const Imf::FrameBuffer& channels, Size size) {
  input.setFrameBuffer(channels);
  input.readPixels(0, static_cast<int>(size.height) - 1);
}

}  // namespace

std::uint8_t srgb_byte(float linear) {
  const double clamped = linear > 0.0f ? std::min(static_cast<double>(linear), 1.0) : 0.0;  // NaN becomes 0
  return static_cast<std::uint8_t>(std::lround(255.0 * encoded_as_srgb(clamped)));
}

std::string encode_exr(const Image& image, const Labels& labels) {
  Imf::FrameBuffer channels;
  for (std::size_t i = 0; i < 4; ++i) {
    channels.insert(kColorChannels[i], slice_of(image.rgba.data() + i, image.width, 4));
  }
  return encode_channels(image.width, image.height, channels, labels);
}

std::string encode_exr(const Planes& planes, const Labels& labels) {
  Imf::FrameBuffer channels;
  for (const auto& [name, values] : planes.channels) {
    if (values.size() != std::size_t{planes.width} * planes.height) {
      throw std::invalid_argument("the per-pixel counter \"" + name + "\" does not have one value per pixel");
    }
    channels.insert(name, slice_of(values.data(), planes.width, 1));
  }
  return encode_channels(planes.width, planes.height, channels, labels);
}

std::string encode_png(const Image& image) {
  const std::size_t pixels = std::size_t{image.width} * image.height;
  std::vector<std::uint8_t> rgb(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = srgb_byte(image.rgba[4 * i + c]);
  }
  return encode_png(image.width, image.height, rgb);
}

Image read_exr(const std::filesystem::path& file) {
  return read_file(file, [](Imf::InputFile& input, Size size) {
    for (const char* channel : {"R", "G", "B"}) {
      if (!input.header().channels().findChannel(channel)) {
        throw std::runtime_error(std::string("it has no channel ") + channel);
      }
    }
    Image image{size.width, size.height, std::vector<float>(std::size_t{4} * size.width * size.height)};
    Imf::FrameBuffer channels;
    for (std::size_t i = 0; i < 4; ++i) {
      channels.insert(kColorChannels[i], slice_of(image.rgba.data() + i, size.width, 4, 1.0));
    }
    read_all(input, channels, size);
    return image;
  });
}

Planes read_exr_planes(const std::filesystem::path& file) {
  return read_file(file, [](Imf::InputFile& input, Size size) {
    Planes planes{size.width, size.height, {}};
    Imf::FrameBuffer channels;
    const Imf::ChannelList& list = input.header().channels();
    for (auto channel = list.begin(); channel != list.end(); ++channel) {
      std::vector<float>& values = planes.channels[channel.name()];
      values.resize(std::size_t{size.width} * size.height);
      channels.insert(channel.name(), slice_of(values.data(), size.width, 1));
    }
    read_all(input, channels, size);
    return planes;
  });
}

}  // namespace beampipe

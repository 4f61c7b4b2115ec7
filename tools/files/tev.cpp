// The protocol is described in tev's README.md and, packet by packet, in its src/Ipc.cpp. A packet is its own length in
// bytes, an operation, and what the operation takes. Numbers are little-endian, and a text ends with a zero byte.
#include "tools/files/tev.h"

#include <algorithm>
#include <bit>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace beampipe {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are little-endian");

constexpr std::chrono::seconds kPatience{5};
// Of pixels in a packet, so that also a slow network takes a packet in that time.
constexpr std::size_t kBandBytes = std::size_t{1} << 22;

constexpr std::uint8_t kCreateImage = 4;
constexpr std::uint8_t kUpdateImage = 6;  // the version in which channels may be interleaved
constexpr std::uint8_t kKeepFocus = 0;
constexpr std::string_view kChannels = "RGB";

template <class Number>
void append(std::string& content, Number number) {
  content.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string begin_content(std::uint8_t operation, const std::string& name) {
  std::string content;
  append(content, operation);
  append(content, kKeepFocus);
  content.append(name.c_str(), name.size() + 1);
  return content;
}

void append_channels(std::string& content) {
  append(content, static_cast<std::int32_t>(kChannels.size()));
  for (const char channel : kChannels) content.append({channel, '\0'});
}

// A black image.
std::string creation(const std::string& name, const Image& image) {
  std::string content = begin_content(kCreateImage, name);
  append(content, image.width);
  append(content, image.height);
  append_channels(content);
  return content;
}

// The pixels of some rows, with R, G and B of a pixel side by side.
std::string update(const std::string& name, const Image& image, std::uint32_t first_row, std::uint32_t rows) {
  std::string content = begin_content(kUpdateImage, name);
  append_channels(content);
  for (const std::uint32_t bound : {0u, first_row, image.width, rows}) append(content, bound);
  for (std::size_t c = 0; c < kChannels.size(); ++c) append(content, std::int64_t(c));
  for (std::size_t c = 0; c < kChannels.size(); ++c) append(content, std::int64_t(kChannels.size()));
  const std::size_t first = std::size_t{first_row} * image.width, pixels = std::size_t{rows} * image.width;
  content.reserve(content.size() + pixels * kChannels.size() * sizeof(float));
  for (std::size_t pixel = first; pixel < first + pixels; ++pixel)
    content.append(reinterpret_cast<const char*>(&image.rgba[4 * pixel]), kChannels.size() * sizeof(float));
  return content;
}

}  // namespace

struct TevViewer::Connection {
  boost::asio::ip::tcp::iostream stream;
};

TevViewer::TevViewer(const std::string& host, const std::string& port)
    : address_(host + ":" + port), connection_(std::make_unique<Connection>()) {
  auto& stream = connection_->stream;
  stream.expires_after(kPatience);
  stream.connect(host, port);
  boost::system::error_code error = stream.error(), unconnected;
  stream.socket().remote_endpoint(unconnected);
  if (!error && unconnected) error = boost::asio::error::timed_out;  // of which the stream says nothing
  if (error) throw std::runtime_error(address_ + ": expected the image viewer tev to listen there: " + error.message());
}

TevViewer::~TevViewer() = default;

void TevViewer::send(const std::string& content) {
  std::string length;
  append(length, static_cast<std::uint32_t>(sizeof(std::uint32_t) + content.size()));
  connection_->stream.expires_after(kPatience);
  connection_->stream << length << content << std::flush;
}

std::optional<std::string> TevViewer::show(const std::string& name, const Image& image) {
  if (!connection_) return {};
  const auto& stream = connection_->stream;
  send(creation(name, image));
  const std::size_t row_bytes = image.width * kChannels.size() * sizeof(float);
  const auto rows_at_once = static_cast<std::uint32_t>(std::max<std::size_t>(1, kBandBytes / row_bytes));
  for (std::uint32_t row = 0; row < image.height && stream; row += rows_at_once)
    send(update(name, image, row, std::min(rows_at_once, image.height - row)));
  if (stream) return {};
  std::string loss = "tev at " + address_ + " shows no more pictures: " + stream.error().message();
  connection_.reset();
  return loss;
}

}  // namespace beampipe

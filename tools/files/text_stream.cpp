#include "tools/files/text_stream.h"

#include <zlib.h>

#include <new>

namespace beampipe {

class TextStream::Gzip {
 public:
  Gzip() {
    constexpr int kGzip = 16;  // added to the window's size, asks for gzip's header
    if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~Gzip() { deflateEnd(&stream_); }
  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;

  void compress(std::string& text, bool is_last, AtomicFile& to) {
    stream_.next_in = reinterpret_cast<Bytef*>(text.data());
    stream_.avail_in = static_cast<uInt>(text.size());
    std::string compressed(std::size_t{1} << 16, '\0');
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(compressed.data());
      stream_.avail_out = static_cast<uInt>(compressed.size());
      deflate(&stream_, is_last ? Z_FINISH : Z_NO_FLUSH);
      to.write({compressed.data(), compressed.size() - stream_.avail_out});
    } while (stream_.avail_out == 0);
  }

 private:
  z_stream stream_{};
};

TextStream::TextStream(const std::filesystem::path& file, InterruptGate& gate) : gate_(gate) {
  const auto held = gate_.hold();
  file_.emplace(file);
  gate_.set_unfinished({AtomicFile::temporary_of(file)});
  if (file.extension() == ".gz") gzip_ = std::make_unique<Gzip>();
}

TextStream::~TextStream() {
  const auto held = gate_.hold();
  gate_.set_unfinished({});
}

void TextStream::write(std::string_view text) {
  constexpr std::size_t kPiece = 1 << 20;
  waiting_ += text;
  if (waiting_.size() >= kPiece) drain(false);
}

void TextStream::drain(bool is_last) {
  if (gzip_) {
    gzip_->compress(waiting_, is_last, *file_);
  } else {
    file_->write(waiting_);
  }
  waiting_.clear();
}

void TextStream::commit() {
  drain(true);
  file_->flush();
  const auto held = gate_.hold();
  file_->commit();
  gate_.set_unfinished({});
}

}  // namespace beampipe

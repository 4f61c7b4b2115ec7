// Which texels shading reads: where they lie in the modelled memory, and which of them are asked for at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/surface/texture_set.h"

namespace beampipe {

// A texel that was read.
struct TexelRead {
  std::uint32_t image;
  ColorSpace space;
  std::uint32_t level, x, y;
  std::uint32_t alpha_test = kNoAlphaTest;  // else it is one of the shares that pass this test, not of the image
};

// A texel of an image of programs (Trace::program_images) that was read.
struct ProgramTexelRead {
  std::uint32_t image, level;
  std::uint64_t slice;  // or layer
  std::uint64_t x, y;
};

inline constexpr std::uint64_t kTexelBytes = 4;  // 8 bits per channel, not compressed

// Images lie one after the other, once for each colour space that is read, then the shares of each alpha test, and then
// the images of programs; of an image its levels, and of a level its layers or slices, each from the start of a line of
// 128 bytes. A sector has 16 bytes of each of two rows, so 4 x 2 texels of 4 bytes, and a line 2 x 2 sectors.
//
// Source: block-linear surfaces of NVIDIA GPUs, whose sectors are 16 bytes x 2 rows (minigbm, tegra.c: GENERIC_16Bx2).
class TextureLayout {
 public:
  static constexpr std::uint32_t kSectorsPerLine = 4, kLineBytes = 128;

  explicit TextureLayout(const TextureSet& textures, const std::vector<ProgramImage>& of_programs = {});

  // Of all lines.
  std::uint64_t bytes() const { return lines_ * kLineBytes; }

  // The number of a texel's sector: kSectorsPerLine times the line, and its place there.
  std::uint64_t sector_of(const TexelRead& texel) const {
    const std::size_t first = texel.alpha_test == kNoAlphaTest ? chains_[TextureSet::index(texel.image, texel.space)]
                                                               : tests_[texel.alpha_test];
    return sector_in(levels_[first + texel.level], 0, texel.x * kTexelBytes, texel.y);
  }
  std::uint64_t sector_of(const ProgramTexelRead& texel) const {
    const OfProgram& image = of_programs_[texel.image];
    return sector_in(levels_[image.first + texel.level], texel.slice, texel.x * image.texel_bytes, texel.y);
  }

 private:
  struct Level {
    std::uint64_t first_line, lines_per_row, lines_per_slice;
  };
  struct OfProgram {
    std::size_t first;  // level
    std::uint64_t texel_bytes;
  };
  // `x`: in bytes.
  static std::uint64_t sector_in(const Level& level, std::uint64_t slice, std::uint64_t x, std::uint64_t y) {
    const std::uint64_t line = level.first_line + slice * level.lines_per_slice + y / 4 * level.lines_per_row + x / 32;
    return line * kSectorsPerLine + y % 4 / 2 * 2 + x % 32 / 16;
  }
  void add(const MipChain& chain);
  void add_level(std::uint64_t row_bytes, std::uint64_t rows, std::uint64_t slices);

  std::vector<std::size_t> chains_, tests_;  // by TextureSet::index, by alpha test: where its levels begin
  std::vector<OfProgram> of_programs_;
  std::vector<Level> levels_;
  std::uint64_t lines_ = 0;
};

// What is read together is one request, which asks for each sector once.
class TexelRequests {
 public:
  // `layout` must outlive it. Null: texels are only counted.
  explicit TexelRequests(const TextureLayout* layout) : layout_(layout) { recent_.fill(kNone); }

  // Are the requests kept, and not only the number of texels?
  bool are_kept() const { return layout_ != nullptr; }

  // Texels of which no more than their number is asked for.
  void count(std::uint64_t texels) { texels_ += texels; }

  // Into the open request.
  void read(const TexelRead& texel) { add(texel); }
  void read(const ProgramTexelRead& texel) { add(texel); }

  // The next texel begins another request.
  void end_request() {
    if (begin_ == sectors_.size()) return;
    std::sort(sectors_.begin() + static_cast<std::ptrdiff_t>(begin_), sectors_.end());
    begin_ = sectors_.size();
    ends_.push_back(begin_);
    recent_.fill(kNone);
  }

  std::uint64_t texels() const { return texels_; }  // one for each time that one was read

  // Calls visit(sectors) for each request that has ended; its sectors are in increasing order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      visit(std::span(sectors_).subspan(begin, end - begin));
      begin = end;
    }
  }

  void clear() {
    texels_ = 0, begin_ = 0;
    sectors_.clear(), ends_.clear();
    recent_.fill(kNone);
  }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  template <class Texel>
  void add(const Texel& texel) {
    ++texels_;
    if (!layout_) return;
    const std::uint64_t sector = layout_->sector_of(texel);
    std::uint64_t& recent = recent_[sector % recent_.size()];
    if (recent == sector) return;
    recent = sector;
    const auto open = sectors_.begin() + static_cast<std::ptrdiff_t>(begin_);
    if (std::find(open, sectors_.end(), sector) == sectors_.end()) sectors_.push_back(sector);
  }

  const TextureLayout* layout_;
  std::uint64_t texels_ = 0;
  std::size_t begin_ = 0;  // of the open request
  std::vector<std::uint64_t> sectors_;
  std::array<std::uint64_t, 64> recent_;  // of the open request, at their numbers: most texels lie in one of these
  std::vector<std::size_t> ends_;
};

inline void end_request(TexelRequests* texels) {
  if (texels) texels->end_request();
}

}  // namespace beampipe

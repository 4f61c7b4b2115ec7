#include "stages/surface/texel_requests.h"

namespace beampipe {

TextureLayout::TextureLayout(const TextureSet& textures, const std::vector<ProgramImage>& of_programs) {
  for (const MipChain& chain : textures.chains()) {
    chains_.push_back(levels_.size());
    add(chain);
  }
  for (const std::uint32_t image : textures.images_of_tests()) {
    tests_.push_back(levels_.size());
    add(textures.chain(image, ColorSpace::srgb));
  }
  for (const ProgramImage& image : of_programs) {
    of_programs_.push_back({levels_.size(), texel_bytes(image.format)});
    for (std::uint32_t level = 0; level < image.levels; ++level) {
      const auto side = [level](std::uint32_t of_first) { return std::uint64_t{std::max(of_first >> level, 1u)}; };
      add_level(side(image.width) * of_programs_.back().texel_bytes, side(image.height),
                image.shape == ImageShape::d3 ? side(image.depth) : image.layers);
    }
  }
}

void TextureLayout::add(const MipChain& chain) {
  for (const MipLevel& level : chain.levels) add_level(level.width * kTexelBytes, level.height, 1);
}

void TextureLayout::add_level(std::uint64_t row_bytes, std::uint64_t rows, std::uint64_t slices) {
  const std::uint64_t lines_per_row = (row_bytes + 31) / 32, lines_per_slice = lines_per_row * ((rows + 3) / 4);
  levels_.push_back({lines_, lines_per_row, lines_per_slice});
  lines_ += lines_per_slice * slices;
}

}  // namespace beampipe

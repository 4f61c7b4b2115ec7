#include "stages/surface/texel_requests.h"

namespace beampipe {

TextureLayout::TextureLayout(const TextureSet& textures) {
  for (const MipChain& chain : textures.chains()) {
    chains_.push_back(levels_.size());
    add(chain);
  }
  for (const std::uint32_t image : textures.images_of_tests()) {
    tests_.push_back(levels_.size());
    add(textures.chain(image, ColorSpace::srgb));
  }
}

void TextureLayout::add(const MipChain& chain) {
  for (const MipLevel& level : chain.levels) {
    const std::uint32_t lines_per_row = (level.width + 7) / 8;
    levels_.push_back({lines_, lines_per_row});
    lines_ += std::uint64_t{lines_per_row} * ((level.height + 3) / 4);
  }
}

}  // namespace beampipe

#include "stages/surface/texture_set.h"

#include <tbb/parallel_for.h>

#include <map>
#include <stdexcept>
#include <string>
#include <tuple>

namespace beampipe {

TextureSet::TextureSet(const Trace& trace) : chains_(2 * trace.images.size()) {
  std::vector<bool> used(chains_.size());
  const auto use = [&](const std::optional<Texture>& texture, ColorSpace space) {
    if (texture) used[index(texture->image, space)] = true;
  };
  for (const Material& material : trace.materials) {
    use(material.base_texture, ColorSpace::srgb);
    use(material.emissive_texture, ColorSpace::srgb);
    use(material.metallic_roughness_texture, ColorSpace::linear);
    use(material.normal_texture, ColorSpace::linear);
  }
  tbb::parallel_for(std::size_t{0}, chains_.size(), [&](std::size_t i) {
    if (used[i]) chains_[i] = make_mip_chain(trace.images[i / 2], i % 2 ? ColorSpace::srgb : ColorSpace::linear);
  });
  test_alphas(trace);
}

void TextureSet::test_alphas(const Trace& trace) {
  using Key = std::tuple<std::uint32_t, Wrap, Wrap, Filter, float>;
  std::map<Key, std::size_t> numbers;
  std::vector<const Material*> materials;  // by the number of their tested alpha
  std::uint64_t bytes = 0;
  tested_of_.resize(trace.materials.size());
  for (std::size_t i = 0; i < trace.materials.size(); ++i) {
    const Material& material = trace.materials[i];
    if (material.alpha_mode != AlphaMode::mask || !material.base_texture || !(material.alpha_cutoff > 0)) continue;
    const Texture& texture = *material.base_texture;
    const Key key{texture.image, texture.wrap_u, texture.wrap_v, texture.magnify, least_texture_alpha(material)};
    const auto [found, is_new] = numbers.try_emplace(key, materials.size());
    tested_of_[i] = found->second;
    if (!is_new) continue;
    materials.push_back(&material);
    bytes += trace.images[texture.image].texels.size() * sizeof(glm::u8vec4) * 4 / 3;
    if (bytes > kMostTestedBytes)
      throw std::runtime_error("cutouts test their textures at too many cutoffs: expected at most " +
                               std::to_string(kMostTestedBytes >> 20) + " MiB of results");
  }
  tested_.resize(materials.size());
  for (std::size_t i = 0; i < materials.size(); ++i)
    tested_[i] = test_alpha(*materials[i], trace.images[materials[i]->base_texture->image]);
}

}  // namespace beampipe

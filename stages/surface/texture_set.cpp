#include "stages/surface/texture_set.h"

#include <tbb/parallel_for.h>

#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

namespace beampipe {

TextureSet::TextureSet(const Trace& trace, std::string name)
    : name_(std::move(name)), programs_(trace), chains_(2 * trace.images.size()) {
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
  alpha_tests_ = number_alpha_tests(trace);
  for (std::size_t i = 0; i < alpha_tests_.size(); ++i)
    if (alpha_tests_[i] == images_of_tests_.size()) images_of_tests_.push_back(trace.materials[i].base_texture->image);
  tested_.resize(images_of_tests_.size());
}

std::vector<std::uint32_t> number_alpha_tests(const Trace& trace) {
  using Key = std::tuple<std::uint32_t, Wrap, Wrap, Filter, float>;
  std::map<Key, std::uint32_t> numbers;
  std::vector<std::uint32_t> tests(trace.materials.size(), kNoAlphaTest);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Material& material = trace.materials[i];
    if (material.alpha_mode != AlphaMode::mask || !material.base_texture || !(material.alpha_cutoff > 0)) continue;
    const Texture& texture = *material.base_texture;
    const Key key{texture.image, texture.wrap_u, texture.wrap_v, texture.magnify, least_texture_alpha(material)};
    tests[i] = numbers.try_emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
  }
  return tests;
}

void TextureSet::test_alphas(const Trace& trace, const std::vector<bool>& materials) const {
  const std::lock_guard lock(mutex_);
  std::vector<bool> is_tested;
  for (const TestedAlpha& tested : tested_) is_tested.push_back(!tested.shares.levels.empty());
  std::uint64_t bytes = tested_bytes_;
  std::vector<std::uint32_t> to_test;
  for (std::uint32_t i = 0; i < materials.size(); ++i) {
    const std::uint32_t test = alpha_tests_[i];
    if (!materials[i] || test == kNoAlphaTest || is_tested[test]) continue;
    is_tested[test] = true;
    to_test.push_back(i);
    bytes += tested_alpha_bytes(trace.images[images_of_tests_[test]]);
    if (bytes > kMostTestedBytes)
      throw std::runtime_error(name_ + ": material \"" + trace.materials[i].name +
                               "\": cutouts test their textures at too many cutoffs: expected at most " +
                               std::to_string(kMostTestedBytes >> 20) + " MiB of results");
  }
  tested_bytes_ = bytes;
  for (const std::uint32_t i : to_test)
    tested_[alpha_tests_[i]] = test_alpha(trace.materials[i], trace.images[images_of_tests_[alpha_tests_[i]]]);
}

}  // namespace beampipe

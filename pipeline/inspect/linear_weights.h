// The weights of fragments where composition is linear in their colours, and colours decide nothing. If one fragment's
// channel is 1 and all others are 0, the composed channel is that fragment's weight. RGB gives three weights at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "stages/data/fragment.h"

namespace beampipe {

// `composed(fragments)`: the pixel's colour. The weights are in the order of `fragments`.
template <class Composed>
std::vector<double> linear_weights(std::vector<Fragment> fragments, Composed&& composed) {
  std::vector<double> weights;
  for (std::size_t first = 0; first < fragments.size(); first += 3) {
    for (std::size_t k = 0; k < fragments.size(); ++k) {
      fragments[k].color = glm::vec3(0.0f);
      if (k >= first && k < first + 3) fragments[k].color[static_cast<int>(k - first)] = fragments[k].alpha;
    }
    const glm::vec3 found = composed(fragments);
    for (std::size_t k = first; k < fragments.size() && k < first + 3; ++k)
      weights.push_back(found[static_cast<int>(k - first)]);
  }
  return weights;
}

}  // namespace beampipe

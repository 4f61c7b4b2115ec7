// From the number of a mask's positions, which is known at run time, to code that is compiled for its words.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace beampipe {

// Calls shape.operator()<Words>() for a mask of so many positions, 32 a word: with_words<1, 8>(256, shape) calls that
// for 8. Throws std::invalid_argument if it is none of those that are listed.
template <std::size_t Words, std::size_t... Others, class Shape>
auto with_words(int positions, Shape&& shape) {
  if (positions == 32 * Words) return shape.template operator()<Words>();
  if constexpr (sizeof...(Others) > 0) {
    return with_words<Others...>(positions, shape);
  } else {
    throw std::invalid_argument("no pixel has " + std::to_string(positions) + " positions");
  }
}

}  // namespace beampipe

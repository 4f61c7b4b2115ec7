// Asks for an object's cache lines ahead of their use: what lies in no order would be waited for.
#pragma once

#include <cstddef>

namespace beampipe {

template <class Object>
void prefetch(const Object& object) {
  constexpr std::size_t kLine = 64;
  const char* const first = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof(Object); at += kLine) __builtin_prefetch(first + at);
  __builtin_prefetch(first + sizeof(Object) - 1);  // an object that is not aligned may end in one more line
}

}  // namespace beampipe

#include "tests/pipeline/counted_heap.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace beampipe {
namespace {

std::atomic<std::int64_t> held{0}, peak{0}, given{0};

void count(std::int64_t bytes) {
  const std::int64_t now = held += bytes;
  if (bytes > 0) given += bytes;
  std::int64_t most = peak;
  while (now > most && !peak.compare_exchange_weak(most, now)) {
  }
}

}  // namespace

std::int64_t heap_bytes() { return held; }
std::int64_t heap_peak() { return peak; }
std::int64_t heap_given() { return given; }
void restart_heap_peak() { peak = held.load(); }

}  // namespace beampipe

void* operator new(std::size_t bytes) {
  void* const memory = std::malloc(bytes);
  if (!memory) throw std::bad_alloc();
  beampipe::count(static_cast<std::int64_t>(malloc_usable_size(memory)));
  return memory;
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {  // a sanitizer's own operator would not count
  try {
    return operator new(bytes);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept {
  if (memory) beampipe::count(-static_cast<std::int64_t>(malloc_usable_size(memory)));
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }

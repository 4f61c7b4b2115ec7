#include "tools/machine_memory.h"

#include <unistd.h>

#include <stdexcept>

namespace beampipe {

std::uint64_t machine_memory() {
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void require_memory(const Technique& technique, const Frame& frame, const std::string& name, std::uint64_t memory) {
  const std::uint64_t needed = std::uint64_t{frame.width} * frame.height * technique.working_bytes_per_pixel;
  if (needed <= memory) return;
  throw std::runtime_error(name + ": " + technique.spec + " needs at least " + std::to_string(needed >> 20) +
                           " MiB for " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                           " pixels, and this machine has " + std::to_string(memory >> 20));
}

}  // namespace beampipe

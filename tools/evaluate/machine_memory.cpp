#include "tools/evaluate/machine_memory.h"

#include <unistd.h>

#include <stdexcept>

#include "stages/data/setup_triangle.h"

namespace beampipe {

std::uint64_t machine_memory() {
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void require_memory(const Trace& trace, const Frame& frame, std::uint32_t bytes_per_pixel, const std::string& name,
                    std::uint64_t memory) {
  std::uint64_t triangles = 0;
  for (const Draw& draw : frame.draws) triangles += trace.meshes[draw.mesh].triangles.size();
  const std::uint64_t pixels = std::uint64_t{frame.width} * frame.height;
  const std::uint64_t needed = pixels * bytes_per_pixel + triangles * SetupTriangles::kTriangleBytes;
  if (needed <= memory) return;
  throw std::runtime_error(name + ": " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                           " pixels and " + std::to_string(triangles) + " triangles may need " +
                           std::to_string(needed >> 20) + " MiB, and this machine has " + std::to_string(memory >> 20));
}

}  // namespace beampipe

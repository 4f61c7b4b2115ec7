#include "pipeline/units/compose_units.h"

#include "pipeline/memory/aggregate_memory.h"

namespace beampipe {

void charge_aggregates(Bin& bin, const std::vector<Surface>& framebuffer, const std::vector<bool>& written,
                       const std::vector<bool>& full) {
  if (!bin.models_memory()) return;
  const ZOrder& order = bin.z_order();
  std::vector<std::uint32_t> written_at(order.positions, ~0u);
  for (std::uint32_t pixel = 0; pixel < written.size(); ++pixel)
    if (written[pixel]) written_at[order.of[pixel]] = pixel;
  StageCounters& compose = bin.stage(StageId::compose).counters;
  AggregateMemory memory(bin.memory(), order, framebuffer);
  for (const std::uint32_t pixel : written_at)
    if (pixel != ~0u) memory.write(pixel, compose);
  memory.flush(full, compose);
  memory.read_all(bin.stage(StageId::resolve).counters);
  memory.add_bytes(bin.pixel_counter("bytes"));
}

}  // namespace beampipe

#include "pipeline/memory/geometry_memory.h"

#include <algorithm>

namespace beampipe {
namespace {

// Adds the places of the triangles' records to `places`. `end`: bytes of the lines that are in use so far.
void place_records(const TriangleList& list, std::uint32_t record_bytes, std::uint32_t line_bytes,
                   std::vector<std::uint32_t>& places, std::uint32_t& end) {
  std::uint64_t last_line = ~std::uint64_t{0};
  for (const std::uint32_t triangle : list) {
    const std::uint64_t at = std::uint64_t{triangle} * record_bytes;
    const std::uint64_t first = at / line_bytes, last = (at + record_bytes - 1) / line_bytes;
    if (first != last_line) end += line_bytes;
    places.push_back(end - line_bytes + static_cast<std::uint32_t>(at % line_bytes));
    end += static_cast<std::uint32_t>(last - first) * line_bytes;
    last_line = last;
  }
}

}  // namespace

void move_setup(const MemoryParameters& memory, std::uint64_t vertex_bytes, std::size_t triangles,
                StageCounters& counters) {
  stream(memory, vertex_bytes, counters);
  stream(memory, triangles * sizeof(SetupTriangle), counters);
  stream(memory, triangles * sizeof(FlatAttributes), counters);
}

void write_list(const MemoryParameters& memory, const TriangleList& list, StageCounters& counters) {
  stream(memory, list.size() * sizeof list[0], counters);
}

void read_list(const MemoryParameters& memory, const TriangleList& list, StageCounters& counters) {
  stream(memory, list.size() * sizeof list[0], counters);
}

void read_bin(const MemoryParameters& memory, const TriangleList& list, StageCounters& counters) {
  read_list(memory, list, counters);
  RecordsInOrder setup(memory, sizeof(SetupTriangle));
  for (const std::uint32_t triangle : list) setup.read(triangle, counters);
}

TriangleFetches::TriangleFetches(const MemoryParameters& memory, const TriangleList& list)
    : modelled_(memory.modelled),
      list_(list),
      places_(modelled_ ? places_of(list, memory.l2.line_bytes) : Places{}),
      lines_(memory, places_.end) {}

TriangleFetches::Places TriangleFetches::places_of(const TriangleList& list, std::uint32_t line_bytes) {
  Places places;
  place_records(list, sizeof(SetupTriangle), line_bytes, places.setup, places.end);
  place_records(list, sizeof(FlatAttributes), line_bytes, places.attributes, places.end);
  return places;
}

void TriangleFetches::load_setup() {
  StageCounters counted_there;
  lines_.read_through_l2(places_.setup, sizeof(SetupTriangle), counted_there);
}

void TriangleFetches::read_setup(const TriangleList& sorted, StageCounters& counters) {
  if (!modelled_) return;
  std::vector<std::uint32_t> places;
  for (const std::uint32_t triangle : sorted) places.push_back(places_.setup[rank(triangle)]);
  lines_.read_through_l2(places, sizeof(SetupTriangle), counters);
}

std::size_t TriangleFetches::rank(std::uint32_t triangle) const {
  return static_cast<std::size_t>(std::lower_bound(list_.begin(), list_.end(), triangle) - list_.begin());
}

}  // namespace beampipe

#include "pipeline/memory/geometry_memory.h"

#include <algorithm>
#include <bit>
#include <string>

namespace beampipe {
namespace {

constexpr ArrayName kBinLists{"bin_lists"};

}  // namespace

void move_setup(const MemorySystem& memory, std::uint64_t vertex_bytes, std::size_t triangles,
                std::uint64_t surface_bytes, StageCounters& counters) {
  stream(memory, DramAccess::read, {"meshes", false}, vertex_bytes, counters);
  const MemorySystem stored = of_triangles(memory);
  stream(stored, DramAccess::write, {kSetupArray, false}, triangles * sizeof(SetupTriangle), counters);
  stream(stored, DramAccess::write, {kAttributesArray, false}, triangles * sizeof(FlatAttributes), counters);
  stream(stored, DramAccess::write, {"surfaces", false}, surface_bytes, counters);
}

void write_list(const MemorySystem& memory, const TriangleList& list, StageCounters& counters) {
  stream(of_triangles(memory), DramAccess::write, kBinLists, list.size() * sizeof list[0], counters);
}

void read_list(const MemorySystem& memory, const TriangleList& list, StageCounters& counters) {
  stream(of_triangles(memory), DramAccess::read, kBinLists, list.size() * sizeof list[0], counters);
}

void read_bin(const MemorySystem& memory, const TriangleList& list, StageCounters& counters) {
  read_list(memory, list, counters);
  RecordsInOrder setup(of_triangles(memory), kSetupArray, sizeof(SetupTriangle));
  for (const std::uint32_t triangle : list) setup.read(triangle, counters);
}

ListRanks::ListRanks(const TriangleList& list)
    : entries_(std::bit_ceil(2 * list.size() + 2)), shift_(32 - std::countr_zero(entries_.size())) {
  for (std::uint32_t rank = 0; rank < list.size(); ++rank) {
    std::size_t place = hash(list[rank]);
    while (entries_[place].rank != ~0u) place = (place + 1) & (entries_.size() - 1);
    entries_[place] = {list[rank], rank};
  }
}

TriangleFetches::TriangleFetches(const MemorySystem& memory, const TriangleList& list, const SurfaceShader* shader)
    : modelled_(memory.stores_triangles()),
      shader_(shader && !shader->is_flat() ? shader : nullptr),
      ranks_(modelled_ ? list : TriangleList{}),
      places_(modelled_ ? places_of(memory, list) : Places{}),
      lines_(of_triangles(memory), places_.end, std::move(places_.lines)) {}

void TriangleFetches::place_records(const TriangleList& list, std::string_view array, std::uint32_t record_bytes,
                                    std::uint32_t line_bytes, std::vector<std::uint32_t>& offsets, Places& places) {
  DramLog* const log = places.lines.log;
  const std::uint16_t number = log ? log->array(array, false) : 0;
  if (places.lines.tally) places.lines.parts.push_back({places.end / line_bytes, places.lines.tally->array(array)});
  std::uint64_t last_line = ~std::uint64_t{0};
  for (const std::uint32_t record : list) {
    const std::uint64_t at = std::uint64_t{record} * record_bytes;
    const std::uint64_t first = at / line_bytes, last = (at + record_bytes - 1) / line_bytes;
    if (log)
      for (std::uint64_t line = first == last_line ? first + 1 : first; line <= last; ++line)
        places.lines.lines.push_back({number, line});
    if (first != last_line) places.end += line_bytes;
    offsets.push_back(places.end - line_bytes + static_cast<std::uint32_t>(at % line_bytes));
    places.end += static_cast<std::uint32_t>(last - first) * line_bytes;
    last_line = last;
  }
}

TriangleFetches::Places TriangleFetches::places_of(const MemorySystem& memory, const TriangleList& list) const {
  Places places;
  places.lines.log = memory.log;
  places.lines.tally = memory.tally;
  const std::uint32_t line_bytes = memory.l2.line_bytes;
  place_records(list, kSetupArray, sizeof(SetupTriangle), line_bytes, places.setup, places);
  place_records(list, kAttributesArray, sizeof(FlatAttributes), line_bytes, places.attributes, places);
  if (shader_) place_surfaces(list, line_bytes, places);
  return places;
}

// The vertices of a draw follow each other, and all of them have the same size.
void TriangleFetches::place_surfaces(const TriangleList& list, std::uint32_t line_bytes, Places& places) const {
  place_records(list, "surface_planes", kSurfaceBytes, line_bytes, places.surfaces, places);
  struct Vertex {
    std::uint32_t number, bytes;
    auto operator<=>(const Vertex&) const = default;
  };
  std::vector<Vertex> vertices;
  for (const std::uint32_t triangle : list)
    if (!is_flat(triangle))
      for (const std::uint32_t vertex : shader_->vertices(triangle))
        vertices.push_back({vertex, vertex_bytes(triangle)});
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const Vertex& vertex : vertices) places.vertices.push_back(vertex.number);
  for (std::size_t first = 0, end = 0; first < vertices.size(); first = end) {
    while (end < vertices.size() && vertices[end].bytes == vertices[first].bytes) ++end;
    const auto begin = places.vertices.begin();
    place_records({begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(end)},
                  "surface_vertices_" + std::to_string(vertices[first].bytes), vertices[first].bytes, line_bytes,
                  places.vertex_places, places);
  }
}

void TriangleFetches::surface(std::uint32_t triangle, StageCounters& counters) {
  ++surface_fetches_;
  lines_.read(surface_fetches_, places_.surfaces[rank(triangle)], kSurfaceBytes, counters);
  const std::uint32_t bytes = vertex_bytes(triangle);
  for (const std::uint32_t vertex : shader_->vertices(triangle)) {
    const auto found = std::lower_bound(places_.vertices.begin(), places_.vertices.end(), vertex);
    lines_.read(surface_fetches_, places_.vertex_places[static_cast<std::size_t>(found - places_.vertices.begin())],
                bytes, counters);
  }
}

void TriangleFetches::load_setup() {
  StageCounters counted_there;
  lines_.read_through_l2(places_.setup, sizeof(SetupTriangle), counted_there);
}

void TriangleFetches::read_setup(const TriangleList& sorted, StageCounters& counters) {
  if (!modelled_) return;
  std::vector<std::uint32_t> places;
  places.reserve(sorted.size());
  for (const std::uint32_t triangle : sorted) places.push_back(places_.setup[rank(triangle)]);
  lines_.read_through_l2(places, sizeof(SetupTriangle), counters);
}

}  // namespace beampipe

#include "tools/evaluate/memory_system.h"

#include <algorithm>
#include <bit>
#include <string_view>

#include "pipeline/memory/dram_log.h"

namespace beampipe {
namespace {

// Elements of the framebuffer's blocks have up to 256 bytes.
constexpr std::uint32_t kLeastRopLine = 256, kMostLine = 1024, kMostWays = 1024;
constexpr std::uint32_t kMostL1 = 1u << 24, kMostCache = 1u << 28, kMostOnChip = 1u << 31;
constexpr std::string_view kPlaces[] = {kByTechnique, kOnChip, kInMemory};

std::uint32_t power_of_two(const JsonCursor& value, std::uint32_t low, std::uint32_t high) {
  const std::uint32_t number = value.integer(low, high);
  if (!std::has_single_bit(number))
    value.fail("a power of two from " + std::to_string(low) + " to " + std::to_string(high));
  return number;
}

void set_place(MemoryParameters& memory, const JsonCursor& value) {
  const std::size_t place = value.choice(std::span(kPlaces));
  memory.framebuffer = place == 0   ? std::nullopt
                       : place == 1 ? std::optional(Place::on_chip)
                                    : std::optional(Place::in_memory);
}

}  // namespace

const std::vector<MemoryParameter>& memory_parameters() {
  using Memory = MemoryParameters;
  using At = JsonCursor;
  static const std::vector<MemoryParameter> all = {
      {"sector_bytes", "bytes", "the unit that moves in every cache and to and from DRAM",
       [](const Memory& m) { return Json(m.sector_bytes); },
       [](Memory& m, const At& at) { m.sector_bytes = power_of_two(at, kLeastSectorBytes, 128); }},
      {"line_bytes", "bytes", "a line of L1 and of L2: 1 to 8 sectors",
       [](const Memory& m) { return Json(m.l2.line_bytes); },
       [](Memory& m, const At& at) {
         m.l1.line_bytes = m.l2.line_bytes = power_of_two(at, kLeastSectorBytes, kMostLine);
       }},
      {"l1_bytes", "bytes", "the L1 through which shaders read, and its texture cache",
       [](const Memory& m) { return Json(m.l1.bytes); },
       [](Memory& m, const At& at) { m.l1.bytes = at.integer(kLeastSectorBytes, kMostL1); }},
      {"l1_ways", "", "lines in a set of L1", [](const Memory& m) { return Json(m.l1.ways); },
       [](Memory& m, const At& at) { m.l1.ways = at.integer(1, kMostWays); }},
      {"l2_bytes", "bytes", "the L2 for what shaders read and write", [](const Memory& m) { return Json(m.l2.bytes); },
       [](Memory& m, const At& at) { m.l2.bytes = at.integer(kLeastSectorBytes, kMostCache); }},
      {"l2_ways", "", "lines in a set of L2", [](const Memory& m) { return Json(m.l2.ways); },
       [](Memory& m, const At& at) { m.l2.ways = at.integer(1, kMostWays); }},
      {"rop_bytes", "bytes", "the cache of each class of framebuffer surfaces in memory",
       [](const Memory& m) { return Json(m.rop.bytes); },
       [](Memory& m, const At& at) { m.rop.bytes = at.integer(kLeastRopLine, kMostCache); }},
      {"rop_ways", "", "lines in a set of these caches", [](const Memory& m) { return Json(m.rop.ways); },
       [](Memory& m, const At& at) { m.rop.ways = at.integer(1, kMostWays); }},
      {"rop_line_bytes", "bytes", "a line of these caches, and a block of a surface: 1 to 8 sectors",
       [](const Memory& m) { return Json(m.rop.line_bytes); },
       [](Memory& m, const At& at) { m.rop.line_bytes = power_of_two(at, kLeastRopLine, kMostLine); }},
      {"compression", "", "whether blocks of surfaces are compressed",
       [](const Memory& m) { return Json(m.compression); },
       [](Memory& m, const At& at) { m.compression = at.boolean(); }},
      {"plane_bytes", "bytes", "a depth plane in a compressed block",
       [](const Memory& m) { return Json(m.plane_bytes); },
       [](Memory& m, const At& at) { m.plane_bytes = at.integer(1, 64); }},
      {"framebuffer", "", "where the pixels of a bin are while it is drawn",
       [](const Memory& m) { return Json(name_of(m.framebuffer)); }, set_place},
      {"on_chip_bytes", "bytes", "the memory on chip for the pixels of a bin",
       [](const Memory& m) { return Json(m.on_chip_bytes); },
       [](Memory& m, const At& at) { m.on_chip_bytes = at.integer(1, kMostOnChip); }},
      {"bin_pixels", "px", "the most pixels on each side of a bin; techniques whose bins are smaller keep them",
       [](const Memory& m) { return Json(m.bin_pixels); },
       [](Memory& m, const At& at) { m.bin_pixels = power_of_two(at, 8, kBinSize); }},
  };
  return all;
}

Json parameters_json(const MemoryParameters& memory) {
  Json json = Json::object();
  for (const MemoryParameter& parameter : memory_parameters()) json[parameter.name] = parameter.get(memory);
  return json;
}

std::optional<MemoryConflict> find_conflict(const MemoryParameters& memory) {
  const auto line = [&](const char* name, const CacheParameters& cache) -> std::optional<MemoryConflict> {
    const std::uint32_t most = kMaxBlockSectors * memory.sector_bytes;
    if (cache.line_bytes >= memory.sector_bytes && cache.line_bytes <= most) return std::nullopt;
    return MemoryConflict{name,
                          "1 to 8 sectors, " + std::to_string(memory.sector_bytes) + " to " + std::to_string(most),
                          cache.line_bytes};
  };
  const auto room = [&](const char* name, const CacheParameters& cache) -> std::optional<MemoryConflict> {
    const std::uint32_t least = cache.ways * cache.line_bytes;
    if (cache.bytes >= least) return std::nullopt;
    return MemoryConflict{name,
                          "room for one set of " + std::to_string(cache.ways) + " ways x " +
                              std::to_string(cache.line_bytes) + " bytes, at least " + std::to_string(least),
                          cache.bytes};
  };
  for (const auto& conflict : {line("line_bytes", memory.l2), line("rop_line_bytes", memory.rop),
                               room("l1_bytes", memory.l1), room("l2_bytes", memory.l2), room("rop_bytes", memory.rop)})
    if (conflict) return conflict;
  return std::nullopt;
}

void set_parameters(MemoryParameters& memory, const JsonCursor& values) {
  std::vector<std::string_view> names;
  for (const MemoryParameter& parameter : memory_parameters()) names.push_back(parameter.name);
  values.expect_keys(names);
  for (const MemoryParameter& parameter : memory_parameters())
    if (const auto value = values.find(parameter.name)) parameter.set(memory, *value);
  if (const std::optional<MemoryConflict> conflict = find_conflict(memory)) {
    const auto value = values.find(conflict->name);  // else what it conflicts with was set
    (value ? *value : values)
        .fail((value ? "" : std::string(conflict->name) + " of ") + conflict->expected,
              std::to_string(conflict->found));
  }
}

MemoryParameters parse_memory_system(const Json& json, const std::string& file) {
  const JsonCursor root(json, file);
  root.expect_keys({"beampipe_memory_system", "parameters", "sources"});
  root["beampipe_memory_system"].integer(1, 1);
  const JsonCursor parameters = root["parameters"], sources = root["sources"];
  MemoryParameters memory;
  set_parameters(memory, parameters);
  std::vector<std::string_view> given;
  for (const MemoryParameter& parameter : memory_parameters()) {
    if (!parameters.has(parameter.name)) continue;
    given.push_back(parameter.name);
    const JsonCursor source = sources[parameter.name];
    if (source.string().empty()) source.fail("where the value is from, or that it is a choice", "nothing");
  }
  sources.expect_keys(given);
  return memory;
}

MemoryParameters read_memory_system(const std::string& file) { return parse_memory_system(parse_json(file), file); }

}  // namespace beampipe

#include "tools/evaluate/memory_system.h"

#include <algorithm>
#include <string_view>

#include "pipeline/memory/dram_log.h"
#include "tools/evaluate/known_specs.h"
#include "tools/files/format.h"

namespace beampipe {
namespace {

// Elements of the framebuffer's blocks have up to 256 bytes.
constexpr std::uint32_t kLeastRopLine = 256, kMostLine = 1024, kMostWays = 1024;
constexpr std::uint32_t kMostL1 = 1u << 24, kMostCache = 1u << 28, kMostOnChip = 1u << 31;
constexpr std::string_view kPlaces[] = {kByTechnique, kOnChip, kInMemory};

// Where the pixels of a bin are.
Form<std::optional<Place>> place_form() {
  const Form<std::uint32_t> number = form::choice<std::uint32_t>(kPlaces);
  return {number.schema,
          [number](const JsonCursor& at, std::optional<Place>& place) {
            constexpr std::optional<Place> kPlaceOf[] = {std::nullopt, Place::on_chip, Place::in_memory};  // kPlaces
            place = kPlaceOf[number(at)];
          },
          [](const std::optional<Place>& place) { return Json(name_of(place)); }};
}

// Bytes of a line of L1 and of L2.
Field<MemoryParameters> line_field() {
  const Form<std::uint32_t> form = form::power_of_two(kLeastSectorBytes, kMostLine);
  return {.key = "line_bytes",
          .meaning = "a line of L1 and of L2: 1 to 8 sectors",
          .required = false,
          .schema = form.schema,
          .read = [form](const JsonCursor& at, MemoryParameters& m) { m.l1.line_bytes = m.l2.line_bytes = form(at); },
          .get = [](const MemoryParameters& m) { return Json(m.l2.line_bytes); }};
}

std::vector<MemoryParameter> all_parameters() {
  std::vector<MemoryParameter> all;
  const auto add = [&](Field<MemoryParameters> field, const char* unit) {
    field.schema["default"] = field.get({});
    all.push_back({std::move(field), unit});
  };
  const auto place = [&](const char* key, const char* unit, const char* meaning, auto where, const auto& form) {
    add({.key = key,
         .meaning = meaning,
         .required = false,
         .schema = form.schema,
         .read = [where, form](const JsonCursor& at, MemoryParameters& m) { form.read(at, std::invoke(where, m)); },
         .get = [where, form](const MemoryParameters& m) { return form.write(std::invoke(where, m)); }},
        unit);
  };
  using Memory = MemoryParameters;
  using form::integer;
  place("sector_bytes", "bytes", "the unit that moves in every cache and to and from DRAM", &Memory::sector_bytes,
        form::power_of_two(kLeastSectorBytes, 128));
  add(line_field(), "bytes");
  place(
      "l1_bytes", "bytes", "the L1 through which shaders read, and its texture cache",
      [](auto& m) -> auto& { return m.l1.bytes; }, integer(kLeastSectorBytes, kMostL1));
  place(
      "l1_ways", "", "lines in a set of L1", [](auto& m) -> auto& { return m.l1.ways; }, integer(1, kMostWays));
  place(
      "l2_bytes", "bytes", "the L2 for what shaders read and write", [](auto& m) -> auto& { return m.l2.bytes; },
      integer(kLeastSectorBytes, kMostCache));
  place(
      "l2_ways", "", "lines in a set of L2", [](auto& m) -> auto& { return m.l2.ways; }, integer(1, kMostWays));
  place(
      "rop_bytes", "bytes", "the cache of each class of framebuffer surfaces in memory",
      [](auto& m) -> auto& { return m.rop.bytes; }, integer(kLeastRopLine, kMostCache));
  place(
      "rop_ways", "", "lines in a set of these caches", [](auto& m) -> auto& { return m.rop.ways; },
      integer(1, kMostWays));
  place(
      "rop_line_bytes", "bytes", "a line of these caches, and a block of a surface: 1 to 8 sectors",
      [](auto& m) -> auto& { return m.rop.line_bytes; }, form::power_of_two(kLeastRopLine, kMostLine));
  place("compression", "", "whether blocks of surfaces are compressed", &Memory::compression, form::boolean());
  place("plane_bytes", "bytes", "a depth plane in a compressed block", &Memory::plane_bytes, integer(1, 64));
  place("framebuffer", "", "where the pixels of a bin are while it is drawn", &Memory::framebuffer, place_form());
  place("on_chip_bytes", "bytes", "the memory that a core has on chip for the pixels of bins", &Memory::on_chip_bytes,
        integer(1, kMostOnChip));
  place("bins_per_core", "bins", "how many bins of 32 x 32 pixels a core works on at a time; of smaller ones, more",
        &Memory::bins_per_core, integer(1, 64));
  place("cores", "cores", "how many cores work on bins", &Memory::cores, integer(1, 65536));
  place("binned", "", "whether triangles are sorted into bins; if not, each is drawn over the whole frame at once",
        &Memory::binned, form::boolean());
  place("bin_pixels", "px", "the most pixels on each side of a bin; techniques whose bins are smaller keep them",
        &Memory::bin_pixels, form::power_of_two(8, kBinSize));
  return all;
}

}  // namespace

const std::vector<MemoryParameter>& memory_parameters() {
  static const std::vector<MemoryParameter> all = all_parameters();
  return all;
}

Json parameters_json(const MemoryParameters& memory) {
  Json json = Json::object();
  for (const MemoryParameter& parameter : memory_parameters()) json[parameter.key] = parameter.get(memory);
  return json;
}

std::optional<MemoryConflict> find_conflict(const MemoryParameters& memory) {
  const auto line = [&](const char* name, const CacheParameters& cache) -> std::optional<MemoryConflict> {
    const std::uint32_t most = kMaxBlockSectors * memory.sector_bytes;
    if (cache.line_bytes >= memory.sector_bytes && cache.line_bytes <= most) return std::nullopt;
    return MemoryConflict{name,
                          "1 to 8 sectors, " + std::to_string(memory.sector_bytes) + " to " + std::to_string(most),
                          std::to_string(cache.line_bytes)};
  };
  const auto room = [&](const char* name, const CacheParameters& cache) -> std::optional<MemoryConflict> {
    const std::uint32_t least = cache.ways * cache.line_bytes;
    if (cache.bytes >= least) return std::nullopt;
    return MemoryConflict{name,
                          "room for one set of " + std::to_string(cache.ways) + " ways x " +
                              std::to_string(cache.line_bytes) + " bytes, at least " + std::to_string(least),
                          std::to_string(cache.bytes)};
  };
  for (const auto& conflict : {line("line_bytes", memory.l2), line("rop_line_bytes", memory.rop),
                               room("l1_bytes", memory.l1), room("l2_bytes", memory.l2), room("rop_bytes", memory.rop)})
    if (conflict) return conflict;
  if (!memory.binned && memory.framebuffer == Place::on_chip)
    return MemoryConflict{"framebuffer", "in-memory or by-technique where nothing is binned", kOnChip};
  return std::nullopt;
}

std::string no_room_text(const MemoryParameters& memory, const Framebuffer& framebuffer) {
  if (!framebuffer.finds_no_room(memory)) return "";
  const int side = std::min(framebuffer.bin_size_on(memory), kLeastBinSize);  // the smallest that was tried
  return format("a bin of %d x %d pixels needs %.1f KiB, a core has %.1f KiB", side, side,
                side * side * framebuffer.on_chip_bytes_per_pixel() / 1024.0, memory.on_chip_bytes / 1024.0);
}

bool lacks_bins(const MemoryParameters& memory, const Technique& technique) {
  return memory.draws_unbinned() && technique.framebuffer.needs_bins && !is_reference(technique.spec);
}

namespace {

Form<MemoryParameters> parameters_form() {
  ObjectForm<MemoryParameters> object;
  for (const MemoryParameter& parameter : memory_parameters()) object.add(parameter);
  return object.check([](const JsonCursor& at, const MemoryParameters& memory) {
    const std::optional<MemoryConflict> conflict = find_conflict(memory);
    if (!conflict) return;
    const auto value = at.find(conflict->name);  // else what it conflicts with was set
    (value ? *value : at)
        .fail((value ? "" : std::string(conflict->name) + " of ") + conflict->expected, conflict->found);
  });
}

// Sources of some of the parameters, or of those that an object has.
Form<std::map<std::string, std::string>> sources_form(const JsonCursor* parameters) {
  std::vector<form::Key> keys;
  for (const MemoryParameter& parameter : memory_parameters())
    if (!parameters || parameters->has(parameter.key)) keys.push_back({parameter.key, "Of this parameter."});
  return form::record(keys, parameters != nullptr, form::text("where the value is from, or that it is a choice"));
}

}  // namespace

Form<MemoryParameters> memory_system_form() {
  return ObjectForm<MemoryParameters>()
      .required("parameters", std::identity(), parameters_form(),
                "The parameters that differ from the default's, or all of them.")
      .add(form::unused<MemoryParameters>("sources", true, sources_form(nullptr),
                                          "Where each of these parameters is from, or that it is a choice, by its "
                                          "name. Parameters that are left out have none."))
      .check([](const JsonCursor& at, const MemoryParameters&) {
        const JsonCursor parameters = at["parameters"];
        sources_form (&parameters)(at["sources"]);
      });
}

void set_parameters(MemoryParameters& memory, const JsonCursor& values) { parameters_form().read(values, memory); }

std::optional<MemoryDifference> find_difference(const MemoryParameters& first, const MemoryParameters& second,
                                                const std::vector<std::string>& except) {
  for (const MemoryParameter& parameter : memory_parameters()) {
    if (std::find(except.begin(), except.end(), parameter.key) != except.end()) continue;
    const Json a = parameter.get(first), b = parameter.get(second);
    if (a != b) return MemoryDifference{parameter.key, a, b};
  }
  return std::nullopt;
}

}  // namespace beampipe

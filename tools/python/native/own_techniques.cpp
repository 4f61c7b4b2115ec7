// Techniques of the user's, which call functions of Python; and the program with such techniques.
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/bins/render_bins.h"
#include "pipeline/sampling.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/a_buffer_unit.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/data/position_set.h"
#include "stages/picture/resolve.h"
#include "tools/cli/program.h"
#include "tools/python/native/bindings.h"
#include "tools/python/native/trace_handle.h"

namespace beampipe {
namespace {

namespace py = pybind11;

// A function that any thread may call and forget; it takes the interpreter's lock for both.
class SharedFunction {
 public:
  explicit SharedFunction(py::function function)
      : function_(new py::function(std::move(function)), [](py::function* held) {
          const py::gil_scoped_acquire lock;
          delete held;
        }) {}

  // make_arguments() is called with the lock held, and so is take(result).
  template <class MakeArguments, class Take>
  auto operator()(const MakeArguments& make_arguments, const Take& take) const {
    const py::gil_scoped_acquire lock;
    return take((*function_)(*make_arguments()));
  }

 private:
  std::shared_ptr<py::function> function_;
};

// function(trace, frame) returns the frame's picture: an array of height x width x 4.
Technique function_technique(const std::string& name, const SharedFunction& function) {
  Technique technique;
  technique.spec = name;
  technique.renderer = [function](const Trace& trace, std::size_t frame, const FrameInput&, const FrameSinks&) {
    FrameResult result;
    result.image = function([&] { return py::make_tuple(TraceHandle(trace, "trace"), frame); },
                            [](const py::object& picture) { return image_of(FloatArray(picture), "picture"); });
    return result;
  };
  return technique;
}

// What a rule is given: the bin's place, columns of all its fragments, and where each pixel's begin.
py::tuple columns_of(const std::vector<Fragment>& fragments, const ABuffer& lists, int positions, std::size_t frame,
                     const Tile& tile) {
  const auto count = static_cast<py::ssize_t>(lists.records.size()), bits = static_cast<py::ssize_t>(positions);
  py::array_t<std::uint32_t> first(static_cast<py::ssize_t>(lists.first.size()));
  std::ranges::copy(lists.first, first.mutable_data());
  py::array_t<float> area(count), depth(count), plane({count, py::ssize_t{3}}), color({count, py::ssize_t{3}});
  py::array_t<bool> front(count), mask({count, bits});
  for (py::ssize_t i = 0; i < count; ++i) {
    const Fragment& fragment = fragments[lists.records[static_cast<std::size_t>(i)]];
    area.mutable_at(i) = fragment.alpha;
    depth.mutable_at(i) = fragment.centroid_z;
    front.mutable_at(i) = fragment.front;
    plane.mutable_at(i, 0) = fragment.plane.z;
    plane.mutable_at(i, 1) = fragment.plane.dzdu;
    plane.mutable_at(i, 2) = fragment.plane.dzdv;
    for (int channel = 0; channel < 3; ++channel)
      color.mutable_at(i, channel) = fragment.color[channel] / fragment.alpha;
    for (py::ssize_t bit = 0; bit < bits; ++bit)
      mask.mutable_at(i, bit) = fragment.mask.test(static_cast<std::size_t>(bit));
  }
  return py::make_tuple(py::make_tuple(frame, tile.x0, tile.y0, tile.width()), first, area, depth, plane, front, color,
                        mask);
}

// The colours that the rule returns: one row for each pixel of the bin, R, G and B times A, and A.
std::vector<PixelColor> colors_of(const FloatArray& merged) {
  std::vector<PixelColor> colors;
  const auto rgba = merged.unchecked<2>();
  for (py::ssize_t pixel = 0; pixel < rgba.shape(0); ++pixel)
    colors.push_back({rgba(pixel, 3), {rgba(pixel, 0), rgba(pixel, 1), rgba(pixel, 2)}});
  return colors;
}

constexpr std::uint32_t kStoredFragmentBytes = 64;  // with up to 256 positions: area, plane, colour, mask
constexpr std::uint32_t kMergedBytes = 8;           // of the framebuffer

FrameResult render_merged(const FrameJob& job, std::size_t frame, const Framebuffer& framebuffer, int positions,
                          const SharedFunction& rule) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionGrid grid(positions);
  BeamFragmentOptions options = grid_options(grid, kStoredFragmentBytes);
  options.clipped_depth = true;
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::shade, StageId::a_buffer,
                                StageId::compose, StageId::resolve},
                     .framebuffer = framebuffer,
                     .pair_bytes = kPairWorkingBytes + kSortBytes,
                     .order = "near to far, by the depth at the centroid"};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "pair_queue", PairDepths::none, ConservativeRasterUnit::Hidden::kept,
                                  kQueueItems);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ABufferUnit a_buffer(bin, kStoredFragmentBytes, kStoredFragmentBytes);
    std::vector<Fragment>& fragments = make_fragments.queued(raster());
    shade(fragments);
    const ABuffer& lists = a_buffer(sort_records(fragments, SortKey::centroid));
    const BinStage composition = bin.stage(StageId::compose);  // the rule; what it computes is not counted
    composition.counters.items_in += lists.records.size();
    a_buffer.charge_memory(record_counts(lists), composition);
    const std::vector<PixelColor> colors =
        rule([&] { return columns_of(fragments, lists, positions, frame, bin.tile); },
             [](const py::object& merged) { return colors_of(FloatArray(merged)); });
    bin.finish(resolve(colors, bin.background(), kMergedBytes, bin.stage(StageId::resolve).timed()));
  });
}

// rule(place, first, area, depth, plane, front, color, mask) is called for each bin (own.py explains the columns).
Technique merge_technique(const std::string& name, const SharedFunction& rule, int positions) {
  Technique technique;
  technique.spec = name;
  technique.framebuffer = {.surfaces = {{"color", "RGBA16F", kMergedBytes}}};
  technique.positions = positions;
  technique.renderer = [framebuffer = technique.framebuffer, positions, rule](
                           const Trace& trace, std::size_t frame, const FrameInput& run, const FrameSinks& sinks) {
    const FrameJob job{trace, trace.frames.at(frame), run, sinks};
    return on_threads(run.threads, [&] { return render_merged(job, frame, framebuffer, positions, rule); });
  };
  return technique;
}

std::vector<std::array<int, 2>> places_of_positions(int positions) {
  std::vector<std::array<int, 2>> places;
  for (const glm::ivec2& place : places_of(cell_positions(positions).patterns)) places.push_back({place.x, place.y});
  return places;
}

// It is never destroyed, because functions of Python cannot be once the interpreter has ended.
std::vector<TechniqueKind>& known_kinds() {
  static auto* const kinds = new std::vector<TechniqueKind>(built_in_kinds());
  return *kinds;
}

struct OwnKind {
  Technique technique;
  std::string description, source, code;
};

// Runs the program, to which these techniques belong while it runs.
int program(std::vector<std::string> words, const std::vector<std::string>& start, const std::vector<OwnKind>& own) {
  std::vector<TechniqueKind> kinds = built_in_kinds();
  for (const OwnKind& each : own) {
    const std::string& name = each.technique.spec;
    if (std::ranges::find(kinds, name, &TechniqueKind::name) != kinds.end())
      throw std::runtime_error("technique " + name + ": there is one of this name already");
    kinds.push_back({.name = each.technique.spec,
                     .description = each.description,
                     .source = each.source,
                     .examples = {each.technique.spec},
                     .code = each.code,
                     .make = make_plain([technique = each.technique] { return technique; })});
  }
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  const auto argc = static_cast<int>(argv.size());
  argv.push_back(nullptr);
  known_kinds().swap(kinds);
  const int code = [&] {
    const py::gil_scoped_release released;
    return run_program(argc, argv.data(), start);
  }();
  known_kinds().swap(kinds);
  return code;
}

}  // namespace

// The linker takes this one in place of the library's.
const std::vector<TechniqueKind>& technique_kinds() { return known_kinds(); }

void add_own_techniques(py::module_& module) {
  module.def("function_technique", [](const std::string& name, py::function function) {
    return function_technique(name, SharedFunction(std::move(function)));
  });
  module.def("merge_technique", [](const std::string& name, py::function rule, int positions) {
    return merge_technique(name, SharedFunction(std::move(rule)), positions);
  });
  module.def("places_of_positions", &places_of_positions);
  py::class_<OwnKind>(module, "OwnKind")
      .def(py::init([](const Technique& technique, const std::string& description, const std::string& source,
                       const std::string& code) {
        return OwnKind{technique, description, source, code};
      }));
  module.def("program", &program);
}

}  // namespace beampipe

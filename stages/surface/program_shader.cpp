#include "stages/surface/program_shader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <tuple>

#include "simd/sample_pattern.h"
#include "stages/surface/program_alpha.h"
#include "stages/surface/surface_formulas.h"
#include "stages/surface/surface_points.h"

namespace beampipe {
namespace {

constexpr std::size_t kGroup = 4;                    // lanes
constexpr std::uint32_t kStepsOfEndless = 1u << 12;  // of programs that are thought to have no end

// What is not a number is 0.
float limited(float value) { return value > 0.0f ? std::min(value, 1.0f) : 0.0f; }
float stored_float(float value) { return std::isnan(value) ? 0.0f : std::clamp(value, -kMostColor, kMostColor); }

// Weights at a point of the screen, in pixels.
Barycentrics<float> weights_of(const SetupSurface& surface, float x, float y) {
  return weights_at(surface.planes, x - surface.anchor_x, y - surface.anchor_y);
}

// A square in the grid of all that are shaded, and where the place is in it: 0..1.
struct SquarePlace {
  std::int32_t column, row;
  float u, v;
};

SquarePlace square_of(const ProgramPlace& place) {
  const float u = place.u / place.side, v = place.v / place.side;
  const float column = place.side == 1 ? 0 : std::floor(u), row = place.side == 1 ? 0 : std::floor(v);
  const auto in_grid = [&](std::int32_t pixel, float in_pixel) {
    return static_cast<std::int32_t>(std::lround(static_cast<float>(pixel) / place.side + in_pixel));
  };
  return {in_grid(place.x, column), in_grid(place.y, row), u - column, v - row};
}

std::size_t lane_in_quad(const SquarePlace& square) {
  return static_cast<std::size_t>((square.column & 1) + 2 * (square.row & 1));
}

}  // namespace

ProgramShader::ProgramShader(const SetupTriangles& triangles, const Trace& trace, const Frame& frame,
                             const ProgramSet* programs)
    : triangles_(triangles),
      trace_(trace),
      frame_(frame),
      programs_(programs),
      target_samples_(frame.capture.pictures.color ? frame.capture.pictures.samples : 32),
      draws_(frame.draws.size()) {
  std::vector<std::vector<std::uint32_t>> of_draw(frame.draws.size());
  for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i)
    if (triangles.surfaces[i].material == kProgramSurface) of_draw[triangles.draws[i]].push_back(i);
  for (std::uint32_t i = 0; i < draws_.size(); ++i) {
    if (of_draw[i].empty()) continue;
    draws_[i] = bind(frame.draws[i]);
    measure(i, of_draw[i]);
  }
}

ProgramShader::BoundDraw ProgramShader::bind(const Draw& draw) const {
  const ProgramUse& use = *draw.program;
  BoundDraw bound;
  bound.program = programs_->find(use.program);
  bound.number = use.program;
  bound.mesh = &trace_.meshes[draw.mesh];
  bound.mode = program_alpha_mode(trace_, draw, triangles_.order);
  bound.has_alpha = bound.mode == AlphaMode::blend || triangles_.order == DrawOrder::of_api;
  const glm::dmat4 to_clip = frame_.projection * frame_.view * draw.transform;
  bound.to_w = {to_clip[0][3], to_clip[1][3], to_clip[2][3], to_clip[3][3]};

  const ShaderProgram& program = trace_.programs[use.program];
  bound.stride = varyings_of(program);
  for (const InterfaceRow& row : bound.program->inputs) {
    using Kind = Input::Kind;
    Input input{.row = row.row, .number = row.component};
    if (row.location == kNoRow) {
      input.kind = row.built_in == spv::BuiltInFragCoord          ? Kind::frag_coord
                   : row.built_in == spv::BuiltInFrontFacing      ? Kind::front_facing
                   : row.built_in == spv::BuiltInHelperInvocation ? Kind::helper
                   : row.built_in == spv::BuiltInPrimitiveId      ? Kind::primitive
                   : row.built_in == spv::BuiltInPointCoord       ? Kind::half
                   : row.built_in == spv::BuiltInSampleMask       ? Kind::all_bits
                                                                  : Kind::zero;
    } else {
      std::uint32_t first = 0;
      for (const ProgramInput& each : program.inputs) {
        if (each.location == row.location && row.component >= each.component &&
            row.component < each.component + each.count) {
          input.kind = Kind::varying;
          input.number = first + row.component - each.component;
          input.interpolation = each.integer ? InputInterpolation::flat : each.interpolation;
        }
        first += each.count;
      }
    }
    bound.inputs.push_back(input);
  }
  bound.outputs.fill(kNoRow);
  for (const InterfaceRow& row : bound.program->outputs) {
    if (row.location == 0 && row.index == 0 && row.component < 4) bound.outputs[row.component] = row.row;
    // What has been tested early has its triangle's depth.
    if (row.built_in == spv::BuiltInFragDepth && !bound.program->tests_early) bound.depth_output = row.row;
    if (row.built_in == spv::BuiltInSampleMask && row.component == 0) bound.samples_output = row.row;
  }

  for (const BufferSlot& slot : bound.program->buffers) {
    std::span<const std::byte> bytes;
    if (slot.set == kNoRow) bytes = std::as_bytes(std::span(use.push_constants));
    for (const BoundBuffer& buffer : use.buffers)
      if (buffer.set == slot.set && buffer.binding == slot.binding && buffer.element == slot.element)
        bytes = std::as_bytes(std::span(buffer.bytes));
    bound.resources.buffers.push_back(bytes);
  }
  bound.images = bound_images(*bound.program, use.images, trace_.program_images, trace_.program_samplers);
  return bound;
}

void ProgramShader::set_inputs(const BoundDraw& draw, const ProgramPlace& place, std::span<const Lane> lanes,
                               std::uint64_t helpers, ShaderExecutor& executor) const {
  using Kind = Input::Kind;
  const SetupSurface& surface = triangles_.surfaces[place.triangle];
  const SetupTriangle& triangle = triangles_.triangles[place.triangle];
  const Mesh& mesh = *draw.mesh;
  const glm::uvec3& index = mesh.triangles[surface.trace_triangle];
  std::array<float, 3> w{};  // of the vertices, in clip space
  for (int k = 0; k < 3; ++k) {
    const glm::dvec4 position(glm::dvec3(mesh.positions[index[k]]), mesh.ws.empty() ? 1.0 : mesh.ws[index[k]]);
    w[static_cast<std::size_t>(k)] = static_cast<float>(glm::dot(draw.to_w, position));
  }
  const auto varying = [&](int vertex, std::uint32_t number) {
    return mesh.varyings[std::size_t{index[vertex]} * draw.stride + number];
  };
  const auto number_of = [&](int vertex, std::uint32_t number) {
    return std::bit_cast<float>(varying(vertex, number));
  };
  const Barycentrics<float> at_place =
      weights_of(surface, static_cast<float>(place.x) + place.u, static_cast<float>(place.y) + place.v);
  const Barycentrics<float> kept = place.stays_in_triangle ? limited_to_triangle(at_place) : at_place;
  for (const Lane& lane : lanes) {
    Barycentrics<float> smooth = weights_of(surface, lane.x, lane.y);
    smooth.second += kept.second - at_place.second, smooth.third += kept.third - at_place.third;
    // Weights that are linear in the picture are those with perspective times w.
    const float second = smooth.second * w[1], third = smooth.third * w[2],
                sum = (1.0f - smooth.second - smooth.third) * w[0] + second + third;
    const Barycentrics<float> linear{second / sum, third / sum};
    const auto frag_coord = [&](std::uint32_t component) {
      if (component == 0) return lane.x;
      if (component == 1) return lane.y;
      if (component == 3) return 1.0f / sum;
      double depth = triangle.depth.at(lane.x, lane.y), offset = -1, scale = 1;
      if (!triangles_.placements.empty()) {
        const DrawPlacement& placement = triangles_.placements[triangles_.draws[place.triangle]];
        offset = placement.window_offset, scale = placement.window_scale;
      }
      return static_cast<float>((depth - offset) / scale);
    };
    for (const Input& input : draw.inputs) {
      LaneRow& row = executor.row(input.row);
      const std::uint32_t n = input.number;
      switch (input.kind) {
        case Kind::varying:
          if (input.interpolation == InputInterpolation::flat) {
            row.bits[lane.number] = varying(0, n);
          } else {
            const bool is_linear = input.interpolation == InputInterpolation::linear;
            row.set(lane.number,
                    interpolated(number_of(0, n), number_of(1, n), number_of(2, n), is_linear ? linear : smooth));
          }
          break;
        case Kind::frag_coord:
          row.set(lane.number, frag_coord(n));
          break;
        case Kind::front_facing: {
          const DrawState& state = frame_.draws[triangles_.draws[place.triangle]].state;
          row.bits[lane.number] = triangle.front != state.front_is_clockwise ? ~0u : 0u;
          break;
        }
        case Kind::helper:
          row.bits[lane.number] = helpers >> lane.number & 1 ? ~0u : 0u;
          break;
        case Kind::primitive:
          row.bits[lane.number] = surface.trace_triangle;
          break;
        case Kind::half:
          row.set(lane.number, 0.5f);
          break;
        case Kind::all_bits:
          row.bits[lane.number] = ~0u;
          break;
        case Kind::zero:
          row.bits[lane.number] = 0;
          break;
      }
    }
  }
}

// Places at the centres of squares of one quad share a group, where each is the other's neighbour.
std::vector<ProgramShader::Group> ProgramShader::grouped(const LaneProgram& program,
                                                         std::span<const ProgramPlace> places) {
  std::vector<Group> groups;
  std::map<std::tuple<std::uint32_t, std::int32_t, std::int32_t>, std::size_t> quads;  // by triangle and quad
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const ProgramPlace& place = places[i];
    if (!program.takes_differences) {
      if (i % kGroup == 0) groups.emplace_back();
      groups.back().places[i % kGroup] = i;
      continue;
    }
    if (!place.in_quad) {
      groups.emplace_back().places[0] = i;
      continue;
    }
    const SquarePlace square = square_of(place);
    const std::size_t lane = lane_in_quad(square);
    if (square.u != 0.5f || square.v != 0.5f) {
      groups.emplace_back().places[lane] = i;
      continue;
    }
    const auto [quad, is_new] = quads.try_emplace({place.triangle, square.column >> 1, square.row >> 1}, groups.size());
    if (is_new) groups.emplace_back();
    std::uint32_t& there = groups[quad->second].places[lane];
    if (there == Group::kNone) {
      there = i;
    } else {  // the same place again
      groups.emplace_back().places[lane] = i;
    }
  }
  return groups;
}

void ProgramShader::run(const BoundDraw& draw, std::span<const ProgramPlace> places, std::span<const Group> groups,
                        const Answers& answers, ShaderCounts& counts) const {
  const bool has_helpers = draw.program->takes_differences;
  programs_->with_executor(draw.number, [&](ShaderExecutor& executor) {
    std::uint64_t active = 0, helpers = 0;
    std::array<std::uint32_t, kShaderLanes> place_of;
    place_of.fill(Group::kNone);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Group& group = groups[g];
      std::array<Lane, kGroup> lanes;
      std::size_t count = 0;
      const ProgramPlace* last = nullptr;
      const auto add = [&](std::size_t lane, float x, float y, bool helps) {
        const std::size_t number = g * kGroup + lane;
        lanes[count++] = {number, x, y};
        active |= std::uint64_t{1} << number;
        if (helps) helpers |= std::uint64_t{1} << number;
      };
      for (std::size_t lane = 0; lane < kGroup; ++lane) {
        if (group.places[lane] == Group::kNone) continue;
        const ProgramPlace& place = places[group.places[lane]];
        place_of[g * kGroup + lane] = group.places[lane];
        last = &place;
        const float x = static_cast<float>(place.x) + place.u, y = static_cast<float>(place.y) + place.v;
        add(lane, x, y, false);
        if (!has_helpers) {  // each place has a triangle of its own
          set_inputs(draw, place, std::span(lanes).subspan(count - 1, 1), helpers, executor);
        } else if (!place.in_quad) {
          add(1, x + place.side, y, true), add(2, x, y + place.side, true);
        }
      }
      if (!has_helpers) continue;
      for (std::size_t lane = 0; last->in_quad && lane < kGroup; ++lane) {
        if (group.places[lane] != Group::kNone) continue;  // texture units look at the whole quad
        const SquarePlace square = square_of(*last);
        const auto middle = [&](std::int32_t number, std::size_t bit) {
          return (static_cast<float>((number & ~1) + static_cast<std::int32_t>(lane >> bit & 1)) + 0.5f) * last->side;
        };
        add(lane, middle(square.column, 0), middle(square.row, 1), true);
      }
      set_inputs(draw, *last, std::span(lanes).first(count), helpers, executor);
    }
    ProgramImages images(*draw.program, draw.images, active & ~helpers, answers.texels);
    ShaderResources resources = draw.resources;
    resources.images = &images;
    executor.run(resources, groups.size() * kGroup, active, helpers, counts, draw.most_steps);
    const std::uint64_t kept = executor.kept();
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
      if (place_of[lane] == Group::kNone) continue;
      const auto channel = [&](std::size_t c, float otherwise) {
        if (draw.outputs[c] == kNoRow) return otherwise;
        const float value = executor.row(draw.outputs[c]).number(lane);
        const bool is_opacity = c == 3 && triangles_.order == DrawOrder::by_depth;
        return frame_.target == ColorTarget::floats && !is_opacity ? stored_float(value) : limited(value);
      };
      const bool is_there = kept >> lane & 1;
      const float alpha = draw.has_alpha ? std::max(channel(3, 1.0f), 0.0f) : 1.0f;
      answers.colors[place_of[lane]] = {channel(0, 0.0f), channel(1, 0.0f), channel(2, 0.0f),
                                        is_there ? alpha : kDiscarded};
      if (!answers.verdicts) continue;
      FragmentVerdict& verdict = answers.verdicts[place_of[lane]];
      if (draw.depth_output != kNoRow) verdict.depth = limited(executor.row(draw.depth_output).number(lane)) - 1;
      if (draw.samples_output != kNoRow)
        verdict.samples = FragmentVerdict::repeated(executor.row(draw.samples_output).bits[lane], target_samples_);
    }
  });
}

void ProgramShader::shade_all(const BoundDraw& draw, std::span<const ProgramPlace> places,
                              const Answers& answers) const {
  const std::vector<Group> groups = grouped(*draw.program, places);
  constexpr std::size_t kMost = kShaderLanes / kGroup;
  ShaderCounts counts;  // what is charged comes from measure()
  for (std::size_t first = 0; first < groups.size(); first += kMost)
    run(draw, places, std::span(groups).subspan(first, std::min(kMost, groups.size() - first)), answers, counts);
  if (counts.stopped > 0) *draw.stopped += counts.stopped;
}

void ProgramShader::shade(std::span<const ProgramPlace> places, glm::vec4* colors, TexelRequests* texels,
                          FragmentVerdict* verdicts) const {
  if (places.empty()) return;
  const BoundDraw& draw = draws_[triangles_.draws[places[0].triangle]];
  shade_all(draw, places, {colors, texels, verdicts});
  if (draw.mode != AlphaMode::mask) return;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i].is_there || colors[i].a != kDiscarded) continue;
    std::array<ProgramPlace, 4> around;
    std::array<glm::vec4, 4> found;
    std::array<FragmentVerdict, 4> found_verdicts;
    for (std::size_t k = 0; k < around.size(); ++k) {
      around[k] = places[i];
      around[k].u = std::clamp(places[i].u + (k % 2 == 0 ? -0.25f : 0.25f), 0.0f, 1.0f);
      around[k].v = std::clamp(places[i].v + (k < 2 ? -0.25f : 0.25f), 0.0f, 1.0f);
    }
    shade_all(draw, around, {found.data(), nullptr, found_verdicts.data()});
    const auto kept = std::ranges::find_if(found, [](const glm::vec4& color) { return color.a != kDiscarded; });
    if (kept == found.end()) continue;
    colors[i] = *kept;
    if (verdicts) verdicts[i] = found_verdicts[static_cast<std::size_t>(kept - found.begin())];
  }
}

void ProgramShader::measure(std::uint32_t draw, std::span<const std::uint32_t> triangles) {
  constexpr std::size_t kMost = 16;
  std::vector<ProgramPlace> places;
  const std::size_t count = std::min(kMost, triangles.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t number = triangles[i * triangles.size() / count];
    const SetupTriangle& triangle = triangles_.triangles[number];
    const auto mean = [](const std::int32_t(&at)[3]) {
      return (static_cast<float>(at[0]) + static_cast<float>(at[1]) + static_cast<float>(at[2])) /
             (3.0f * kSubpixelUnits);
    };
    const float x = mean(triangle.x), y = mean(triangle.y);
    places.push_back({.triangle = number,
                      .x = static_cast<std::int32_t>(std::floor(x)),
                      .y = static_cast<std::int32_t>(std::floor(y)),
                      .u = x - std::floor(x),
                      .v = y - std::floor(y)});
  }
  BoundDraw& bound = draws_[draw];
  std::array<glm::vec4, kMost> colors;
  ShaderCounts counts;
  run(bound, places, grouped(*bound.program, places), {colors.data()}, counts);
  const auto mean = [&](std::uint64_t sum) { return (sum + counts.invocations / 2) / counts.invocations; };
  if (counts.stopped > 0) bound.most_steps = kStepsOfEndless;
  Cost& cost = bound.cost;
  cost.ops = {mean(counts.ops.mul_add), mean(counts.ops.add),     mean(counts.ops.bit), mean(counts.ops.fetch),
              mean(counts.ops.special), mean(counts.ops.convert), mean(counts.ops.wide)};
  cost.ops.fetch += mean(counts.texture_requests);
  cost.helpers = bound.program->takes_differences ? 2 : 0;
  cost.input_bytes = kSurfaceBytes + 3 * bound.stride * sizeof(float);
}

const SetupTriangles& without_refused(SetupTriangles& triangles, const Frame& frame, const ProgramSet& programs) {
  constexpr float kGrey = 0.5f;
  for (std::size_t i = 0; i < triangles.surfaces.size(); ++i) {
    SetupSurface& surface = triangles.surfaces[i];
    if (surface.material != kProgramSurface || programs.find(frame.draws[triangles.draws[i]].program->program))
      continue;
    surface.material = kFlatSurface, surface.is_opaque = true;
    triangles.attributes[i] = {.kd = glm::vec3(kGrey), .normal = glm::vec3(0.0f), .lit = false};
  }
  return triangles;
}

}  // namespace beampipe

#include "tests/lavapipe/executor_run.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "stages/spirv/fragment_shader.h"
#include "stages/spirv/shader_executor.h"
#include "stages/surface/program_images.h"

namespace beampipe {
namespace {

// What the vertices say at a pixel.
std::uint32_t bits_at(const ShaderCase& shader, const CaseInput& input, std::size_t pixel, std::uint32_t component) {
  if (!shader.is_triangle) return input.vertices[pixel][component];
  if (input.is_integer || input.is_flat) return input.vertices[0][component];
  const auto number = [&](std::size_t vertex) { return std::bit_cast<float>(input.vertices[vertex][component]); };
  const auto share = [](std::size_t place) { return (static_cast<float>(place) + 0.5f) / (2.0f * kSide); };
  return std::bit_cast<std::uint32_t>(number(0) + share(pixel % kSide) * (number(1) - number(0)) +
                                      share(pixel / kSide) * (number(2) - number(0)));
}

// A lane per pixel, in quads; a point alone fills its pixel's quad.
struct Lane {
  std::size_t pixel = 0;  // whose inputs it has
  float x = 0, y = 0;
  bool is_helper = false;
};

std::vector<Lane> lanes_of(const ShaderCase& shader) {
  std::vector<Lane> lanes;
  const auto middle = [](std::size_t place) { return static_cast<float>(place) + 0.5f; };
  const std::size_t step = shader.is_triangle ? 2 : 1;
  for (std::size_t y = 0; y < kSide; y += step)
    for (std::size_t x = 0; x < kSide; x += step)
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t quad_x = (x & ~std::size_t{1}) + k % 2, quad_y = (y & ~std::size_t{1}) + k / 2;
        const bool is_own = quad_x == x && quad_y == y;
        lanes.push_back({shader.is_triangle ? quad_y * kSide + quad_x : y * kSide + x, middle(quad_x), middle(quad_y),
                         !shader.is_triangle && !is_own});
      }
  return lanes;
}

std::uint32_t built_in(spv::BuiltIn meaning, std::uint32_t component, const Lane& lane) {
  const float coordinates[] = {lane.x, lane.y, kDepth, 1};
  switch (meaning) {
    case spv::BuiltInFragCoord:
      return std::bit_cast<std::uint32_t>(coordinates[component]);
    case spv::BuiltInPointCoord:
      return std::bit_cast<std::uint32_t>(0.5f);
    case spv::BuiltInFrontFacing:
      return ~0u;
    default:
      return 0;
  }
}

}  // namespace

std::set<std::uint32_t> written_locations(const LaneProgram& program, bool floats) {
  std::set<std::uint32_t> locations;
  for (const InterfaceRow& output : program.outputs)
    if (output.location != kNoRow && output.is_float == floats) locations.insert(output.location);
  return locations;
}

CaseOutputs run_executor(const ShaderCase& shader, const LaneProgram& program) {
  CaseOutputs outputs{.locations = {}, .is_kept = std::vector<bool>(kPixels)};
  for (const bool floats : {true, false})
    for (const std::uint32_t location : written_locations(program, floats))
      outputs.locations[location] = {.is_integer = !floats, .pixels = std::vector<FourBits>(kPixels)};

  const BoundImages bound = bound_images(program, shader.use.images, shader.images, shader.samplers);
  ProgramImages images(program, bound);
  ShaderResources resources;
  for (const BufferSlot& slot : program.buffers) {
    std::span<const std::byte>& bytes = resources.buffers.emplace_back();
    if (slot.set == kNoRow) bytes = std::as_bytes(std::span(shader.use.push_constants));
    for (const BoundBuffer& buffer : shader.use.buffers)
      if (buffer.set == slot.set && buffer.binding == slot.binding && buffer.element == slot.element)
        bytes = std::as_bytes(std::span(buffer.bytes));
  }
  resources.images = &images;

  ShaderExecutor executor(program);
  ShaderCounts counts;
  const std::vector<Lane> lanes = lanes_of(shader);
  for (std::size_t first = 0; first < lanes.size(); first += kShaderLanes) {
    const std::size_t count = std::min(kShaderLanes, lanes.size() - first);
    std::uint64_t helpers = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Lane& lane = lanes[first + i];
      helpers |= std::uint64_t{lane.is_helper} << i;
      for (const InterfaceRow& row : program.inputs) {
        const auto input = shader.inputs.find(row.location);
        executor.row(row.row).bits[i] = row.location == kNoRow ? built_in(row.built_in, row.component, lane)
                                        : input == shader.inputs.end()
                                            ? 0
                                            : bits_at(shader, input->second, lane.pixel, row.component);
      }
    }
    executor.run(resources, count, ~std::uint64_t{0}, helpers, counts);
    for (std::size_t i = 0; i < count; ++i) {
      if ((executor.kept() >> i & 1) == 0) continue;
      const std::size_t pixel = lanes[first + i].pixel;
      outputs.is_kept[pixel] = true;
      for (const InterfaceRow& row : program.outputs)
        if (row.location != kNoRow)
          outputs.locations[row.location].pixels[pixel][row.component] = executor.row(row.row).bits[i];
    }
  }
  return outputs;
}

void Agreement::operator+=(const Agreement& more) {
  if (example.empty()) example = more.example;
  outputs += more.outputs, near += more.near, roughly += more.roughly;
  worst = std::max(worst, more.worst);
}

Agreement compare(const LaneProgram& program, const CaseOutputs& driver, const CaseOutputs& executor,
                  double tolerance) {
  Agreement found;
  for (const InterfaceRow& row : program.outputs) {
    if (row.location == kNoRow) continue;
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
      if (!driver.is_kept[pixel] && !executor.is_kept[pixel]) continue;
      const std::uint32_t theirs = driver.locations.at(row.location).pixels[pixel][row.component],
                          ours = executor.locations.at(row.location).pixels[pixel][row.component];
      const double a = std::bit_cast<float>(theirs), b = std::bit_cast<float>(ours);
      bool is_near = theirs == ours, is_roughly = is_near;
      if (row.is_float && std::isfinite(a) && std::isfinite(b)) {
        const double error = std::abs(a - b) / std::max(1.0, std::abs(a));
        found.worst = std::max(found.worst, error);
        is_near = error <= tolerance, is_roughly = error <= 100 * tolerance;
      } else if (row.is_float) {
        is_near = is_roughly = a == b || (std::isnan(a) && std::isnan(b));
      }
      const bool is_same_pixel = driver.is_kept[pixel] == executor.is_kept[pixel];
      is_near &= is_same_pixel;
      ++found.outputs;
      found.near += is_near, found.roughly += is_roughly && is_same_pixel;
      if (is_near || !found.example.empty()) continue;
      const auto text = [&](const CaseOutputs& outputs, std::uint32_t bits) {
        if (!outputs.is_kept[pixel]) return std::string("discarded");
        char number[64];
        std::snprintf(number, sizeof number, "%.9g (0x%08x)", static_cast<double>(std::bit_cast<float>(bits)), bits);
        return std::string(number);
      };
      found.example = "pixel " + std::to_string(pixel) + ", location " + std::to_string(row.location) + "." +
                      std::to_string(row.component) + ": driver " + text(driver, theirs) + ", executor " +
                      text(executor, ours);
    }
  }
  return found;
}

Agreement agreement_of(Driver& driver, const ShaderCase& shader, double tolerance) {
  const LaneProgram program = load_fragment_shader(shader.words, shader.constants());
  const CaseOutputs theirs = driver.run(shader, written_locations(program, true), written_locations(program, false));
  return compare(program, theirs, run_executor(shader, program), tolerance);
}

}  // namespace beampipe

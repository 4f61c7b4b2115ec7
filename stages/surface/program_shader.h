// Runs the fragment shaders of draws with a program, with what each draw binds.
//
// Inputs come from Mesh::varyings, of planes through the vertices as they were before they were snapped, as Mesa's
// software driver has them: snapped ones are up to 1/512 px beside their place, which in a triangle of a pixel is much.
//
// Derivatives are differences between squares: those of a 2x2 quad, or a place and those one square to the right and
// below, from the planes. These two are helper invocations, which cost as much as others. A square is a pixel, whatever
// part of it a colour stands for. Only where cells of a pixel are shaded, by the reference and by multisampling above
// 16 samples, it is a cell: as in a picture of that resolution.
//
// Built-in inputs: FragCoord, FrontFacing, HelperInvocation and PrimitiveId; PointCoord is the middle of the point,
// SampleMask has all bits, and all others are 0. Of the outputs, the colour at location 0 is used, limited to 0..1
// unless the target stores floats, and to alphas of 0 and more; and FragDepth and SampleMask.
//
// Invocations that take more than ShaderExecutor::kMostSteps are stopped and count as discarded. Where some of those
// that cost() looks at are, the program is thought to have no end, and all of the draw are stopped much earlier.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/surface/fragment_verdict.h"
#include "stages/surface/program_images.h"
#include "stages/surface/program_set.h"
#include "traces/trace.h"

namespace beampipe {

// Where a program runs.
struct ProgramPlace {
  std::uint32_t triangle = 0;
  std::int32_t x = 0, y = 0;       // the pixel
  float u = 0.5f, v = 0.5f;        // in it
  float side = 1;                  // of the squares that are shaded, in pixels: 1, or 1/2, 1/4, ...
  bool in_quad = false;            // derivatives are those of a quad of such squares
  bool stays_in_triangle = false;  // inputs are those of the nearest point of the triangle, about
  bool is_there = false;           // who asks knows that the surface is there, or near it in the pixel
  bool operator==(const ProgramPlace&) const = default;
};

class ProgramShader {
 public:
  static constexpr float kDiscarded = -1;  // in place of alpha

  // All must outlive it. `programs`: of the trace; may be null if no draw has one.
  ProgramShader(const SetupTriangles& triangles, const Trace& trace, const Frame& frame, const ProgramSet* programs);

  AlphaMode alpha_mode(std::uint32_t draw) const { return draws_[draw].mode; }

  // Sets the colour of each place. Alpha is that of the shader in the API's order and where the draw is blended, and
  // else 1; it is kDiscarded where the shader discards. A place that is_there then has the colour of one that is not
  // discarded, a quarter of a pixel away, if there is one. The places lie in triangles of one draw. Adds the texels
  // that their invocations read, without helpers, to `texels`, whose open request ends. `verdicts`: null, or one for
  // each place, of which the depth and the sample mask are set.
  void shade(std::span<const ProgramPlace> places, glm::vec4* colors, TexelRequests* texels = nullptr,
             FragmentVerdict* verdicts = nullptr) const;

  // Does it say of fragments where they are, in depth or in samples? Are they tested before it runs?
  bool has_verdicts(std::uint32_t draw) const {
    return draws_[draw].depth_output != kNoRow || draws_[draw].samples_output != kNoRow;
  }
  bool tests_early(std::uint32_t draw) const { return draws_[draw].program->tests_early; }

  // What an invocation costs, helpers of its own left out: the mean over places in up to 16 of the draw's triangles,
  // which is exact where control flow is the same everywhere. `helpers`: how many it needs.
  struct Cost {
    OperationCounts ops{};
    std::uint32_t helpers = 0;
    std::uint64_t input_bytes = 0;  // of the vertices
  };
  const Cost& cost(std::uint32_t draw) const { return draws_[draw].cost; }

  bool reads_images(std::uint32_t draw) const { return !draws_[draw].program->images.empty(); }

  // How many invocations of shade() have been stopped, helpers included.
  std::uint64_t stopped(std::uint32_t draw) const { return *draws_[draw].stopped; }

 private:
  struct Input {
    enum class Kind { varying, frag_coord, front_facing, helper, primitive, half, all_bits, zero };
    std::uint32_t row = 0;
    Kind kind = Kind::zero;
    std::uint32_t number = 0;  // of the varying in its vertex, or the component
    InputInterpolation interpolation = InputInterpolation::smooth;
  };
  struct BoundDraw {
    const LaneProgram* program = nullptr;
    std::uint32_t number = 0;  // of the program
    const Mesh* mesh = nullptr;
    AlphaMode mode = AlphaMode::opaque;
    bool has_alpha = false;
    std::size_t stride = 0;  // varyings of a vertex
    std::vector<Input> inputs;
    std::array<std::uint32_t, 4> outputs{};
    std::uint32_t depth_output = kNoRow, samples_output = kNoRow;
    ShaderResources resources{};
    BoundImages images{};
    glm::dvec4 to_w{};  // clip w of a position
    Cost cost{};
    std::uint32_t most_steps = ShaderExecutor::kMostSteps;
    std::unique_ptr<std::atomic<std::uint64_t>> stopped = std::make_unique<std::atomic<std::uint64_t>>(0);
  };
  struct Lane {
    std::size_t number;
    float x, y;  // pixels
  };
  // Lanes in which differences are taken, and the numbers of the places that they stand for.
  struct Group {
    static constexpr std::uint32_t kNone = ~0u;
    std::array<std::uint32_t, 4> places{kNone, kNone, kNone, kNone};
  };

  // As of shade().
  struct Answers {
    glm::vec4* colors;
    TexelRequests* texels = nullptr;
    FragmentVerdict* verdicts = nullptr;
  };

  BoundDraw bind(const Draw& draw) const;
  static std::vector<Group> grouped(const LaneProgram& program, std::span<const ProgramPlace> places);
  void set_inputs(const BoundDraw& draw, const ProgramPlace& place, std::span<const Lane> lanes, std::uint64_t helpers,
                  ShaderExecutor& executor) const;
  void shade_all(const BoundDraw& draw, std::span<const ProgramPlace> places, const Answers& answers) const;
  void run(const BoundDraw& draw, std::span<const ProgramPlace> places, std::span<const Group> groups,
           const Answers& answers, ShaderCounts& counts) const;
  void measure(std::uint32_t draw, std::span<const std::uint32_t> triangles);

  const SetupTriangles& triangles_;
  const Trace& trace_;
  const Frame& frame_;
  const ProgramSet* programs_;
  std::uint32_t target_samples_;  // that sample masks have bits for
  std::vector<BoundDraw> draws_;
};

// Triangles of draws whose program cannot run become flat, in a middle grey.
const SetupTriangles& without_refused(SetupTriangles& triangles, const Frame& frame, const ProgramSet& programs);

}  // namespace beampipe

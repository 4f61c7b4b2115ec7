// A program while it is made: rows are numbered as they come, and each value has one of its own.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "stages/spirv/lane_program.h"

namespace beampipe {

struct DraftRow {
  // fixed: see lane_program.h. memory: outputs and local variables. value: written once, unless it is a phi's.
  enum class Kind : std::uint8_t { fixed, constant, input, memory, value };
  Kind kind = Kind::value;
  std::uint32_t bits = 0;  // of a constant
};

struct DraftEdge {
  std::uint32_t target = 0, literal = 0;                          // as in LaneEdge
  std::vector<std::pair<std::uint32_t, std::uint32_t>> copies{};  // all at once: to a row, from a row
};

struct DraftBlock {
  std::vector<LaneOp> ops;
  BlockEnd end = BlockEnd::done;
  std::uint32_t condition = kNoRow;
  std::vector<DraftEdge> edges;
};

struct Draft {
  std::vector<DraftRow> rows{{DraftRow::Kind::fixed}, {DraftRow::Kind::fixed}};
  std::vector<DraftBlock> blocks;
  std::vector<ImageOp> image_ops;
  LaneProgram program;  // all but what the members above become

  std::uint32_t add_row(DraftRow::Kind kind, std::uint32_t bits = 0) {
    rows.push_back({kind, bits});
    return static_cast<std::uint32_t>(rows.size() - 1);
  }
};

}  // namespace beampipe

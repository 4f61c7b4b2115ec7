// block_order: basic blocks with their successors -> the order in which lanes that diverge take them
//
// Lanes wait for each other where their ways meet if the least block, in this order, always runs first: a construct's
// blocks come before its merge block, and a loop's before its continue target and that before its merge block.
#pragma once

#include <cstdint>
#include <vector>

namespace beampipe {

// Where control goes from a block, as numbers of blocks. `structure`: its merge block and, of a loop, its continue
// target, in this order; empty: the block is no header.
struct BlockEdges {
  std::vector<std::uint32_t> structure, successors;
};

// The blocks that can be reached from block 0, which comes first.
std::vector<std::uint32_t> block_order(const std::vector<BlockEdges>& blocks);

}  // namespace beampipe

#include "stages/spirv/block_order.h"

#include <algorithm>

namespace beampipe {

std::vector<std::uint32_t> block_order(const std::vector<BlockEdges>& blocks) {
  // Reverse postorder, where the merge block is visited first and so ends up last.
  struct Visit {
    std::uint32_t block;
    std::vector<std::uint32_t> next;  // the last one is visited first
  };
  const auto visit_of = [&](std::uint32_t block) {
    Visit visit{block, {blocks[block].successors.begin(), blocks[block].successors.end()}};
    visit.next.insert(visit.next.end(), blocks[block].structure.rbegin(), blocks[block].structure.rend());
    return visit;
  };
  std::vector<std::uint32_t> order;
  std::vector<bool> is_seen(blocks.size());
  std::vector<Visit> path{visit_of(0)};
  is_seen[0] = true;
  while (!path.empty()) {
    Visit& visit = path.back();
    if (visit.next.empty()) {
      order.push_back(visit.block);
      path.pop_back();
      continue;
    }
    const std::uint32_t next = visit.next.back();
    visit.next.pop_back();
    if (is_seen[next]) continue;
    is_seen[next] = true;
    path.push_back(visit_of(next));
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace beampipe

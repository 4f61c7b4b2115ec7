#include "stages/spirv/assign_rows.h"

#include <algorithm>
#include <queue>
#include <unordered_set>
#include <utility>

namespace beampipe {
namespace {

using Kind = DraftRow::Kind;
using Row = std::uint32_t;

// Calls visit(row) with each row that the operation reads.
template <class Visit>
void for_each_operand(Draft& draft, LaneOp& op, Visit&& visit) {
  const int rows = info_of(op.code).rows;
  if (rows > 0 && op.a != kNoRow) visit(op.a);
  if (rows > 1 && op.b != kNoRow) visit(op.b);
  if (rows > 2 && op.c != kNoRow) visit(op.c);
  if (op.code == LaneCode::image) draft.image_ops[op.c].for_each_operand(visit);
}

// Calls visit(row) with each row that the operation writes.
template <class Visit>
void for_each_result(Draft& draft, LaneOp& op, Visit&& visit) {
  if (op.result != kNoRow) visit(op.result);
  if (op.code != LaneCode::image) return;
  for (Row& row : draft.image_ops[op.c].results)
    if (row != kNoRow) visit(row);
}

// Which rows others are made from.
class Dependence {
 public:
  explicit Dependence(Draft& draft) : draft_(draft), makers_(draft.rows.size()), is_wanted_(draft.rows.size()) {
    for (DraftBlock& block : draft.blocks) {
      for (LaneOp& op : block.ops) {
        if (op.code == LaneCode::store_local) writes_memory_.push_back(&op);
        for_each_result(draft, op, [&](Row row) {
          if (draft.rows[row].kind == Kind::value)
            makers_[row].op = &op;
          else
            writes_memory_.push_back(&op);
        });
      }
      for (DraftEdge& edge : block.edges)
        for (const auto& [to, from] : edge.copies) makers_[to].copied.push_back(from);
    }
  }

  void want(Row row) {
    if (is_wanted_[row]) return;
    is_wanted_[row] = true;
    wanted_.push_back(row);
  }
  void want_operands(LaneOp& op) {
    for_each_operand(draft_, op, [this](Row row) { want(row); });
  }

  // Wants all that wanted rows are made from, too. Memory is made from all that is written there.
  void follow() {
    while (!wanted_.empty()) {
      const Row row = wanted_.back();
      wanted_.pop_back();
      LaneOp* const maker = makers_[row].op;
      if (maker) want_operands(*maker);
      for (const Row from : makers_[row].copied) want(from);
      if (draft_.rows[row].kind == Kind::memory || (maker && maker->code == LaneCode::load_local))
        for (LaneOp* const write : std::exchange(writes_memory_, {})) want_operands(*write);
    }
  }

  bool is_wanted(Row row) const { return is_wanted_[row]; }

 private:
  // What writes a value: an operation, or edges.
  struct Maker {
    LaneOp* op = nullptr;
    std::vector<Row> copied;
  };
  Draft& draft_;
  std::vector<Maker> makers_;
  std::vector<LaneOp*> writes_memory_;
  std::vector<Row> wanted_;
  std::vector<bool> is_wanted_;
};

// Leaves out what has no effect, and results of images that nobody reads.
void remove_dead(Draft& draft) {
  Dependence uses(draft);
  for (DraftBlock& block : draft.blocks) {
    for (LaneOp& op : block.ops) {
      bool has_effect = op.code == LaneCode::store_local || op.code == LaneCode::discard;
      for_each_result(draft, op, [&](Row row) { has_effect |= draft.rows[row].kind != Kind::value; });
      if (has_effect) uses.want_operands(op);
    }
    if (block.condition != kNoRow) uses.want(block.condition);
  }
  uses.follow();
  for (DraftBlock& block : draft.blocks) {
    std::erase_if(block.ops, [&](LaneOp& op) {
      if (op.code == LaneCode::store_local || op.code == LaneCode::discard) return false;
      bool is_used = false;
      for_each_result(draft, op, [&](Row& row) {
        if (uses.is_wanted(row) || draft.rows[row].kind != Kind::value)
          is_used = true;
        else if (op.code == LaneCode::image)
          row = kNoRow;
      });
      return !is_used;
    });
    for (DraftEdge& edge : block.edges)
      std::erase_if(edge.copies, [&](const auto& copy) { return !uses.is_wanted(copy.first); });
  }
}

bool takes_difference(LaneCode code) {
  return code == LaneCode::dx || code == LaneCode::dy || code == LaneCode::dx_coarse || code == LaneCode::dy_coarse;
}

// Helpers read images only if differences, or the ways that lanes take, are made from what they read. Most do not, and
// images are what takes most of the time.
void find_reads_of_helpers(Draft& draft) {
  Dependence uses(draft);
  for (DraftBlock& block : draft.blocks) {
    for (LaneOp& op : block.ops)
      if (takes_difference(op.code)) uses.want_operands(op);
    if (block.condition != kNoRow) uses.want(block.condition);
  }
  uses.follow();
  for (ImageOp& op : draft.image_ops)
    op.is_for_helpers = std::ranges::any_of(op.results, [&](Row row) { return row != kNoRow && uses.is_wanted(row); });
}

// Copies of an edge happen one after the other. Where one writes what another reads later, all pass through rows of
// their own. Returns the first of these.
Row order_copies(Draft& draft) {
  const auto first = static_cast<Row>(draft.rows.size());
  for (DraftBlock& block : draft.blocks)
    for (DraftEdge& edge : block.edges) {
      std::unordered_set<Row> written;
      bool clash = false;
      for (const auto& [to, from] : edge.copies) {
        clash |= written.contains(from);
        written.insert(to);
      }
      if (!clash) continue;
      std::vector<std::pair<Row, Row>> through;
      for (auto& [to, from] : edge.copies) {
        const Row own = draft.add_row(Kind::value);
        through.emplace_back(own, from);
        from = own;
      }
      edge.copies.insert(edge.copies.begin(), through.begin(), through.end());
    }
  return first;
}

// Blocks that lanes may run again, as places in their order, both included.
struct Loop {
  std::uint32_t first, last;
  bool contains(std::uint32_t block) const { return first <= block && block <= last; }
};
std::vector<Loop> loops_of(const Draft& draft) {
  std::vector<Loop> loops;
  for (std::uint32_t i = 0; i < draft.blocks.size(); ++i)
    for (const DraftEdge& edge : draft.blocks[i].edges) {
      if (edge.target > i) continue;
      const auto same = std::find_if(loops.begin(), loops.end(), [&](const Loop& l) { return l.first == edge.target; });
      if (same == loops.end())
        loops.push_back({edge.target, i});
      else
        same->last = std::max(same->last, i);
    }
  return loops;
}

// From where to where a value is kept, in operations; and in which blocks it is written and read.
struct Life {
  std::uint32_t begin = ~0u, end = 0;
  std::uint32_t first_written = ~0u, last_written = 0, first_read = ~0u, last_read = 0;  // blocks
  bool outlives_loop = false;
  bool is_used() const { return begin != ~0u; }
};

class Lives {
 public:
  // `first_own`: as order_copies() returns it.
  Lives(Draft& draft, Row first_own) : lives_(draft.rows.size()) {
    std::uint32_t place = 0;
    std::vector<std::uint32_t> first_places, last_places;
    for (const DraftBlock& block : draft.blocks) {
      first_places.push_back(place);
      place += static_cast<std::uint32_t>(block.ops.size()) + 1;
      last_places.push_back(place++);
    }
    const auto is_value = [&](Row row) { return draft.rows[row].kind == Kind::value; };
    const auto write = [&](Row row, std::uint32_t at, std::uint32_t block) {
      if (!is_value(row)) return;
      Life& life = lives_[row];
      life.begin = std::min(life.begin, at), life.end = std::max(life.end, at);
      life.first_written = std::min(life.first_written, block), life.last_written = std::max(life.last_written, block);
    };
    const auto read = [&](Row row, std::uint32_t at, std::uint32_t block) {
      if (!is_value(row)) return;
      Life& life = lives_[row];
      life.begin = std::min(life.begin, at), life.end = std::max(life.end, at);
      life.first_read = std::min(life.first_read, block), life.last_read = std::max(life.last_read, block);
    };
    for (std::uint32_t i = 0; i < draft.blocks.size(); ++i) {
      DraftBlock& block = draft.blocks[i];
      std::uint32_t at = first_places[i];
      for (LaneOp& op : block.ops) {
        ++at;
        for_each_operand(draft, op, [&](Row row) { read(row, at, i); });
        for_each_result(draft, op, [&](Row row) { write(row, at, i); });
      }
      if (block.condition != kNoRow) read(block.condition, last_places[i], i);
      for (DraftEdge& edge : block.edges)
        for (const auto& [to, from] : edge.copies) {
          read(from, last_places[i], i);
          write(to, last_places[i], i);
          if (to < first_own) read(to, first_places[edge.target], edge.target);  // other lanes may come later
        }
    }
    for (const Loop& loop : loops_of(draft))
      for (Life& life : lives_) {
        if (!life.is_used() || life.first_read == ~0u) continue;
        const bool is_written_inside = loop.first <= life.last_written && life.first_written <= loop.last;
        const bool is_read_inside = loop.first <= life.last_read && life.first_read <= loop.last;
        const bool is_written_outside = !loop.contains(life.first_written) || !loop.contains(life.last_written);
        const bool is_read_outside = !loop.contains(life.first_read) || !loop.contains(life.last_read);
        if (is_written_outside && is_read_inside) extend(life, first_places[loop.first], last_places[loop.last]);
        if (is_written_inside && is_read_outside) {
          life.outlives_loop = true;
          extend(life, first_places[loop.first], last_places[loop.last]);
        }
      }
  }
  const Life& operator[](Row row) const { return lives_[row]; }

 private:
  static void extend(Life& life, std::uint32_t first, std::uint32_t last) {
    life.begin = std::min(life.begin, first), life.end = std::max(life.end, last);
  }
  std::vector<Life> lives_;
};

// How many values are alive at once. A result may take the place of an operand that is read there last.
std::uint32_t most_alive(const Lives& lives, const std::vector<Row>& values) {
  std::vector<std::pair<std::uint32_t, int>> changes;
  for (const Row row : values) {
    changes.emplace_back(lives[row].begin, 1);
    changes.emplace_back(std::max(lives[row].end, lives[row].begin + 1), -1);
  }
  std::sort(changes.begin(), changes.end());
  int alive = 0, most = 0;
  for (const auto& [place, change] : changes) most = std::max(most, alive += change);
  return static_cast<std::uint32_t>(most);
}

}  // namespace

LaneProgram assign_rows(Draft draft) {
  remove_dead(draft);
  find_reads_of_helpers(draft);
  const Lives lives(draft, order_copies(draft));

  // Fixed rows, constants, inputs, memory, registers.
  LaneProgram program = std::move(draft.program);
  std::vector<Row> numbers(draft.rows.size(), kNoRow);
  numbers[kActiveRow] = kActiveRow, numbers[kHelperRow] = kHelperRow;
  Row next = kFixedRows;
  const auto number_all = [&](Kind kind) {
    for (Row row = 0; row < draft.rows.size(); ++row)
      if (draft.rows[row].kind == kind) numbers[row] = next++;
  };
  number_all(Kind::constant);
  for (Row row = 0; row < draft.rows.size(); ++row)
    if (draft.rows[row].kind == Kind::constant) program.constants.emplace_back(numbers[row], draft.rows[row].bits);
  number_all(Kind::input);
  program.first_memory = next;
  number_all(Kind::memory);
  program.memory_rows = next - program.first_memory;

  // Values in the order in which they begin take the least register that is free.
  std::vector<Row> values;
  for (Row row = 0; row < draft.rows.size(); ++row)
    if (draft.rows[row].kind == Kind::value && lives[row].is_used()) values.push_back(row);
  std::stable_sort(values.begin(), values.end(), [&](Row a, Row b) { return lives[a].begin < lives[b].begin; });
  using Ending = std::pair<std::uint32_t, Row>;  // the end of a life, its register
  std::priority_queue<Ending, std::vector<Ending>, std::greater<>> ending;
  std::priority_queue<Row, std::vector<Row>, std::greater<>> free_rows;
  Row registers = 0;
  for (const Row row : values) {
    while (!ending.empty() && ending.top().first < lives[row].begin) {
      free_rows.push(ending.top().second);
      ending.pop();
    }
    Row chosen = registers;
    if (free_rows.empty())
      ++registers;
    else
      chosen = free_rows.top(), free_rows.pop();
    numbers[row] = next + chosen;
    ending.emplace(lives[row].end, chosen);
  }
  program.rows = next + registers;
  program.registers = most_alive(lives, values);

  const auto rename = [&](Row& row) { row = numbers[row]; };
  for (auto* interface : {&program.inputs, &program.outputs})
    for (InterfaceRow& part : *interface) rename(part.row);
  for (DraftBlock& block : draft.blocks) {
    LaneBlock made{.first_op = static_cast<std::uint32_t>(program.ops.size()),
                   .ops = static_cast<std::uint32_t>(block.ops.size()),
                   .end = block.end,
                   .condition = block.condition == kNoRow ? kNoRow : numbers[block.condition],
                   .first_edge = static_cast<std::uint32_t>(program.edges.size()),
                   .edges = static_cast<std::uint32_t>(block.edges.size())};
    for (LaneOp& op : block.ops) {
      if (!op.is_free) made.cost += info_of(op.code).cost;
      if (op.code == LaneCode::image) {
        const ImageAction action = draft.image_ops[op.c].action;
        made.requests += action == ImageAction::sample || action == ImageAction::gather || action == ImageAction::fetch;
      }
      for_each_result(draft, op,
                      [&](Row row) { op.keeps |= draft.rows[row].kind == Kind::value && lives[row].outlives_loop; });
      for_each_operand(draft, op, rename);
      for_each_result(draft, op, rename);
      if (op.code == LaneCode::load_local || op.code == LaneCode::store_local) rename(op.c);
      program.ops.push_back(op);
    }
    // To choose a block's lanes takes as long as some operations, and to read an image as long as many.
    constexpr std::size_t kBlockSteps = 4, kImageSteps = 32;
    std::size_t steps = kBlockSteps + block.ops.size() + block.edges.size();
    for (const DraftEdge& edge : block.edges) steps += edge.copies.size();
    for (const LaneOp& op : block.ops) steps += op.code == LaneCode::image ? kImageSteps : 0;
    made.steps = static_cast<std::uint32_t>(steps);
    for (const DraftEdge& edge : block.edges) {
      program.edges.push_back({.target = edge.target,
                               .literal = edge.literal,
                               .first_copy = static_cast<std::uint32_t>(program.ops.size()),
                               .copies = static_cast<std::uint32_t>(edge.copies.size())});
      for (const auto& [to, from] : edge.copies)
        program.ops.push_back({.code = LaneCode::copy, .keeps = true, .result = numbers[to], .a = numbers[from]});
    }
    program.blocks.push_back(made);
  }
  program.image_ops = std::move(draft.image_ops);
  return program;
}

}  // namespace beampipe

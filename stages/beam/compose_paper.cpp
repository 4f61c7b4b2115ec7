#include "stages/beam/compose_paper.h"

#include <algorithm>
#include <numeric>

#include "stages/cost/counting.h"

namespace beampipe {
namespace {

using CountedFragment = FragmentOf<Counted<float>, Counted<std::uint32_t>>;

CountedFragment counted_fragment(OperationCounts& counts) {
  const Counted<float> one(1.0f, counts);
  const Counted<std::uint32_t> all(~0u, counts);
  return {{one, all, {one, one, one}, one, one, one, {one, one, one}}, all};
}

// Numbers of a stored aggregate that are not as they are worked on.
std::uint64_t packed_numbers(PaperStorage storage) {
  switch (storage) {
    case PaperStorage::slides:
      return 3;  // colour
    case PaperStorage::text:
      return 6;  // colour, slopes, thickness
    case PaperStorage::float32:
      break;
  }
  return 0;
}

// The aggregate is loaded before each merge, and stored behind it.
OperationCounts merge_cost(const SamplePattern& pattern, const MergeRules& rules, PaperStorage storage) {
  return count_operations([&](OperationCounts& counts) {
    const CountedFragment fragment = counted_fragment(counts);
    merge_formula(fragment, fragment.surface, pattern, rules);
    counts.convert += 2 * packed_numbers(storage);
  });
}

OperationCounts over_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFragment fragment = counted_fragment(counts);
    over_formula(fragment, fragment.surface);
    counts.convert += 2 * 3;  // fp16 colour
  });
}

void count_merges(std::uint64_t merges, std::uint64_t pixels, const OperationCounts& cost, std::uint32_t fragment_bytes,
                  std::uint32_t aggregate_bytes, StageCounters& counters) {
  counters.items_in += merges;
  counters.items_out += pixels;
  counters.ops += cost * merges;
  counters.bytes_read += merges * fragment_bytes;
  counters.bytes_written += pixels * aggregate_bytes;
  counters.lanes_used += merges;
  counters.lanes_issued += merges;
}

// Coverage as float32, colour as fp16.
Aggregate stored_over(Aggregate aggregate) {
  for (float& channel : aggregate.color) channel = HalfBits(channel);
  return aggregate;
}

}  // namespace

MergeFragment merge_fragment(const Fragment& fragment) {
  const glm::vec3& color = fragment.color;
  return {{fragment.alpha,
           fragment.mask.words[0],
           fragment.plane,
           0.0f,
           fragment.z_min,
           fragment.z_max,
           {color.r, color.g, color.b}},
          fragment.tiny ? ~0u : 0u};
}

namespace {

template <class Stored>
std::vector<Aggregate> compose_stored(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                      const SamplePattern& pattern, const MergeRules& rules) {
  const std::size_t pixels = buffer.first.size() - 1;
  // Round r merges the r-th fragment of every pixel that has one: independent merges, one per lane. With the deepest
  // pixels first, the pixels of a round are a prefix.
  std::vector<std::uint32_t> order(pixels);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return buffer.depth_of(a) > buffer.depth_of(b); });
  std::vector<Stored> stored(pixels, Stored(kEmptyAggregate));
  std::vector<Aggregate> merging(pixels);
  std::vector<MergeFragment> arriving(pixels);
  std::size_t active = pixels;
  for (std::uint32_t round = 0;; ++round) {
    while (active > 0 && buffer.depth_of(order[active - 1]) <= round) --active;
    if (active == 0) break;
    for (std::size_t i = 0; i < active; ++i) {
      arriving[i] = merge_fragment(fragments[buffer.records[buffer.first[order[i]] + round]]);
      merging[i] = stored[i];
    }
    merge(arriving.data(), active, pattern, rules, merging.data());
    for (std::size_t i = 0; i < active; ++i) stored[i] = Stored(merging[i]);
  }
  std::vector<Aggregate> aggregates(pixels);
  for (std::size_t i = 0; i < pixels; ++i) aggregates[order[i]] = stored[i];
  return aggregates;
}

}  // namespace

std::vector<Aggregate> compose(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                               const SamplePattern& pattern, const MergeRules& rules, PaperStorage storage,
                               StageCounters& counters) {
  count_merges(buffer.records.size(), buffer.first.size() - 1, merge_cost(pattern, rules, storage),
               paper_aggregate_bytes(storage), paper_aggregate_bytes(storage), counters);
  switch (storage) {
    case PaperStorage::slides:
      return compose_stored<SlidesAggregate>(fragments, buffer, pattern, rules);
    case PaperStorage::text:
      return compose_stored<TextAggregate>(fragments, buffer, pattern, rules);
    case PaperStorage::float32:
      break;
  }
  return compose_stored<Aggregate>(fragments, buffer, pattern, rules);
}

std::vector<Aggregate> compose_over(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                    StageCounters& counters) {
  const std::size_t pixels = buffer.first.size() - 1;
  std::vector<Aggregate> aggregates(pixels, kEmptyAggregate);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    for (std::uint32_t i = buffer.first[pixel]; i < buffer.first[pixel + 1]; ++i)
      aggregates[pixel] = stored_over(over_formula(merge_fragment(fragments[buffer.records[i]]), aggregates[pixel]));
  count_merges(buffer.records.size(), pixels, over_cost(), kOverFragmentBytes, kOverBytes, counters);
  return aggregates;
}

}  // namespace beampipe

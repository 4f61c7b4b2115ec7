// What alpha_test is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/sample_fragment.h"
#include "stages/samples/alpha_test.h"
#include "stages/surface/hashed_alpha.h"

namespace beampipe {

struct AlphaTestWork {
  std::uint64_t tested = 0, left = 0;  // fragments of cutouts, and those that remain
  std::uint64_t tests = 0;             // invocations of these fragments, without helpers
  std::uint64_t runs = 0;              // of quads, whose four lanes all find alpha
  OperationCounts alphas{};

  // `alpha`: what finding it costs an invocation.
  void add(std::uint64_t tests_of_fragment, std::uint64_t new_runs, const OperationCounts& alpha) {
    ++tested, tests += tests_of_fragment, runs += new_runs;
    alphas += alpha * (4 * new_runs);
  }
};

// Of one sample: the hash, moved on by its share of all samples.
template <class Real>
Real threshold_of(const Real& hash, int sample, int samples) {
  const Real one(1.0f);
  const Real moved = hash + Real(static_cast<float>(sample) / static_cast<float>(samples));
  return select(moved < one, moved, moved - one);
}

inline void charge(const AlphaTestWork& work, const AlphaTest& test, StageCounters& counters) {
  counters.items_in += work.tested;
  counters.items_out += work.left;
  counters.ops += work.alphas;
  const auto samples = static_cast<std::uint64_t>(test.sampling.pattern.count);
  const bool is_tested = test.coverage == AlphaCoverage::test || test.coverage == AlphaCoverage::by_sample;
  counters.ops += OperationCounts{.add = 1} * (work.tests * (is_tested ? 1 : samples));
  if (test.coverage == AlphaCoverage::hashed) {
    static const UnitCost hash = count_operations([](OperationCounts& counts) {
      const Counted<float> value(0.5f, counts);
      hashed_threshold<Counted<float>>({value, value}, {value, value}, {value, value});
    });
    static const UnitCost threshold =
        count_operations([](OperationCounts& counts) { threshold_of(Counted<float>(0.5f, counts), 0, 1); });
    counters.ops += hash * work.tests;
    counters.ops += threshold * (work.tests * samples);
  }
  counters.bytes_read += work.tested * kSampleFragmentBytes;
  counters.bytes_written += work.left * kSampleFragmentBytes;
  counters.lanes_used += work.tests;
  counters.lanes_issued += 4 * work.runs;
}

}  // namespace beampipe

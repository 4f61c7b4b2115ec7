#include "tools/stress/hard_cases.h"

#include "tools/stress/case_parts.h"

namespace beampipe {
namespace {

StatedLimit per_position(double error, const char* reason) {
  return {[error](int positions) { return error * 256 / positions; }, reason};
}

}  // namespace

StatedLimits full_masks() {
  return {{ErrorSource::estimated_areas, {largest_cut, kFull}},
          {ErrorSource::counted_positions, per_position(largest_cut(256), kFull)},
          {ErrorSource::published_merges, {largest_cut(256), kFull}}};
}

StatedLimits mask_limits(double error, const char* reason) {
  return {{ErrorSource::estimated_areas, {error, reason}},
          {ErrorSource::counted_positions, per_position(error, reason)}};
}

StatedLimits merge_limits(double published, double over) {
  return {{ErrorSource::published_merges, {published, kCasav}},
          {ErrorSource::independent_fragments, {over, kOver}},
          {ErrorSource::merges_one_by_one, {over, kOneByOne}}};
}

StatedLimits together(std::initializer_list<StatedLimits> several) {
  StatedLimits all;
  for (const StatedLimits& limits : several)
    for (const auto& [source, limit] : limits) all[source] = limit;
  return all;
}

double largest_cut(int positions) {
  switch (positions) {
    case 32:
      return 0.0441;
    case 64:
      return 0x1p-5;
    default:
      return 0x1p-6;
  }
}

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> cases;
  for (const auto& some :
       {coverage_cases(), depth_cases(), frame_cases(), owner_cases(), state_cases(), surface_cases()})
    cases.insert(cases.end(), some.begin(), some.end());
  for (HardCase& hard_case : cases)
    hard_case.limits[ErrorSource::shared_shading_samples] = {
        0.75, "triangles of a draw share the colours of a quad's four samples"};
  return cases;
}

}  // namespace beampipe

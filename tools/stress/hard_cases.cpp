#include "tools/stress/hard_cases.h"

#include "tools/stress/case_parts.h"

namespace beampipe {

std::map<std::string, StatedLimit> full_masks(int edges) {
  return {{"beam", {edges * largest_cut(256), kFull}},
          {"beam:order=sorted,bits=64", {edges * largest_cut(64), kFull}},
          {"beam:order=sorted,bits=32", {edges * largest_cut(32), kFull}},
          {kStream, {edges * largest_cut(128), kFull}},
          {kCoarseStream, {edges * largest_cut(32), kFull}},
          {kSmallStream, {edges * largest_cut(64), kFull}}};
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

namespace {

// In one pass, a result is limited to what counting positions gives: to three of them, and one more for the count.
void add_one_pass(HardCase& hard_case) {
  constexpr double kPositions = 4;
  const auto stated = hard_case.limits.find("beam");
  const StatedLimit several_passes = stated == hard_case.limits.end() ? StatedLimit{0, kCounted} : stated->second;
  for (const auto& [spec, positions] : {std::pair{kOnePass, 256}, {kOnePassStream, 128}}) {
    const double counted = kPositions / positions;
    hard_case.limits[spec] = counted > several_passes.error ? StatedLimit{counted, kCounted} : several_passes;
  }
}

}  // namespace

std::vector<HardCase> hard_cases(bool with_heavy) {
  std::vector<HardCase> cases;
  for (const auto& some : {coverage_cases(), depth_cases(), frame_cases()})
    cases.insert(cases.end(), some.begin(), some.end());
  for (HardCase& hard_case : cases) add_one_pass(hard_case);
  for (HardCase& hard_case : cases)
    hard_case.limits["dvm:material=draw"] = {0.75, "triangles of a draw share the colours of a quad's four samples"};
  if (with_heavy)
    for (HardCase& heavy : heavy_cases()) cases.push_back(std::move(heavy));
  return cases;
}

}  // namespace beampipe

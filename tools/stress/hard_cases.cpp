#include "tools/stress/hard_cases.h"

#include "tools/stress/case_parts.h"

namespace beampipe {

std::map<std::string, StatedLimit> full_masks(int edges) {
  return {{"beam", {edges * largest_cut(256), kFull}},
          {"casav", {edges * largest_cut(256), kFull}},
          {"beam:order=sorted,bits=32", {edges * largest_cut(32), kFull}}};
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

std::vector<HardCase> hard_cases(bool with_heavy) {
  std::vector<HardCase> cases;
  for (const auto& some :
       {coverage_cases(), depth_cases(), frame_cases(), owner_cases(), state_cases(), surface_cases()})
    cases.insert(cases.end(), some.begin(), some.end());
  for (HardCase& hard_case : cases)
    hard_case.limits["dvm:material=draw"] = {0.75, "triangles of a draw share the colours of a quad's four samples"};
  if (with_heavy)
    for (HardCase& heavy : heavy_cases()) cases.push_back(std::move(heavy));
  return cases;
}

}  // namespace beampipe

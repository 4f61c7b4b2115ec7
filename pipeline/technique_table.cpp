#include "pipeline/technique_table.h"

namespace beampipe {

// Each is defined in the file of its name in pipeline/techniques/.
TechniqueKind beam_kind();
TechniqueKind beam_sorted_kind();
TechniqueKind beam_stream_kind();
TechniqueKind casav_kind();
TechniqueKind alpha_kind();  // in casav.cpp
TechniqueKind z3_kind();
TechniqueKind msaa_kind();
TechniqueKind acaa_kind();
TechniqueKind deferred_kind();
TechniqueKind visibility_kind();
TechniqueKind taa_kind();
TechniqueKind dvm_kind();
TechniqueKind reference_kind();

const std::vector<TechniqueKind>& built_in_kinds() {
  static const std::vector<TechniqueKind> kinds = {
      beam_kind(), beam_sorted_kind(), beam_stream_kind(), casav_kind(), alpha_kind(), z3_kind(),        msaa_kind(),
      acaa_kind(), deferred_kind(),    visibility_kind(),  taa_kind(),   dvm_kind(),   reference_kind(),
  };
  return kinds;
}

// Weak, so that the linker prefers a program's own.
[[gnu::weak]] const std::vector<TechniqueKind>& technique_kinds() { return built_in_kinds(); }

}  // namespace beampipe

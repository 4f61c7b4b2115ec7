#include "pipeline/technique_table.h"

#include "pipeline/techniques/acaa.h"
#include "pipeline/techniques/beam.h"
#include "pipeline/techniques/beam_paper.h"
#include "pipeline/techniques/beam_stream.h"
#include "pipeline/techniques/deferred.h"
#include "pipeline/techniques/dvm.h"
#include "pipeline/techniques/msaa.h"
#include "pipeline/techniques/reference.h"
#include "pipeline/techniques/taa.h"
#include "pipeline/techniques/visibility.h"
#include "pipeline/techniques/z3.h"

namespace beampipe {

const std::vector<TechniqueKind>& technique_kinds() {
  static const std::vector<TechniqueKind> kinds = {
      beam_kind(), beam_stream_kind(), beam_paper_kind(), alpha_kind(), z3_kind(),  msaa_kind(),
      acaa_kind(), deferred_kind(),    visibility_kind(), taa_kind(),   dvm_kind(), reference_kind(),
  };
  return kinds;
}

std::string times(const char* format, std::uint32_t count) {
  return std::string(format).append(" x ").append(std::to_string(count));
}

}  // namespace beampipe

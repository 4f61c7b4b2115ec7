#include "tools/evaluate/mean_times.h"

#include "tools/evaluate/modelled_time.h"

namespace beampipe {

MeanTimes mean_times(const Hardware& hardware, std::size_t implementation, const TechniqueReport& result) {
  MeanTimes mean;
  for (const FrameReport& frame : result.frames) {
    const ModelledTime time = modelled_time(hardware, hardware.implementations[implementation], frame.work());
    mean.sum_ms += time.sum_ms;
    mean.overlap_ms += time.overlap_ms;
  }
  const auto frames = static_cast<double>(result.frames.size());
  return {mean.sum_ms / frames, mean.overlap_ms / frames};
}

}  // namespace beampipe

#include "tools/evaluate/mean_times.h"

#include "tools/evaluate/modelled_time.h"

namespace beampipe {

MeanTimes mean_times(const Hardware& hardware, std::size_t implementation, const TechniqueReport& result) {
  MeanTimes mean;
  for (const FrameReport& frame : result.frames) {
    const ModelledTime time = modelled_time(hardware, hardware.implementations[implementation], frame.work());
    mean.in_turn_ms += time.in_turn_ms;
    mean.at_once_ms += time.at_once_ms;
  }
  const auto frames = static_cast<double>(result.frames.size());
  return {mean.in_turn_ms / frames, mean.at_once_ms / frames};
}

}  // namespace beampipe

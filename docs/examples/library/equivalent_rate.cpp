// How wrong a technique's picture of a trace's first frame is, which MSAA rate is as wrong, and how long the frame
// would take on a Titan V: equivalent_rate TRACE SPEC
#include <exception>
#include <iostream>
#include <vector>

#include "pipeline/technique.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/metrics.h"
#include "tools/evaluate/modelled_time.h"
#include "traces/files/trace_io.h"

int main(int argc, char** argv) {
  using namespace beampipe;
  if (argc != 3) {
    std::cerr << "usage: equivalent_rate TRACE SPEC\n";
    return 2;
  }
  try {
    const Trace trace = read_trace(argv[1]);
    const Image reference = parse_technique("reference").render(trace, 0, {}).image;
    const auto rmse_of = [&](const FrameResult& result) { return measure_error(result.image, reference).rmse; };
    std::vector<LadderRung> ladder;
    for (std::uint32_t samples = 1; samples <= 256; samples *= 2) {
      const Technique msaa = parse_technique("msaa:" + std::to_string(samples));
      ladder.push_back({samples, rmse_of(msaa.render(trace, 0, {}))});
    }
    const FrameResult result = parse_technique(argv[2]).render(trace, 0, {});
    const Hardware hardware = titan_v();
    std::cout << "rmse " << rmse_of(result) << ", equivalent MSAA rate "
              << equivalent_msaa(rmse_of(result), ladder).samples << '\n';
    for (const Implementation& implementation : hardware.implementations)
      std::cout << implementation.name << ": " << modelled_time(hardware, implementation, {result.stages}).at_once_ms
                << " ms\n";
  } catch (const std::exception& error) {
    std::cerr << "equivalent_rate: error: " << error.what() << '\n';
    return 1;
  }
}

// Renders the first frame of a trace with a technique, and prints what every stage did: render_trace TRACE SPEC
#include <exception>
#include <iostream>

#include "pipeline/technique.h"
#include "traces/files/trace_io.h"

int main(int argc, char** argv) {
  using namespace beampipe;
  if (argc != 3) {
    std::cerr << "usage: render_trace TRACE SPEC\n";
    return 2;
  }
  try {
    const Trace trace = read_trace(argv[1]);
    const Technique technique = parse_technique(argv[2]);
    const FrameResult result = technique.render(trace, 0, {.threads = 1});
    double sum = 0;
    for (std::size_t i = 0; i < result.image.rgba.size(); i += 4) sum += result.image.rgba[i + 1];
    std::cout << technique.spec << ": " << result.image.width << " x " << result.image.height << " pixels, mean green "
              << sum / (result.image.rgba.size() / 4) << '\n';
    for (const StageCounters& stage : result.stages)
      std::cout << stage.stage << ": " << stage.items_in << " in, " << stage.items_out << " out, " << stage.ops.total()
                << " operations, " << stage.dram_bytes << " bytes of DRAM\n";
  } catch (const std::exception& error) {
    std::cerr << "render_trace: error: " << error.what() << '\n';
    return 1;
  }
}

// Reads any bytes as a trace. They give an error of one line, or a trace that can be written and read again.
#include "tests/fuzz/fuzz_input.h"
#include "traces/trace_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  const std::filesystem::path file = folder.write("trace.json", text_of(data, size));
  Trace trace;
  try {
    trace = read_trace(file);
  } catch (const TraceError& error) {
    require_one_line(error.what());
    return 0;
  }
  const std::filesystem::path again = folder.write("again.json", "");
  write_trace(trace, again);
  if (read_trace(again).frames.size() != trace.frames.size()) std::abort();
  return 0;
}

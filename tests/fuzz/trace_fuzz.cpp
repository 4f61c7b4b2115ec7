// Reads any bytes as a trace and, after a NUL, the buffer that it may view. They give an error of one line, or a trace
// that can be written and read again.
#include "tests/fuzz/fuzz_input.h"
#include "traces/files/trace_io.h"

namespace {

// The buffer if the input has none: a triangle in four coordinates as floats, then three small integers.
constexpr std::string_view kBuffer(
    "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\x80\x3f"
    "\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\x80\x3f\0\0\1\0\2\0\0\0\xff\xff\xff\xff\0\0\0\0",
    64);

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  const std::vector<std::string_view> parts = parts_of(text_of(data, size), 2);
  folder.write("b.bin", parts[1].empty() ? kBuffer : parts[1]);
  const std::filesystem::path file = folder.write("trace.json", parts[0]);
  Trace trace;
  try {
    trace = read_trace(file);
  } catch (const TraceError& error) {
    require_one_line(error.what());
    return 0;
  }
  const std::filesystem::path again = folder.write("again.json", "");
  for (const ArrayStorage storage : {ArrayStorage::text, ArrayStorage::binary}) {
    write_trace(trace, again, storage);
    if (read_trace(again).frames.size() != trace.frames.size()) std::abort();
  }
  return 0;
}

// The buffers that a technique lists: some have a constant size, others grow by a stated rule, and together they are
// what the heap really holds.

#include "pipeline/technique_table.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/geometry/vertex_setup.h"
#include "tests/pipeline/counted_heap.h"
#include "tests/pipeline/test_pictures.h"
#include "traces/scenes.h"

namespace beampipe::buffers_test {

// Triangles over the lower left half of one pixel, from far to near, so that none hides a later one.
Trace halves(int layers) {
  std::vector<PixelSpaceTriangle> triangles;
  for (int i = 0; i < layers; ++i) {
    const double z = 0.9 - 0.8 * i / layers;
    triangles.push_back({{{2.0, 2.0, z}, {3.0, 3.0, z}, {2.0, 3.0, z}}, glm::vec3(0.5f)});
  }
  return pixel_trace(4, 4, triangles);
}

// The buffers of binning, which grow with the number of triangles alone.
bool is_per_triangle(const std::string& name) { return name == "setup_triangles" || name == "bin_lists"; }

TEST(Buffers, StreamingOrderHoldsTheSameForEachPixelHoweverDeepItIs) {
  std::vector<Buffer> first;
  for (const int layers : {100, 1000, 10000}) {  // enough to fill the queues
    std::vector<Buffer> now = render_unmodelled("beam:order=stream", halves(layers)).buffers;
    std::erase_if(now, [](const Buffer& buffer) { return is_per_triangle(buffer.name); });
    EXPECT_FALSE(now.empty());
    if (first.empty()) first = now;
    EXPECT_EQ(now, first) << layers;
  }
}

TEST(Buffers, TheABufferGrowsByARecordForEveryPairThatIsNotHidden) {
  for (const int layers : {1, 10, 100, 1000, 10000}) {
    const FrameResult sorted = render_unmodelled("beam:order=sorted", halves(layers)),
                      published = render_unmodelled("casav", halves(layers));
    const auto count = static_cast<std::uint64_t>(layers);
    // The pixel that a triangle covers, and those that it touches without covering any area.
    const std::uint64_t touched = sorted.stages.at(1).items_out / count;
    EXPECT_EQ(sorted.stages.at(1).items_out, touched * count);
    EXPECT_EQ(bytes_of(sorted, "a_buffer"), 16 * 4 + touched * count * 16) << layers;
    EXPECT_EQ(bytes_of(sorted, "waiting_pairs"), touched * count * 16) << layers;
    EXPECT_EQ(bytes_of(published, "a_buffer"), 16 * 4 + count * 46) << layers;
    EXPECT_EQ(bytes_of(published, "setup_triangles"), count * 116);
    EXPECT_EQ(bytes_of(published, "bin_lists"), count * 4);
  }
}

// Binning writes the keys of near-first order beside the entries of the lists.
TEST(Buffers, SortedListsHaveAKeyForEachEntry) {
  const Trace trace = halves(100);
  for (const char* spec : {"beam", "casav:order=near-first"})
    EXPECT_EQ(bytes_of(render_unmodelled(spec, trace), "bin_lists"), 100u * (4 + 4)) << spec;
  for (const char* spec : {"beam:order=sorted", "beam:order=stream", "casav:order=stream", "msaa:8"})
    EXPECT_EQ(bytes_of(render_unmodelled(spec, trace), "bin_lists"), 100u * 4) << spec;
}

// If all triangles but the nearest are hidden, the size of the sorted A-buffer is constant too.
TEST(Buffers, HiddenPairsAreNotInTheABuffer) {
  for (const std::uint32_t layers : {10u, 1000u}) {
    const Trace trace = make_scene("stack", {.triangles = layers, .width = 4, .height = 4});
    EXPECT_EQ(bytes_of(render_unmodelled("beam:order=sorted", trace), "a_buffer"), 16u * (4 + 16)) << layers;
  }
}

// More triangles make the heap grow by the listed buffers and by what the simulator itself needs: the vertices of
// vertex_setup for each triangle, and for each pair that waits with the others of its bin kPairWorkingBytes and
// kSortBytes, which --memory-limit is based on.
TEST(Buffers, AreWhatIsAllocated) {
  constexpr double kVertexBytes = 400;
  struct Measured {
    double heap, listed, pairs;
  };
  const auto measure = [](const std::string& spec, int layers) {
    const Trace trace = halves(layers);
    const std::int64_t before = heap_bytes();
    restart_heap_peak();
    const FrameResult result = render_unmodelled(spec, trace);
    Measured measured{static_cast<double>(heap_peak() - before), static_cast<double>(result.a_buffer_peak_bytes),
                      result.a_buffer_peak_bytes > 0 ? static_cast<double>(result.stages.at(1).items_out) : 0.0};
    for (const Buffer& buffer : result.buffers) measured.listed += static_cast<double>(buffer.peak_bytes);
    return measured;
  };
  for (const std::string& spec : example_specs()) {
    const Measured few = measure(spec, 4000), many = measure(spec, 16000);
    const double heap = many.heap - few.heap, listed = many.listed - few.listed;
    EXPECT_GE(heap, listed) << spec << ": something is listed that is not held";
    EXPECT_LE(heap, listed + 12000 * kVertexBytes + (many.pairs - few.pairs) * (kPairWorkingBytes + kSortBytes))
        << spec << ": something is held that is not listed";
  }
}

// The memory to set up a frame's draws grows in proportion to their number. All allocations count, including those that
// have been freed.
TEST(Buffers, DrawsAreNotCopiedAgainForEachThatFollows) {
  const auto given_for = [](std::size_t draws) {
    Trace trace = halves(1);
    trace.frames[0].draws.resize(draws, trace.frames[0].draws[0]);
    StageCounters counters;
    const std::int64_t before = heap_given();
    EXPECT_EQ(vertex_setup(trace, trace.frames[0], counters).triangles.size(), draws);
    return static_cast<double>(heap_given() - before);
  };
  EXPECT_LE(given_for(4000), 2.5 * given_for(2000));
}

// A frame that needs too much memory is refused before it begins, by its working bytes per pixel. They are really
// allocated, and so are at most seven counts of each pixel.
TEST(Buffers, WorkingBytesAreHeldPerPixel) {
  Trace trace = halves(1);
  trace.frames[0].width = trace.frames[0].height = 512;
  for (const std::string& spec : example_specs()) {
    const std::int64_t before = heap_bytes();
    restart_heap_peak();
    render_unmodelled(spec, trace);
    const double held = static_cast<double>(heap_peak() - before) / (512 * 512);
    const std::uint32_t stated = parse_technique(spec).working_bytes_per_pixel;
    EXPECT_GE(held, stated) << spec;
    EXPECT_LE(held, stated + 28) << spec;
  }
}

}  // namespace beampipe::buffers_test

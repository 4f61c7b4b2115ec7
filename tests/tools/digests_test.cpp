// Pictures and counters stay what they are until someone changes them on purpose. tests/tools/digests.txt has a line
// for every scene, and two samples, with every technique: a digest of the picture, sums of counters, and a digest of
// all counters. BEAMPIPE_WRITE_DIGESTS=1 writes the file, and says what changed.

#include <iostream>

#include "pipeline/technique_table.h"
#include "tests/test.h"
#include "tools/files/digest.h"
#include "traces/files/trace_io.h"
#include "traces/scenes.h"

namespace beampipe::digests_test {

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// "picture 0123456789abcdef operations 12 bytes 34 dram 56 counters 0123456789abcdef"
std::string line_of(const FrameResult& result) {
  std::ostringstream all;
  StageCounters sum;
  for (const StageCounters& stage : result.stages) {
    all << stage.stage;
    for (const CounterInfo& counter : stage_counters()) all << ' ' << counter.value(stage);
    all << '\n';
    sum += stage;
  }
  for (const auto& [name, values] : result.pixel_counters) all << name << digest_of(bytes_of(values)) << '\n';
  for (const Buffer& buffer : result.buffers) all << buffer.name << ' ' << buffer.peak_bytes << '\n';
  std::ostringstream line;
  line << "picture " << digest_of(bytes_of(result.image.rgba)) << " operations " << sum.ops.total() << " bytes "
       << sum.logical_bytes() << " dram " << sum.dram_bytes << " counters " << digest_of(all.str());
  return line.str();
}

// Lines by "scene spec".
std::map<std::string, std::string> found_lines() {
  std::map<std::string, std::string> lines;
  const auto add = [&](std::string_view name, const Trace& trace) {
    for (const std::string& spec : example_specs())
      lines[std::string(name) + ' ' + spec] = line_of(parse_technique(spec).render(trace, 0, {2}));
  };
  for (const SceneKind& kind : scene_kinds())
    add(kind.name, make_scene(kind.name, {.triangles = 1000, .width = 32, .height = 19}));
  const std::filesystem::path samples = std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples";
  for (const std::string sample : {"captured_quads", "program_quad"})  // with fragment shaders of their own
    add(sample, read_trace(samples / (sample + ".json")));
  // Pixels in memory, whose caches see the order in which pixels are visited, with flat surfaces and with others.
  FrameInput in_memory{2};
  in_memory.memory.framebuffer = Place::in_memory;
  for (const char* scene : {"fence", "room"}) {
    Trace trace = make_scene(scene, {.triangles = 1000, .width = 96, .height = 54});
    for (Material& material : trace.materials)
      material.base_texture = material.metallic_roughness_texture = material.normal_texture = std::nullopt;
    trace.images.clear();
    for (const char* spec : {"beam", "beam:pool=16", "beam:order=stream", "beam:order=sorted", "casav", "msaa:8"})
      lines[std::string(scene) + " in memory " + spec] = line_of(parse_technique(spec).render(trace, 0, in_memory));
  }
  return lines;
}

std::map<std::string, std::string> read_lines(const std::filesystem::path& file) {
  std::map<std::string, std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t end = line.find(" picture ");
    if (end != line.npos) lines[line.substr(0, end)] = line.substr(end + 1);
  }
  return lines;
}

// "dram 1200 -> 1210" for each value that differs.
std::string changes(const std::string& before, const std::string& now) {
  std::istringstream a(before), b(now);
  std::string text, name, old_value, other_name, new_value;
  while (a >> name >> old_value && b >> other_name >> new_value)
    if (old_value != new_value) text += ' ' + name + ' ' + old_value + " -> " + new_value;
  return text;
}

TEST(Digests, PicturesAndCountersAreThoseOfTheFile) {
  const std::filesystem::path file = std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "tests/tools/digests.txt";
  const std::map<std::string, std::string> before = read_lines(file), now = found_lines();
  std::string report;
  for (const auto& [name, line] : now)
    if (const auto known = before.find(name); known == before.end())
      report += name + " is new\n";
    else if (known->second != line)
      report += name + ':' + changes(known->second, line) + '\n';
  for (const auto& [name, line] : before)
    if (!now.contains(name)) report += name + " is gone\n";
  if (!std::getenv("BEAMPIPE_WRITE_DIGESTS")) {
    EXPECT_EQ(report, "") << "If this is meant: BEAMPIPE_WRITE_DIGESTS=1 build/release/tests/tools_tests "
                             "--gtest_filter=Digests.*";
    return;
  }
  std::cout << report;
  std::ofstream stream(file);
  for (const auto& [name, line] : now) stream << name << ' ' << line << '\n';
}

}  // namespace beampipe::digests_test

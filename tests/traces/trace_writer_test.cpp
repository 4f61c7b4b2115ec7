#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "tests/traces/test_folder.h"

namespace beampipe {
namespace {

template <typename T>
void expect_same_bits(const T& a, const T& b) {
  static_assert(sizeof(T) % 4 == 0);
  using Words = std::array<std::uint32_t, sizeof(T) / 4>;
  EXPECT_EQ(std::bit_cast<Words>(a), std::bit_cast<Words>(b));
}

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.triangles, b.triangles);
  ASSERT_EQ(a.positions.size(), b.positions.size());
  ASSERT_EQ(a.colors.size(), b.colors.size());
  for (std::size_t i = 0; i < a.positions.size(); ++i) expect_same_bits(a.positions[i], b.positions[i]);
  for (std::size_t i = 0; i < a.colors.size(); ++i) expect_same_bits(a.colors[i], b.colors[i]);
}

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  expect_same_bits(a.background, b.background);
  EXPECT_EQ(a.camera.has_value(), b.camera.has_value());
  if (a.camera && b.camera) expect_same_bits(*a.camera, *b.camera);
  expect_same_bits(a.view, b.view);
  expect_same_bits(a.projection, b.projection);
  ASSERT_EQ(a.lighting.lights.size(), b.lighting.lights.size());
  for (std::size_t i = 0; i < a.lighting.lights.size(); ++i)
    expect_same_bits(a.lighting.lights[i].direction, b.lighting.lights[i].direction);
  ASSERT_EQ(a.draws.size(), b.draws.size());
  for (std::size_t i = 0; i < a.draws.size(); ++i) {
    EXPECT_EQ(a.draws[i].mesh, b.draws[i].mesh);
    expect_same_bits(a.draws[i].transform, b.draws[i].transform);
    EXPECT_EQ(a.draws[i].kd, b.draws[i].kd);
    EXPECT_EQ(a.draws[i].cull, b.draws[i].cull);
    EXPECT_EQ(a.draws[i].shading, b.draws[i].shading);
  }
}

// Any finite number, from the subnormal ones to the largest.
template <typename Float, typename Bits>
Float any_finite(std::mt19937_64& random) {
  for (;;) {
    const Float value = std::bit_cast<Float>(static_cast<Bits>(random()));
    if (std::isfinite(value)) return value;
  }
}

Trace example() {
  std::mt19937_64 random(7);
  const auto any_float = [&] { return any_finite<float, std::uint32_t>(random); };
  const auto any_double = [&] { return any_finite<double, std::uint64_t>(random); };
  const auto color = [&] { return glm::vec3(std::abs(any_float()), std::abs(any_float()), std::abs(any_float())); };
  const auto matrix = [&] {
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = any_double();
    return m;
  };

  Mesh mesh;
  mesh.name = "a \"mesh\"/with ~ odd\nname é";
  for (int i = 0; i < 20000; ++i) mesh.positions.emplace_back(any_float(), any_float(), any_float());
  for (std::uint32_t i = 0; i + 2 < mesh.positions.size(); ++i) {
    mesh.triangles.emplace_back(i, i + 1, i + 2);
    mesh.colors.push_back(color());
  }
  const float most = std::numeric_limits<float>::max(), least = std::numeric_limits<float>::denorm_min();
  mesh.positions[0] = {-0.0f, most, -most};
  mesh.positions[1] = {least, -least, 16777216.0f};
  mesh.positions[2].x = 7.038531e-26f;  // its shortest text, rounded to double and then to float, is another float
  Mesh empty;
  empty.name = "";

  Trace trace;
  trace.meshes = {mesh, empty};
  Frame frame;
  frame.width = 3;
  frame.height = 16384;
  frame.view = matrix();
  frame.projection = matrix();
  frame.view[2][1] = -0.0;
  frame.draws = {{0, matrix(), color(), Cull::back, Shading::unlit, {}},
                 {1, glm::dmat4(1.0), {}, Cull::front, Shading::unlit, {}}};
  trace.frames.push_back(frame);

  set_camera(frame, {{0.1, 0.2, 1.0 / 3}, {-5, 6, 7.7}, {0.01, 1, 0}, 35.9, 1e-3, 12345.678});
  frame.background = color();
  frame.draws = {{0, glm::dmat4(1.0), {}, Cull::none, Shading::lambert, {}}};
  for (int i = 0; i < 50; ++i) {  // reading must give back normalised directions bit by bit
    frame.lighting.lights = {
        {glm::normalize(glm::vec3(static_cast<float>(random() % 1000) - 499.5f, 1.0f, 2.0f + static_cast<float>(i)))}};
    trace.frames.push_back(frame);
  }
  return trace;
}

class TraceWriterTest : public FolderTest {
 protected:
  // The message of any runtime_error.
  std::string failure(const Trace& trace, const std::string& name) const {
    try {
      write_trace(trace, path(name));
    } catch (const std::runtime_error& error) {
      return without_folder(error.what());
    }
    return "no error";
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path("")), {}));
  }
};

TEST_F(TraceWriterTest, ReadsBackTheSameBits) {
  const Trace trace = example();
  write_trace(trace, path("trace.json"));
  const Trace back = read_trace(path("trace.json"));
  ASSERT_EQ(back.meshes.size(), trace.meshes.size());
  ASSERT_EQ(back.frames.size(), trace.frames.size());
  for (std::size_t i = 0; i < trace.meshes.size(); ++i) expect_same(trace.meshes[i], back.meshes[i]);
  for (std::size_t i = 0; i < trace.frames.size(); ++i) expect_same(trace.frames[i], back.frames[i]);

  write_trace(back, path("again.json"));
  EXPECT_EQ(read("trace.json"), read("again.json"));
  EXPECT_EQ(files(), 2u);
}

TEST_F(TraceWriterTest, WritesNumbersShortly) {
  Trace trace;
  Mesh mesh;
  mesh.name = "m";
  mesh.positions = {{0.1f, 1.0f, -0.0f}};
  trace.meshes = {mesh};
  trace.frames.resize(1);
  trace.frames[0].width = trace.frames[0].height = 1;
  write_trace(trace, path("trace.json"));
  EXPECT_NE(read("trace.json").find("[0.1,1,-0.0]"), std::string::npos) << read("trace.json");
}

TEST_F(TraceWriterTest, RefusesWhatNoReaderWouldTake) {
  write("trace.json", "old");
  Trace trace = example();
  trace.meshes[0].positions[5].y = NAN;
  EXPECT_EQ(failure(trace, "trace.json"), "trace.json: cannot write the trace: a number in it is not finite");
  trace = example();
  trace.meshes[1].name = trace.meshes[0].name;
  EXPECT_NE(failure(trace, "trace.json").find("trace.json: cannot write the trace: two meshes are named"),
            std::string::npos);
  trace = example();
  trace.meshes[0].name = "\xff";
  EXPECT_EQ(failure(trace, "trace.json"), "trace.json: cannot write the trace: a mesh's name is not UTF-8");
  trace = example();
  trace.meshes[0].colors.pop_back();
  EXPECT_NE(failure(trace, "trace.json").find("lacks colours"), std::string::npos);
  trace = example();
  trace.frames[0].draws[0].mesh = 2;
  EXPECT_EQ(failure(trace, "trace.json"), "trace.json: cannot write the trace: a draw names no mesh");
  trace.frames.clear();
  EXPECT_EQ(failure(trace, "trace.json"), "trace.json: cannot write the trace: it has no frame");
  // The old file is still there, and no other file.
  EXPECT_EQ(read("trace.json"), "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(TraceWriterTest, ReplacesRegularFilesOnly) {
  std::filesystem::create_directory(path("folder"));
  EXPECT_EQ(failure(example(), "folder"), "folder: expected a regular file or none, found something else");
  EXPECT_EQ(failure(example(), "no/such/folder.json"),
            "no/such/folder.json: cannot create a file beside it: No such file or directory");
  write("trace.json", "old");
  EXPECT_EQ(failure(example(), "trace.json"), "no error");
  EXPECT_EQ(read("trace.json").substr(0, 19), "{\"beampipe_trace\": ");
}

}  // namespace
}  // namespace beampipe

#include "tests/traces/difference.h"
#include "tests/traces/test_folder.h"

namespace beampipe::trace_writer_test {

// Values that are drawn by lot.
class Lot {
 public:
  explicit Lot(unsigned seed) : bits_(seed) {}

  bool chance() { return bits_() % 2 == 0; }
  std::uint32_t below(std::size_t count) { return static_cast<std::uint32_t>(bits_() % count); }
  std::uint32_t word() { return static_cast<std::uint32_t>(bits_()); }
  // Any finite number, from the subnormal ones to the largest.
  template <typename Float, typename Bits>
  Float any_finite() {
    for (;;)
      if (const Float value = std::bit_cast<Float>(static_cast<Bits>(bits_())); std::isfinite(value)) return value;
  }
  float any_float() { return any_finite<float, std::uint32_t>(); }
  double any_double() { return any_finite<double, std::uint64_t>(); }
  // From 0 to `most`.
  float any_up_to(float most) {
    for (;;)
      if (const float value = std::abs(any_float()); value <= most) return value;
  }
  float fraction() { return static_cast<float>(bits_() >> 40) * 0x1p-24f; }
  float number() { return static_cast<float>(bits_() % 2001) / 1000 - 1; }
  glm::vec3 color() { return {any_up_to(kMostColor), any_up_to(kMostColor), any_up_to(kMostColor)}; }
  glm::vec4 rgba() { return {color(), fraction()}; }
  glm::vec3 direction() { return glm::normalize(glm::vec3(fraction() - 0.5f, fraction() - 0.5f, fraction() - 0.51f)); }
  glm::dmat4 matrix() {
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = any_double();
    return m;
  }
  std::vector<std::uint8_t> bytes(std::size_t count) {
    std::vector<std::uint8_t> result(count);
    for (std::uint8_t& byte : result) byte = static_cast<std::uint8_t>(bits_());
    return result;
  }

 private:
  std::mt19937_64 bits_;
};

Trace example() {
  Lot lot(7);
  Mesh mesh;
  mesh.name = "a \"mesh\"/with ~ odd\nname é";
  for (int i = 0; i < 20000; ++i) mesh.positions.emplace_back(lot.any_float(), lot.any_float(), lot.any_float());
  for (std::uint32_t i = 0; i + 2 < mesh.positions.size(); ++i) {
    mesh.triangles.emplace_back(i, i + 1, i + 2);
    mesh.colors.push_back(lot.color());
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
  frame.view = lot.matrix();
  frame.projection = lot.matrix();
  frame.view[2][1] = -0.0;
  frame.draws = {{0, lot.matrix(), lot.color(), Cull::back, Shading::unlit, {}},
                 {1, glm::dmat4(1.0), {}, Cull::front, Shading::unlit, {}}};
  trace.frames.push_back(frame);

  set_camera(frame, {.eye = {0.1, 0.2, 1.0 / 3},
                     .target = {-5, 6, 7.7},
                     .up = {0.01, 1, 0},
                     .fovy_deg = 35.9,
                     .near = 1e-3,
                     .far = 12345.678});
  frame.background = lot.color();
  frame.draws = {{0, glm::dmat4(1.0), {}, Cull::none, Shading::lambert, {}}};
  for (int i = 0; i < 50; ++i) {  // reading must give back normalised directions bit by bit
    frame.lighting.lights = {
        {glm::normalize(glm::vec3(static_cast<float>(lot.below(1000)) - 499.5f, 1.0f, 2.0f + static_cast<float>(i)))}};
    trace.frames.push_back(frame);
  }
  return trace;
}

Material material_named(const std::string& name) {
  Material material;
  material.name = name;
  return material;
}

// A trace of version 2 in which everything is drawn by lot, what is left out too.
Trace random_surfaces(unsigned seed) {
  Lot lot(seed);
  Trace trace;
  for (std::uint32_t i = 0; i < 1 + seed % 3; ++i) {
    TextureImage image{
        .name = "image/" + std::to_string(i), .width = 1 + lot.below(9), .height = 1 + lot.below(9), .texels = {}};
    for (std::uint32_t k = 0; k < image.width * image.height; ++k)
      image.texels.emplace_back(lot.below(256), lot.below(256), lot.below(256), lot.below(256));
    trace.images.push_back(image);
  }
  for (int i = 0; i < 8; ++i) {
    Material material = material_named("material " + std::to_string(i));
    if (lot.chance()) material.base_color = lot.rgba();
    if (lot.chance()) material.metallic = lot.chance() ? -0.0f : lot.fraction();
    if (lot.chance()) material.roughness = lot.fraction();
    if (lot.chance()) material.normal_scale = (lot.chance() ? 1.0f : -1.0f) * lot.any_up_to(kMostNormalScale);
    if (lot.chance()) material.emissive = lot.chance() ? glm::vec3(-0.0f) : lot.color();
    material.alpha_mode = AlphaMode(lot.below(3));
    if (lot.chance()) material.alpha_cutoff = lot.fraction();
    material.double_sided = lot.chance();
    material.unlit = lot.chance();
    for (const TextureSlot& slot : kTextureSlots) {
      if (i == 0 || lot.chance()) continue;  // one material needs no texture coordinates
      material.*slot.texture = Texture{.image = lot.below(trace.images.size()),
                                       .uv_set = lot.below(2),
                                       .wrap_u = Wrap(lot.below(3)),
                                       .wrap_v = Wrap(lot.below(3)),
                                       .magnify = Filter(lot.below(2)),
                                       .minify = Filter(lot.below(2)),
                                       .mip = MipFilter(lot.below(3)),
                                       .anisotropy = 1 + lot.below(16)};
    }
    trace.materials.push_back(material);
  }
  for (int i = 0; i < 4; ++i) {
    Mesh mesh;
    mesh.name = "mesh " + std::to_string(i);
    const std::size_t positions = 3 + lot.below(20);
    const bool has_uvs = lot.chance(), has_normals = lot.chance(), has_tangents = lot.chance(),
               has_colors = lot.chance();
    for (std::size_t k = 0; k < positions; ++k) {
      mesh.positions.emplace_back(lot.any_float(), lot.any_float(), lot.any_float());
      if (has_normals) mesh.normals.push_back(lot.direction());
      if (has_tangents) mesh.tangents.emplace_back(lot.direction(), lot.chance() ? 1.0f : -1.0f);
      if (has_colors) mesh.vertex_colors.push_back(lot.rgba());
      for (auto& uvs : mesh.uvs)
        if (has_uvs) uvs.emplace_back(lot.any_float(), lot.any_float());
    }
    const int kind = i;  // no material, one for all triangles, several, several among flat triangles
    for (std::uint32_t k = 0; k < 1 + lot.below(20); ++k) {
      mesh.triangles.emplace_back(lot.below(positions), lot.below(positions), lot.below(positions));
      mesh.colors.push_back(seed % 2 == 0 ? kDefaultColor : lot.color());
      const std::uint32_t material = has_uvs ? lot.below(trace.materials.size()) : 0;
      if (kind > 0) mesh.materials.push_back(kind == 1 ? 0 : kind == 3 && lot.chance() ? kNoMaterial : material);
    }
    trace.meshes.push_back(mesh);
  }
  Frame frame;
  frame.width = frame.height = 1 + lot.below(100);
  for (std::uint32_t i = 0; i < seed % (kMostLights + 1); ++i) {
    frame.lighting.lights.push_back({.direction = lot.direction()});
    if (lot.chance()) frame.lighting.lights.back().color = lot.color();
  }
  if (lot.chance()) frame.lighting.ambient = {.sky = lot.color(), .ground = lot.color(), .up = lot.direction()};
  for (std::uint32_t i = 0; i < 6; ++i) {
    Draw draw;
    draw.mesh = lot.below(trace.meshes.size());
    if (lot.chance()) {
      draw.material = trace.meshes[draw.mesh].uvs[0].empty() ? 0 : lot.below(trace.materials.size());
    } else if (lot.chance()) {
      draw.kd = lot.color();
    }
    frame.draws.push_back(draw);
  }
  trace.frames = {frame};
  return trace;
}

// State of a draw, of which each item is the default or not.
DrawState random_state(Lot& lot) {
  const auto compare = [&] { return Compare(lot.below(8)); };
  const auto operation = [&] { return StencilOperation(lot.below(8)); };
  DrawState state;
  if (lot.chance()) state.viewport = {lot.number(), lot.number(), 1 + std::abs(lot.number()), 1.5f + lot.number()};
  if (lot.chance()) state.scissor = {static_cast<int>(lot.below(100)) - 50, 3, lot.below(9), lot.below(9)};
  state.depth = {.test = lot.chance(), .write = lot.chance(), .function = compare(), .clip = lot.chance()};
  if (lot.chance()) state.depth.near = std::abs(lot.number());
  if (lot.chance()) state.depth.far = std::abs(lot.number());
  if (lot.chance()) state.depth.bias = {lot.number(), lot.chance() ? lot.number() : 0.0f, lot.number()};
  state.depth.cleared_before = lot.chance();
  state.front_is_clockwise = lot.chance();
  const auto equation = [&] {
    return BlendEquation{BlendFactor(lot.below(15)), BlendFactor(lot.below(15)), BlendOperation(lot.below(5))};
  };
  if (lot.chance()) state.blend = Blend{.color = equation()};
  if (state.blend && lot.chance()) state.blend->alpha = equation();
  if (state.blend && lot.chance()) state.blend->constant = {0.5f, 0, 1, std::abs(lot.number())};
  if (lot.chance()) state.color_mask = lot.below(16);
  state.alpha_to_coverage = lot.chance();
  for (std::optional<Stencil>* const face : {&state.stencil, &state.stencil_back})
    if (lot.chance())
      *face = {compare(), lot.below(256), lot.below(256), lot.below(256), operation(), operation(), operation()};
  if (lot.chance()) state.stencil_cleared_to = lot.below(256);
  return state;
}

// A frame as it is captured from a program.
Trace random_capture(unsigned seed) {
  Lot lot(seed + 1000);
  Trace trace = random_surfaces(seed);
  for (Mesh& mesh : trace.meshes)
    if (lot.chance())
      for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.ws.push_back(static_cast<float>(lot.below(100)) / 10 - 5);
  trace.source = {.program = "a \"program\"",
                  .api = "OpenGL",
                  .driver = "",
                  .date = "2026-01-02",
                  .tool = "",
                  .shading = "vertex colours"};
  if (seed % 2 == 0) trace.source->frame = seed;
  Frame& frame = trace.frames[0];
  frame.width = 3;
  frame.height = 2;
  if (lot.chance()) frame.background_alpha = 0.25f;
  for (Draw& draw : frame.draws) draw.state = random_state(lot);
  frame.capture.passes = {{"shadow map", 512, 512, 3, 99, false, "not shown"}, {"main", 3, 2, 6, 12, true, ""}};
  frame.capture.left_out = {{"lines", 2, 40}};
  trace.images.push_back({.name = "captured", .width = 3, .height = 2, .texels = {6, glm::u8vec4(7)}});
  if (lot.chance()) frame.capture.pictures.color = static_cast<std::uint32_t>(trace.images.size() - 1);
  if (lot.chance()) frame.capture.pictures.depth = {0, 0.25f, 0.5f, 0.1f, 1, 1};
  if (lot.chance()) frame.capture.pictures.clear_depth = 0;
  if (lot.chance()) frame.capture.pictures.samples = 4;
  return trace;
}

// A frame as it is captured, with the program's own shaders.
Trace random_programs(unsigned seed) {
  Lot lot(seed + 2000);
  Trace trace = random_capture(seed);
  for (std::uint32_t i = 0; i < 15; ++i) {  // every format
    ProgramImage image{.name = "image", .shape = ImageShape(lot.below(4)), .format = TexelFormat(i), .texels = {}};
    image.width = 1 + lot.below(5);
    image.array = image.shape != ImageShape::d3 && lot.chance();
    const bool is_cube = image.shape == ImageShape::cube;
    image.height = is_cube ? image.width : image.shape == ImageShape::d1 ? 1 : 1 + lot.below(5);
    image.depth = image.shape == ImageShape::d3 ? 1 + lot.below(3) : 1;
    image.layers = (image.array ? 1 + lot.below(3) : 1) * (is_cube ? 6 : 1);
    image.levels = image.width > 1 && lot.chance() ? 2 : 1;
    image.texels = lot.bytes(level_start(image, image.levels));
    trace.program_images.push_back(image);
  }
  for (int i = 0; i < 4; ++i) {
    ProgramSampler sampler;
    sampler.mag = Filter(lot.below(2)), sampler.min = Filter(lot.below(2)), sampler.mip = Filter(lot.below(2));
    for (SamplerWrap& wrap : sampler.wrap) wrap = SamplerWrap(lot.below(5));
    if (lot.chance())
      sampler.lod_bias = lot.number(), sampler.least_lod = lot.number(), sampler.most_lod = lot.number();
    if (lot.chance()) sampler.anisotropy = 1 + static_cast<float>(lot.below(16));
    if (lot.chance()) sampler.compare = Compare(lot.below(8));
    if (lot.chance()) sampler.border = {lot.number(), 0.0f, lot.number(), -0.0f};
    sampler.unnormalized = lot.chance();
    trace.program_samplers.push_back(sampler);
  }
  // Programs of the same inputs, which all meshes have.
  std::vector<ProgramInput> inputs;
  for (std::uint32_t i = 0; i < lot.below(4); ++i)
    inputs.push_back({.location = i,
                      .component = lot.below(2),
                      .count = 1 + lot.below(3),
                      .interpolation = InputInterpolation(lot.below(3)),
                      .integer = lot.chance()});
  for (std::size_t i = 0; i < 2; ++i) {
    ShaderProgram program{.name = "program " + std::to_string(i), .spirv = {}, .specialization = {}, .inputs = inputs};
    for (std::size_t k = 0; k < lot.below(9); ++k) program.spirv.push_back(lot.word());
    if (lot.chance()) program.specialization = {{.id = lot.word(), .bits = lot.word()}, {.id = 0, .bits = ~0u}};
    trace.programs.push_back(program);
  }
  const bool are_numbers = lot.chance();
  for (Mesh& mesh : trace.meshes)
    for (std::size_t i = 0; i < varyings_of(trace.programs[0]) * mesh.positions.size(); ++i)
      mesh.varyings.push_back(are_numbers ? std::bit_cast<std::uint32_t>(lot.number()) : lot.word());
  Frame& frame = trace.frames[0];
  frame.target = ColorTarget(lot.below(3));
  for (Draw& draw : frame.draws) {
    if (draw.kd || draw.material) continue;
    ProgramUse& use = draw.program.emplace();
    use.program = lot.below(2);
    if (lot.chance()) use.push_constants = lot.bytes(lot.below(9));
    for (std::uint32_t i = 0; i < lot.below(3); ++i)
      use.buffers.push_back(
          {.set = lot.below(2), .binding = i, .element = lot.below(2), .bytes = lot.bytes(lot.below(9))});
    for (std::uint32_t i = 0; i < lot.below(3); ++i) {
      BoundImage image{.set = lot.below(2), .binding = i, .element = lot.below(2)};
      if (lot.chance()) image.image = lot.below(15);
      if (!image.image || lot.chance()) image.sampler = lot.below(4);
      if (lot.chance()) image.swizzle = "b0a1";
      if (image.image && lot.chance()) image.levels = image.layers = 1;
      if (image.image) image.base_level = trace.program_images[*image.image].levels - 1;
      use.images.push_back(image);
    }
  }
  return trace;
}

// A frame, a mesh with one triangle, and what `add` adds.
template <class Add>
Trace small_trace(Add add) {
  Trace trace;
  trace.meshes.resize(1);
  trace.meshes[0].name = "m";
  trace.meshes[0].positions.resize(1);
  trace.meshes[0].triangles.resize(1);
  trace.meshes[0].colors = {kDefaultColor};
  trace.frames.resize(1);
  trace.frames[0].width = trace.frames[0].height = 1;
  trace.frames[0].draws.resize(1);
  add(trace);
  return trace;
}

class TraceWriterTest : public FolderTest {
 protected:
  // The message of any runtime_error.
  std::string failure(const Trace& trace, const std::string& name, ArrayStorage storage = ArrayStorage::text) const {
    return without_folder(message_of<std::runtime_error>([&] { write_trace(trace, path(name), storage); }));
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path("")), {}));
  }
};

TEST_F(TraceWriterTest, ReadsBackTheSameBits) {
  const Trace trace = example();
  write_trace(trace, path("trace.json"));
  const Trace back = read_trace(path("trace.json"));
  EXPECT_EQ(difference(trace, back), "");
  EXPECT_EQ(read("trace.json").substr(0, 21), "{\"beampipe_trace\": 1,");

  write_trace(back, path("again.json"));
  EXPECT_EQ(read("trace.json"), read("again.json"));
  EXPECT_EQ(files(), 2u);
}

// Surfaces alone and frames as they are captured, with programs and without, as text and with binary arrays.
TEST_F(TraceWriterTest, ReadsBackTheSameSurfacesAndCaptures) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Trace trace = seed % 2 == 0   ? random_surfaces(seed / 2)
                        : seed % 8 == 1 ? random_capture(seed / 2)
                                        : random_programs(seed / 2);
    for (const ArrayStorage storage : {ArrayStorage::text, ArrayStorage::binary}) {
      write_trace(trace, path("trace.json"), storage);
      EXPECT_EQ(read("trace.json").substr(0, 21), "{\"beampipe_trace\": 2,");
      const Trace back = read_trace(path("trace.json"));
      EXPECT_EQ(difference(trace, back), "");
      write_trace(back, path("again.json"), ArrayStorage::text);
      EXPECT_EQ(difference(trace, read_trace(path("again.json"))), "");
      if (storage == ArrayStorage::text) {
        EXPECT_EQ(read("trace.json"), read("again.json"));
      }
    }
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
}

TEST_F(TraceWriterTest, BinaryArraysTakeFewBytes) {
  Trace trace = small_trace([](Trace& t) {
    t.meshes[0].positions.resize(1000);
    t.meshes[0].triangles.resize(2000);
    t.meshes[0].colors.assign(2000, glm::vec3(0.5f));
  });
  write_trace(trace, path("trace.json"), ArrayStorage::binary);
  EXPECT_EQ(std::filesystem::file_size(path("trace.bin")), 1000 * 12 + 2000 * 6 + 2000 * 12);
  trace.meshes[0].positions.resize(70000);
  trace.meshes[0].triangles[7].y = 65536;
  write_trace(trace, path("trace.json"), ArrayStorage::binary);
  EXPECT_EQ(std::filesystem::file_size(path("trace.bin")), 70000 * 12 + 2000 * 12 + 2000 * 12);
  EXPECT_EQ(difference(trace, read_trace(path("trace.json"))), "");
}

TEST_F(TraceWriterTest, BinaryArraysNeedANameOfTheirOwn) {
  write("trace.bin", "old");
  EXPECT_EQ(failure(example(), "trace.bin", ArrayStorage::binary),
            "trace.bin: cannot write the trace: its name ends in .bin, as that of the binary file beside it would");
  EXPECT_EQ(read("trace.bin"), "old");
  EXPECT_EQ(files(), 1u);
}

const char kMatrices[] = R"(
"view": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],
"projection": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],)";

TEST_F(TraceWriterTest, WritesVersion1WhereThatIsEnough) {
  write_trace(small_trace([](Trace& trace) { trace.frames[0].lighting.lights.resize(1); }), path("trace.json"));
  EXPECT_EQ(read("trace.json"), R"({"beampipe_trace": 1,
"meshes": {
"m": {"positions": [0,0,0],
"indices": [0,0,0],
"colors": [0.8,0.8,0.8]}},
"frames": [
{"width": 1, "height": 1, "background": [0,0,0],)" +
                                    std::string(kMatrices) + R"(
"light": {"direction": [0,0,-1]},
"draws": [
{"mesh": "m"}]}]}
)");
}

TEST_F(TraceWriterTest, WritesVersion2WhereAnythingNeedsIt) {
  const std::function<void(Trace&)> additions[] = {
      [](Trace& trace) { trace.images.push_back({.name = "i", .width = 1, .height = 1, .texels = {glm::u8vec4(1)}}); },
      [](Trace& trace) { trace.materials.resize(1); },
      [](Trace& trace) { trace.meshes[0].materials = {kNoMaterial}; },
      [](Trace& trace) { trace.meshes[0].normals.emplace_back(0, 0, 1); },
      [](Trace& trace) { trace.meshes[0].tangents.emplace_back(0, 0, 1, 1); },
      [](Trace& trace) { trace.meshes[0].uvs[0].resize(1); },
      [](Trace& trace) { trace.meshes[0].uvs[1].resize(1); },
      [](Trace& trace) { trace.meshes[0].vertex_colors.emplace_back(0, 0, 0, 1); },
      [](Trace& trace) { trace.frames[0].lighting.lights.resize(2); },
      [](Trace& trace) { trace.frames[0].lighting.lights.resize(1), trace.frames[0].lighting.lights[0].color.b = 0; },
      [](Trace& trace) { trace.frames[0].lighting.ambient.emplace(); },
      [](Trace& trace) { trace.meshes[0].ws = {2}; },
      [](Trace& trace) { trace.frames[0].draws[0].state.depth.test = false; },
      [](Trace& trace) { trace.frames[0].target = ColorTarget::unorm; },
      [](Trace& trace) { trace.meshes[0].varyings = {1}; },
      [](Trace& trace) { trace.programs.resize(1), trace.frames[0].draws[0].program.emplace(); },
      [](Trace& trace) { trace.program_samplers.resize(1); },
      [](Trace& trace) { trace.frames[0].capture.left_out.resize(1); },
      [](Trace& trace) { trace.source.emplace(); },
  };
  for (const auto& add : additions) {
    write_trace(small_trace(add), path("trace.json"));
    EXPECT_EQ(read("trace.json").substr(0, 21), "{\"beampipe_trace\": 2,");
    EXPECT_EQ(difference(small_trace(add), read_trace(path("trace.json"))), "");
  }
}

TEST_F(TraceWriterTest, LeavesOutWhatReadersAssume) {
  const Trace trace = small_trace([](Trace& t) {
    t.materials = {material_named("plain"), material_named("flat")};
    t.materials[1].metallic = 0.5f;
    t.materials[1].unlit = true;
    t.meshes[0].materials = {1};
    t.frames[0].lighting.lights.resize(1);
    t.frames[0].draws[0].material = 0;
  });
  write_trace(trace, path("trace.json"));
  EXPECT_EQ(read("trace.json"), R"({"beampipe_trace": 2,
"materials": {
"plain": {},
"flat": {"metallic": 0.5, "unlit": true}},
"meshes": {
"m": {"positions": [0,0,0],
"indices": [0,0,0],
"materials": ["flat"]}},
"frames": [
{"width": 1, "height": 1, "background": [0,0,0],)" +
                                    std::string(kMatrices) + R"(
"lights": [
{"direction": [0,0,-1]}],
"draws": [
{"mesh": "m", "material": "plain"}]}]}
)");
}

TEST_F(TraceWriterTest, RefusesWhatNoReaderWouldTake) {
  const std::pair<std::function<void(Trace&)>, const char*> cases[] = {
      {[](Trace& trace) { trace.images.resize(1); }, "image \"\" has not the texels of its size"},
      {[](Trace& trace) { trace.images = {{.name = "i", .width = 2, .height = 2, .texels = {glm::u8vec4(0)}}}; },
       "image \"i\" has not the texels of its size"},
      {[](Trace& trace) { trace.materials.resize(2); }, "two materials are named \"\""},
      {[](Trace& trace) { trace.materials = {material_named("\xff")}; }, "a material's name is not UTF-8"},
      {[](Trace& trace) { trace.materials.resize(1), trace.materials[0].roughness = NAN; },
       "a number in it is not finite"},
      {[](Trace& trace) { trace.materials.resize(1), trace.materials[0].base_texture.emplace(); },
       "a texture names no image"},
      {[](Trace& trace) { trace.meshes[0].materials = {0}; }, "mesh \"m\" names no material"},
      {[](Trace& trace) { trace.meshes[0].materials.assign(2, kNoMaterial); }, "mesh \"m\" lacks materials"},
      {[](Trace& trace) { trace.meshes[0].uvs[1].resize(2); }, "mesh \"m\" lacks attributes of some positions"},
      {[](Trace& trace) { trace.meshes[0].normals.emplace_back(0, 0, 0.99f); },
       "mesh \"m\" has a normal whose length is not 1"},
      {[](Trace& trace) { trace.meshes[0].normals.emplace_back(0, 0, NAN); },
       "mesh \"m\" has a normal whose length is not 1"},
      {[](Trace& trace) { trace.meshes[0].tangents.emplace_back(0, 0, 2, 1); },
       "mesh \"m\" has a tangent whose length is not 1"},
      {[](Trace& trace) { trace.meshes[0].tangents.emplace_back(0, 0, 1, 0); },
       "mesh \"m\" has a tangent whose w is not 1 or -1"},
      {[](Trace& trace) { trace.frames[0].draws[0].material = 0; }, "a draw names no material"},
      {[](Trace& trace) {
         trace.materials.resize(1);
         trace.frames[0].draws[0].material = 0;
         trace.frames[0].draws[0].kd = {1, 1, 1};
       },
       "a draw has both kd and a material"},
      {[](Trace& trace) { trace.frames[0].draws[0].program.emplace(); }, "a draw names no program"},
      {[](Trace& trace) {
         trace.programs.resize(1);
         trace.frames[0].draws[0].program.emplace();
         trace.frames[0].draws[0].kd = {1, 1, 1};
       },
       "a draw has both a program and kd or a material"},
      {[](Trace& trace) {
         trace.programs.resize(1);
         trace.programs[0].inputs = {{.location = 0, .count = 2}};
         trace.frames[0].draws[0].program.emplace();
         trace.meshes[0].varyings = {1};
       },
       "mesh \"m\" lacks varyings of a program that draws it"},
      {[](Trace& trace) { trace.program_images.resize(1); }, "program image \"\" has not the texels of its size"},
      {[](Trace& trace) { trace.meshes[0].ws.resize(2); }, "mesh \"m\" lacks w of some positions"},
      {[](Trace& trace) { trace.frames[0].capture.pictures.color = 0; }, "a captured picture names no image"},
      {[](Trace& trace) { trace.source.emplace().program = "\xff"; }, "the program is not UTF-8"},
      {[](Trace& trace) { trace.meshes[0].positions[0].y = NAN; }, "a number in it is not finite"},
      {[](Trace& trace) { trace.meshes.push_back(trace.meshes[0]); }, "two meshes are named \"m\""},
      {[](Trace& trace) { trace.meshes[0].name = "\xff"; }, "a mesh's name is not UTF-8"},
      {[](Trace& trace) { trace.meshes[0].colors.pop_back(); }, "mesh \"m\" lacks colours"},
      {[](Trace& trace) { trace.frames[0].draws[0].mesh = 2; }, "a draw names no mesh"},
      {[](Trace& trace) { trace.frames.clear(); }, "it has no frame"},
  };
  write("trace.json", "old");
  for (const auto& [add, message] : cases) {
    EXPECT_EQ(failure(small_trace(add), "trace.json"), std::string("trace.json: cannot write the trace: ") + message);
  }
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

}  // namespace beampipe::trace_writer_test

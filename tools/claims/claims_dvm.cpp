// The tables of the article on decoupled visibility multisampling: milliseconds of passes at three densities of
// triangles, and what it derives of them.

#include <array>
#include <limits>

#include "tools/claims/claims.h"

namespace beampipe {
namespace {

constexpr const char* kSource = "DVM article, Performance";
constexpr const char* kTriangleCulling = "DVM article, Triangle Culling, Quad Utilization and MSAA";
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // the path does not have the pass

// What of ours is put beside a pass: stages. None: nothing here is that pass alone.
struct Pass {
  const char* name;
  std::vector<std::string> stages;
};
const std::array<Pass, 7> kPasses = {{{"PrePass", {}},
                                      {"Material", {"shade"}},
                                      {"Lighting", {"light"}},
                                      {"VisUtil", {"sample_select"}},
                                      {"Motion", {"motion"}},
                                      {"Resolve/TAA", {"dilate", "temporal", "resolve"}},
                                      {"Other", {}}}};

// Where visibility is drawn, the pass before all others is all of the geometry: depth and triangle ids.
const std::vector<std::string> kVisibilityPass = {"vertex_setup", "sample_raster", "depth_test"};

struct Path {
  const char* name;
  const char* spec;
  std::array<std::array<double, 8>, 3> ms;  // by density: the passes, total
};

constexpr const char* kDensities[] = {"low", "medium", "high"};

const std::array<Path, 7> kPaths = {{
    {"Forward",
     "msaa:1,prepass",
     {{{0.020, 1.600, kNone, kNone, 0.093, 0.177, 0.353, 2.243},
       {0.132, 3.881, kNone, kNone, 0.093, 0.176, 0.354, 4.636},
       {1.004, 8.987, kNone, kNone, 0.094, 0.176, 0.391, 10.652}}}},
    {"Msaa 2x",
     "msaa:2,prepass",
     {{{0.038, 1.615, kNone, kNone, 0.092, 0.075, 0.443, 2.263},
       {0.211, 4.705, kNone, kNone, 0.110, 0.083, 0.463, 5.572},
       {0.874, 15.262, kNone, kNone, 0.112, 0.099, 0.457, 16.804}}}},
    {"Msaa 4x",
     "msaa:4,prepass",
     {{{0.072, 1.648, kNone, kNone, 0.092, 0.079, 0.439, 2.330},
       {0.361, 5.649, kNone, kNone, 0.146, 0.121, 0.464, 6.741},
       {0.949, 23.261, kNone, kNone, 0.148, 0.157, 0.468, 24.983}}}},
    {"Msaa 8x",
     "msaa:8,prepass",
     {{{0.124, 1.686, kNone, kNone, 0.109, 0.251, 0.439, 2.609},
       {0.560, 6.382, kNone, kNone, 0.205, 0.252, 0.460, 7.859},
       {1.487, 27.211, kNone, kNone, 0.235, 0.257, 0.463, 29.653}}}},
    {"Deferred",
     "deferred",
     {{{0.019, 1.06, 0.753, kNone, 0.093, 0.178, 0.363, 2.466},
       {0.132, 2.942, 0.764, kNone, 0.094, 0.178, 0.363, 4.473},
       {1.006, 4.640, 0.772, kNone, 0.093, 0.221, 0.371, 7.103}}}},
    {"Visibility",
     "taa:8",
     {{{0.043, 1.239, 0.797, 0.347, 0.103, 0.176, 0.332, 3.109},
       {0.158, 1.614, 0.826, 0.466, 0.104, 0.175, 0.228, 3.645},
       {1.156, 1.696, 0.836, 0.294, 0.101, 0.175, 0.404, 4.742}}}},
    {"DVM",
     "dvm",
     {{{0.224, 1.250, 0.795, 0.719, 0.118, 0.418, 0.373, 3.989},
       {0.626, 1.618, 0.827, 0.921, 0.119, 0.420, 0.261, 4.882},
       {1.530, 1.745, 0.836, 0.965, 0.118, 0.421, 0.259, 5.968}}}},
}};

// 640 x 360 pixels: one wall with 1000, 10 and 1 pixels per triangle, and with half of one.
std::string command_of(const std::string& density) {
  const std::string triangles = density == "low"      ? "230"
                                : density == "medium" ? "23040"
                                : density == "high"   ? "230400"
                                                      : "460800";
  const std::string name = "density_" + density;
  std::string command = "beampipe make density --triangles " + triangles + " --width 640 --height 360 -o " + name +
                        ".json && beampipe run " + name + ".json";
  for (const Path& path : kPaths) command += std::string(" -t ") + path.spec;
  return command + " -o out/" + name;
}

const StageCounters* stage_of(const FrameReport* frame, const std::string& name) {
  if (!frame) return nullptr;
  for (const StageCounters& stage : frame->stages)
    if (stage.stage == name) return &stage;
  return nullptr;
}

class DvmClaims {
 public:
  DvmClaims(const Report& report, std::vector<Claim>& claims) : report_(report), claims_(claims) {}

  void add_passes(std::size_t density) {
    for (const Path& path : kPaths) {
      const auto& ms = path.ms[density];
      for (std::size_t pass = 0; pass < kPasses.size(); ++pass) {
        if (ms[pass] != ms[pass]) continue;  // not a number
        const auto& stages = stages_of(path, pass);
        const auto ours = stages.empty() ? std::nullopt : modelled_ms(report_, frame(path.spec, density), stages);
        add(density, std::string(path.name) + ", " + kPasses[pass].name, "ms", ms[pass], ours, beside(path, pass));
      }
      add(density, std::string(path.name) + ", Total", "ms", ms[7], modelled_ms(report_, frame(path.spec, density)),
          std::string("modelled, all stages one after the other, 640 x 360; the article does not tell its picture's "
                      "size") +
              (without_taa(path) ? ", and has TAA" : ""));
    }
  }

  // Shader invocations stand for the time of the forward pass.
  void add_shading_rates(std::size_t density) {
    constexpr double kOverLow[4][3] = {
        {1.00, 2.43, 5.62}, {1.01, 2.94, 9.54}, {1.03, 3.53, 14.54}, {1.05, 3.99, 17.01}};
    for (std::size_t i = 0; i < 4; ++i)
      add(density, std::string(kPaths[i].name) + ", forward pass over one invocation per pixel (Forward, low)", "",
          kOverLow[i][density], lanes_per_pixel(kPaths[i].spec, density), "shader invocations per pixel");
    if (density != 2) return;
    constexpr double kOverForward[] = {1.70, 2.59, 3.03};
    for (std::size_t i = 1; i < 4; ++i) {
      const auto one = lanes_per_pixel(kPaths[0].spec, density), many = lanes_per_pixel(kPaths[i].spec, density);
      add(density, std::string(kPaths[i].name) + ", forward pass over Forward's", "", kOverForward[i - 1],
          one && many ? std::optional<double>(*many / *one) : std::nullopt, "ratio of shader invocations");
    }
    add(density, "Forward, invocations for each one that is needed (quads)", "", 4, quads_waste(density), "");
    add(density, "cost of an invocation over one at low density", "", 1.41, std::nullopt,
        "the model has one cost for all invocations");
  }

  void add_derived(std::size_t density) {
    const FrameReport *const dvm = frame("dvm", density), *const visibility = frame("taa:8", density),
                             *const deferred = frame("deferred", density);
    const auto with = modelled_ms(report_, dvm), without = modelled_ms(report_, visibility);
    add(density, "DVM, Total less Visibility's", "ms", density == 0 ? 0.9 : 1.2,
        with && without ? std::optional<double>(*with - *without) : std::nullopt, "modelled");
    if (density == 0) {
      const auto ours = modelled_ms(report_, visibility, {"shade"}), theirs = modelled_ms(report_, deferred, {"shade"});
      add(density, "Visibility, Material over Deferred's", "", 1.17,
          ours && theirs ? std::optional<double>(*ours / *theirs) : std::nullopt, "modelled");
    }
    if (density != 2) return;
    constexpr double kBruteForce[] = {2.581, 5.162, 10.324, 20.648};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto one = modelled_ms(report_, dvm, {"shade", "light"});
      const double samples = static_cast<double>(1 << i);
      add(density, "brute-force supersampling of visibility, " + std::to_string(1 << i) + "x, Material and Lighting",
          "ms", kBruteForce[i], one ? std::optional<double>(samples * *one) : std::nullopt,
          "modelled shade and light of dvm, times the samples");
    }
  }

  // Two triangles for each pixel.
  void add_half() {
    const std::string scene = "density_half";
    for (const auto& [spec, published] : {std::pair{"msaa:1,prepass", 4.0}, std::pair{"msaa:8,prepass", 8.0}}) {
      std::optional<double> ours;
      if (scene_of(report_) == scene) ours = lanes_per_pixel(first_frame(report_, spec));
      claims_.push_back({std::string("two triangles per pixel, ") + spec + ", invocations per pixel", "", published,
                         published == 8 ? std::numeric_limits<double>::infinity() : published, ours, kTriangleCulling,
                         command_of("half"), ""});
    }
    const StageCounters* const raster =
        scene_of(report_) == scene ? stage_of(first_frame(report_, "msaa:1,prepass"), "sample_raster") : nullptr;
    std::optional<double> culled;
    if (raster && raster->items_in > 0)
      culled = 1 - static_cast<double>(raster->items_out) / static_cast<double>(raster->items_in);
    claims_.push_back(
        {"two triangles per pixel, part of the triangles that cover no pixel's centre", "", 0.5, 0.5, culled,
         kTriangleCulling, command_of("half"),
         "1 - (pixel, triangle) pairs over triangles: a triangle of that size covers one centre or none"});
  }

 private:
  const FrameReport* frame(const char* spec, std::size_t density) const {
    if (scene_of(report_) != std::string("density_") + kDensities[density]) return nullptr;
    return first_frame(report_, spec);
  }

  std::optional<double> lanes_per_pixel(const FrameReport* frame) const {
    const StageCounters* const shade = stage_of(frame, "shade");
    if (!shade || frame->pixels == 0) return {};
    return static_cast<double>(shade->lanes_issued) / static_cast<double>(frame->pixels);
  }
  std::optional<double> lanes_per_pixel(const char* spec, std::size_t density) const {
    return lanes_per_pixel(frame(spec, density));
  }
  std::optional<double> quads_waste(std::size_t density) const {
    const StageCounters* const shade = stage_of(frame("msaa:1,prepass", density), "shade");
    if (!shade || shade->lanes_used == 0) return {};
    return static_cast<double>(shade->lanes_issued) / static_cast<double>(shade->lanes_used);
  }

  static const std::vector<std::string>& stages_of(const Path& path, std::size_t pass) {
    const std::string spec = path.spec;
    return pass == 0 && (spec == "taa:8" || spec == "dvm") ? kVisibilityPass : kPasses[pass].stages;
  }

  // The article has TAA where it takes one sample.
  static bool without_taa(const Path& path) {
    const std::string spec = path.spec;
    return spec == "msaa:1,prepass" || spec == "deferred";
  }

  static std::string beside(const Path& path, std::size_t pass) {
    const auto& stages = stages_of(path, pass);
    if (stages.empty())
      return pass == 0 ? "none: this depth pass is not counted apart from the shading pass"
                       : "none: copies, tone mapping and user interface";
    std::string names;
    for (const std::string& stage : stages) names += (names.empty() ? "" : ", ") + stage;
    const std::string spec = path.spec;
    if (pass == 4 && (spec.starts_with("msaa") || spec == "deferred"))
      return "none: " + spec + " makes no motion vectors here";
    if (pass == 3 && spec != "dvm") return "none: materials are not sorted here, nor samples chosen";
    if (pass == 5 && without_taa(path)) return "modelled, resolve alone, 640 x 360; the article's is with TAA";
    return "modelled, " + names + ", 640 x 360";
  }

  void add(std::size_t density, const std::string& name, const char* unit, double published, std::optional<double> ours,
           const std::string& beside) {
    claims_.push_back({std::string(kDensities[density]) + " density, " + name, unit, published, published, ours,
                       kSource, command_of(kDensities[density]), beside});
  }

  const Report& report_;
  std::vector<Claim>& claims_;
};

}  // namespace

void add_dvm_claims(const Report& report, std::vector<Claim>& claims) {
  DvmClaims dvm(report, claims);
  for (std::size_t density = 0; density < 3; ++density) {
    dvm.add_passes(density);
    dvm.add_shading_rates(density);
    dvm.add_derived(density);
  }
  dvm.add_half();
}

}  // namespace beampipe

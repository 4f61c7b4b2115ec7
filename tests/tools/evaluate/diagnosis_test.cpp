// compare --causes, compare --orders, make --pan and flicker, with the built program.
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tools/evaluate/metrics.h"
#include "tools/files/image_io.h"

namespace beampipe::diagnosis_test {

using Json = nlohmann::ordered_json;

class DiagnosisTest : public RunInFolder {
 protected:
  Json report() const { return Json::parse(read_text(folder_ / "out/report.json")); }

  // Two quads in the same place, first a red one and then a green one, and a blue triangle across them.
  void write_coincident() {
    write_text(folder_ / "trace.json", R"({"beampipe_trace": 1,
      "meshes": {"faces": {"positions": [-0.9,-0.8,0, 0.7,-0.8,0, 0.7,0.9,0, -0.9,0.9,0, -1,0,-0.5, 1,0.1,0.5, 0,1,0.5],
                           "indices": [0,1,2, 0,2,3, 0,1,2, 0,2,3, 4,5,6],
                           "colors": [1,0,0, 1,0,0, 0,1,0, 0,1,0, 0,0,1]}},
      "frames": [{"width": 20, "height": 12, "background": [0.5,0.5,0.5], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                  "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "faces"}]}]})");
  }
};

TEST_F(DiagnosisTest, CausesAddUpToTheErrorLayerAndToOne) {
  write_coincident();
  const std::string table = succeed(
      {"compare", path("trace.json"), "-t", "casav", "msaa:2", "--causes", "--ladder", "1,64", "-o", path("out")});
  const Json json = report();
  const Planes planes = read_exr_planes(folder_ / "out/casav/frame_0000_counters.exr");
  std::map<std::string, double> squares;
  double all = 0;
  const std::vector<float>& error = planes.channels.at("error");
  for (std::size_t i = 0; i < error.size(); ++i) {
    double sum = 0;
    for (const auto& [name, values] : planes.channels) {
      if (!name.starts_with("cause_")) continue;
      sum += values[i];
      squares[name.substr(6)] += double{values[i]} * error[i];
    }
    ASSERT_NEAR(sum, error[i], 1e-5);
    all += double{error[i]} * error[i];
  }
  ASSERT_EQ(squares.size(), 7u);
  double parts = 0;
  for (const auto& [cause, square] : squares) {
    const double reported = json["results"][0]["error_causes"][cause];
    EXPECT_NEAR(reported, square / all, 1e-6) << cause;
    parts += reported;
  }
  EXPECT_NEAR(parts, 1.0, 1e-4);
  EXPECT_FALSE(json["results"][1].contains("error_causes")) << "msaa reports no weights";
  expect_parts(table,
               {"interpenetration", "record no weights of triangles, so --causes cannot split their errors: msaa:2\n"});
}

TEST_F(DiagnosisTest, OrdersDifferWhereFacesCoincide) {
  write_coincident();
  const std::string table =
      succeed({"compare", path("trace.json"), "-t", "msaa:4", "--orders", "--ladder", "1,64", "-o", path("out")});
  const Json json = report();
  for (const Json& result : json["results"]) {
    const Json& orders = result["orders"];
    for (const char* order : {"given", "shuffled", "near_to_far", "far_to_near"}) EXPECT_TRUE(orders.contains(order));
    EXPECT_GT(orders["largest_difference"], 0.1) << "either the red or the green quad is visible";
  }
  EXPECT_EQ(json["results"][0]["orders"]["given"]["rmse"], json["results"][0]["error"]["rmse"]);
  EXPECT_LT(json["results"][0]["orders"]["shuffled"]["rmse"], 0.1) << "against the reference in the same order";
  EXPECT_EQ(json["results"][1]["orders"]["shuffled"]["rmse"], 0.0);
  expect_parts(table, {"far_to_near"});
}

TEST_F(DiagnosisTest, PanMovesThePictureByWholePixelsToo) {
  succeed({"make", "fence", "--triangles", "2000", "--width", "24", "--height", "16", "--frames", "3", "--pan", "2,1",
           "-o", path("pan.json")});
  succeed({"compare", path("pan.json"), "-t", "msaa:8", "--ladder", "1,8", "-o", path("out")});
  const Image before = read_exr(folder_ / "out/msaa_8/frame_0000.exr");
  const Image after = read_exr(folder_ / "out/msaa_8/frame_0001.exr");
  std::size_t equal = 0, all = 0;
  for (std::size_t y = 0; y + 1 < 16; ++y)
    for (std::size_t x = 0; x + 2 < 24; ++x, ++all) {
      const float* from = &before.rgba[4 * (y * 24 + x)];
      const float* to = &after.rgba[4 * ((y + 1) * 24 + x + 2)];
      equal += std::abs(from[0] - to[0]) < 0.05f && std::abs(from[1] - to[1]) < 0.05f;
    }
  EXPECT_GT(equal, all * 9 / 10) << "except where vertices snap differently";

  const Json result = report()["results"][0];
  double squares = 0;
  for (const std::size_t frame : {1u, 2u}) squares += std::pow(double(result["frames"][frame]["flicker"]), 2);
  EXPECT_NEAR(result["flicker"], std::sqrt(squares / 2), 1e-9);
}

}  // namespace beampipe::diagnosis_test

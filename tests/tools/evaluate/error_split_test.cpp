// The error's two parts, visibility and shading: by hand, and as compare finds them.
#include "tools/evaluate/error_split.h"

#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/tools/varying_trace.h"
#include "tools/files/image_io.h"

namespace beampipe::error_split_test {

using Json = nlohmann::ordered_json;

Image row_of(const std::vector<glm::vec3>& pixels) {
  Image image{static_cast<std::uint32_t>(pixels.size()), 1, {}};
  for (const glm::vec3& pixel : pixels) image.rgba.insert(image.rgba.end(), {pixel.r, pixel.g, pixel.b, 1.0f});
  return image;
}

TEST(SplitError, PartsOfEachValueAddUpToItsError) {
  const Image image = row_of({{1, 1, 1}, {0.5f, 0.5f, 0.5f}}), reference = row_of({{0.5f, 0, 1}, {0.5f, 0.5f, 0.5f}});
  const Image image_by_pixel = row_of({{0.75f, 1, 0}, {1, 1, 0}}),
              reference_by_pixel = row_of({{0.25f, 1, 0}, {0, 1, 0}});
  std::map<std::string, std::vector<float>> layers;
  const ErrorParts parts = split_error({image, reference}, {image_by_pixel, reference_by_pixel}, layers);
  // Errors: (0.5, 1, 0) and (0, 0, 0). In visibility: (0.5, 0, 0) and (1, 0, 0). In shading: (0, 1, 0) and (-1, 0, 0).
  EXPECT_NEAR(parts.visibility, std::sqrt(1.25 / 6), 1e-12);
  EXPECT_NEAR(parts.shading, std::sqrt(2.0 / 6), 1e-12);
  const std::vector<float> visibility = layers.at("visibility_error"), shading = layers.at("shading_error");
  ASSERT_EQ(visibility.size(), 2u);
  EXPECT_FLOAT_EQ(visibility[0], static_cast<float>(std::sqrt(0.25 / 3)));
  EXPECT_FLOAT_EQ(visibility[1], static_cast<float>(std::sqrt(1.0 / 3)));
  EXPECT_FLOAT_EQ(shading[0], static_cast<float>(std::sqrt(1.0 / 3)));
  EXPECT_FLOAT_EQ(shading[1], static_cast<float>(std::sqrt(1.0 / 3)));
}

TEST(SplitError, LargeFramesCountForMore) {
  FrameReport small, large;
  small.pixels = 100, small.parts = {0.3, 0};
  large.pixels = 300, large.parts = {0.1, 0.2};
  FrameReports frames;
  for (const FrameReport& frame : {small, large}) frames.push_back(frame);
  EXPECT_NEAR(pooled_parts(frames).visibility, std::sqrt((9.0 + 3 * 1.0) / 400), 1e-12);
  EXPECT_NEAR(pooled_parts(frames).shading, std::sqrt(3 * 4.0 / 400), 1e-12);
}

class ErrorSplitTest : public RunInFolder {
 protected:
  // The report of a comparison of trace.json.
  Json compare(const Names& arguments) {
    table_ = finish(joined({"compare", path("trace.json"), "-o", path("out"), "--threads", "2", "-t"}, arguments)).out;
    return Json::parse(read_text(folder_ / "out/report.json"));
  }

  std::map<std::string, std::vector<float>> layers(const std::string& technique, int frame = 0) const {
    return read_exr_planes(folder_ / "out" / technique / ("frame_000" + std::to_string(frame) + "_counters.exr"))
        .channels;
  }

  std::string table_;  // what the program printed
};

// As expected of reports about flat traces: nowhere a word about the parts.
void expect_no_parts(const Json& json) {
  for (const char* key : {"visibility", "shading", "visibility_error", "shading_error", "visibility_msaa_ladder"})
    EXPECT_FALSE(json.is_object() && json.contains(key)) << key;
  for (const Json& child : json)
    if (child.is_structured()) expect_no_parts(child);
}

TEST_F(ErrorSplitTest, FlatTracesHaveNoParts) {
  write_varying_trace(folder_, {R"({"mesh": "flat"}, {"mesh": "wall", "kd": [1, 0, 0]})"});  // kd makes the wall flat
  expect_no_parts(compare({"beam", "msaa:2", "--ladder", "1,4", "--causes"}));
  EXPECT_EQ(table_.find("shading"), std::string::npos);
  EXPECT_FALSE(layers("msaa_2").contains("shading_error"));
  finish({"report", path("out")});
}

TEST_F(ErrorSplitTest, OneSurfaceAllOverThePictureHasErrorsOfShadingAlone) {
  write_varying_trace(folder_, {R"({"mesh": "wall"})"});
  const Json json = compare({"msaa:1", "msaa:8", "beam", "deferred", "--ladder", "1,32"});
  for (const Json& result : json["results"]) {
    SCOPED_TRACE(result["technique"]);
    const double whole = result["error"]["rmse"];
    EXPECT_EQ(result["visibility"]["rmse"], 0.0);
    EXPECT_NEAR(result["shading"]["rmse"], whole, 1e-6 * whole);
    if (result["technique"] != "reference") {
      EXPECT_GT(whole, 0.01);
    }
  }
  EXPECT_EQ(json["visibility_msaa_ladder"][1], (Json{{"samples", 32}, {"rmse", 0.0}})) << "of two cells in x and y";
  EXPECT_GT(json["msaa_ladder"][1]["rmse"], 0.001);
  const auto found = layers("msaa_1");
  for (std::size_t i = 0; i < found.at("error").size(); ++i) {
    EXPECT_EQ(found.at("visibility_error")[i], 0.0f);
    EXPECT_EQ(found.at("shading_error")[i], found.at("error")[i]);
  }
}

TEST_F(ErrorSplitTest, OneColourHasErrorsOfVisibilityAlone) {
  const std::string sliver = R"({"mesh": "sliver"})";
  write_varying_trace(folder_, {sliver, sliver});  // taa has a history in the second frame
  const Json json = compare({"msaa:2", "beam", "taa:4", "--ladder", "1,2,4"});
  EXPECT_EQ(json["msaa_ladder"], json["visibility_msaa_ladder"]);
  for (const Json& result : json["results"]) {
    SCOPED_TRACE(result["technique"]);
    const double whole = result["error"]["rmse"];
    EXPECT_NEAR(result["visibility"]["rmse"], whole, 1e-9);
    EXPECT_EQ(result["shading"]["rmse"], 0.0) << "fp16 and sRGB of 8 bits hold these colours exactly";
    for (const Json& frame : result["frames"]) EXPECT_NEAR(frame["visibility"]["rmse"], frame["error"]["rmse"], 1e-9);
    EXPECT_EQ(result["visibility"]["equivalent_msaa"], result["equivalent_msaa"]);
    EXPECT_EQ(result["visibility"]["equivalent_msaa_is_lower_bound"], result["equivalent_msaa_is_lower_bound"]);
    if (result["technique"] != "reference") {
      EXPECT_GT(whole, 1e-5);
    }
  }
}

// Only the ladder's own techniques have the rate of their name.
TEST_F(ErrorSplitTest, VariantsOfMsaaGetTheirRatesByTheirErrors) {
  // A textured triangle with slanted edges, whose fragments at its edges are shaded elsewhere at the centroid.
  write_varying_trace(folder_, {R"({"mesh": "wall", "transform": [0.8,-0.2,0,0, 0.2,0.8,0,0, 0,0,1,0, 0.3,0.3,0,1]})"});
  const Json json = compare({"msaa:8", "msaa:8,at=centroid", "msaa:8,prepass", "--ladder", "1,2,8,64"});
  const auto rmse = [&](int i) { return json["results"][i]["error"]["rmse"].get<double>(); };
  const auto rate = [&](int i) { return json["results"][i]["equivalent_msaa"].get<double>(); };
  EXPECT_EQ(rate(0), 8.0);
  ASSERT_NE(rmse(1), rmse(0));
  EXPECT_EQ(rate(1) > 8.0, rmse(1) < rmse(0)) << rate(1);
  EXPECT_NE(rate(1), 8.0);
  EXPECT_EQ(rmse(2), rmse(0)) << "the picture is the same";
  EXPECT_EQ(rate(2), 8.0);
}

// Texture on the left and an outline on the right: squares add up to the square.
TEST_F(ErrorSplitTest, PartsInDifferentPixelsAreTheLegsOfTheError) {
  write_varying_trace(folder_, {R"({"mesh": "left"}, {"mesh": "sliver"})"});
  const Json json = compare({"msaa:2", "beam", "--ladder", "1,4"});
  for (const int i : {0, 1}) {
    const Json& result = json["results"][i];
    const double visibility = result["visibility"]["rmse"], shading = result["shading"]["rmse"];
    EXPECT_GT(visibility, 1e-5);
    EXPECT_GT(shading, 0.01);
    EXPECT_NEAR(std::hypot(visibility, shading), result["error"]["rmse"], 1e-6);
    EXPECT_EQ(result["frames"][0]["visibility"]["rmse"], visibility);
    EXPECT_EQ(result["frames"][0]["shading"]["rmse"], shading);
  }
  EXPECT_LT(json["results"][1]["visibility"]["rmse"], json["results"][0]["visibility"]["rmse"]);
  EXPECT_GT(json["results"][1]["visibility"]["equivalent_msaa"], 2.0);
  EXPECT_EQ(json["results"][0]["visibility"]["equivalent_msaa"], 2.0);
  for (const char* title : {"visibility", "its EMR", "shading"})
    EXPECT_NE(table_.substr(0, table_.find('\n')).find(title), std::string::npos) << table_;
  const auto found = layers("msaa_2");
  for (std::size_t i = 0; i < found.at("error").size(); ++i) {
    const bool is_left = i % 32 < 16;
    EXPECT_EQ(found.at(is_left ? "visibility_error" : "shading_error")[i], 0.0f) << i;
    EXPECT_EQ(found.at(is_left ? "shading_error" : "visibility_error")[i], found.at("error")[i]) << i;
  }
}

// A flat frame among others is split as well, so that parts can be pooled.
TEST_F(ErrorSplitTest, FramesArePooledByTheirSizes) {
  write_varying_trace(folder_, {R"({"mesh": "flat"})", R"({"mesh": "wall"}, {"mesh": "flat"})"}, 200);
  const Json result = compare({"msaa:2", "--ladder", "1"})["results"][0];
  for (const char* part : {"visibility", "shading"}) {
    const double first = result["frames"][0][part]["rmse"], second = result["frames"][1][part]["rmse"];
    EXPECT_NEAR(result[part]["rmse"], std::sqrt((200 * first * first + 32 * second * second) / 232), 1e-12) << part;
  }
  EXPECT_EQ(result["frames"][0]["shading"]["rmse"], 0.0);
  EXPECT_GT(result["frames"][1]["shading"]["rmse"], 0.01);
}

// Whatever history the techniques keep, in visibility all frames are the same.
TEST_F(ErrorSplitTest, HistoriesOfBothPicturesAreKeptApart) {
  const std::string wall = R"({"mesh": "wall"})";
  write_varying_trace(folder_, {wall, wall, wall});
  const Json json = compare({"taa:4", "--ladder", "1"});
  for (const Json& frame : json["results"][0]["frames"]) EXPECT_LT(frame["visibility"]["rmse"], 1e-3) << "of fp16";
  EXPECT_GT(json["results"][0]["shading"]["rmse"], 0.05);
}

TEST_F(ErrorSplitTest, CausesAddUpToTheErrorInVisibility) {
  write_varying_trace(folder_, {R"({"mesh": "wall"}, {"mesh": "sliver"}, {"mesh": "flat"})"});
  const Json json = compare({"beam", "casav", "alpha", "--ladder", "1", "--causes"});
  for (const int i : {0, 1, 2}) {
    const Json& result = json["results"][i];
    SCOPED_TRACE(result["technique"]);
    const auto found = layers(spec_folder(std::string(result["technique"])));
    for (std::size_t pixel = 0; pixel < found.at("error").size(); ++pixel) {
      double sum = 0;
      for (const auto& [name, values] : found)
        if (name.starts_with("cause_")) sum += values[pixel];
      ASSERT_NEAR(sum, found.at("visibility_error")[pixel], 1e-5);
      ASSERT_LT(std::abs(found.at("cause_rounding")[pixel]), 2e-3) << "colours are not rounding";
    }
    double shares = 0;
    for (const Json& share : result["error_causes"]) shares += double(share);
    EXPECT_NEAR(shares, 1.0, 1e-4);
    EXPECT_GT(result["visibility"]["rmse"], 1e-5);
  }
}

// Two sheets, one in front of the other, over a texture and over the background.
TEST_F(ErrorSplitTest, CausesKnowWhatShowsThroughTranslucentSurfaces) {
  write_varying_trace(folder_, {R"({"mesh": "left"}, {"mesh": "sheets"})"});
  const Json result = compare({"beam", "--ladder", "1", "--causes"})["results"][0];
  const auto found = layers("beam");
  for (std::size_t pixel = 0; pixel < found.at("error").size(); ++pixel)
    ASSERT_LT(std::abs(found.at("cause_rounding")[pixel]), 2e-3) << pixel;
  EXPECT_NEAR(result["error_causes"]["leak"], 0.0, 0.01);
  EXPECT_GT(result["error_causes"]["mask"], 0.8) << "a mask has 256 positions for parts of 0.3";
}

}  // namespace beampipe::error_split_test

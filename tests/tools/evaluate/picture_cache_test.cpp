#include "tools/evaluate/picture_cache.h"

#include "tests/tools/fixtures.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/render.h"
#include "traces/scenes.h"

namespace beampipe::picture_cache_test {

constexpr SurfaceColors kByPlace = SurfaceColors::by_place;

Trace small_trace(std::uint64_t seed = 1) {
  return make_scene("soup", {.triangles = 1000, .seed = seed, .width = 12, .height = 8});
}

KeptPicture picture_of(float value) {
  KeptPicture kept{flat_image(12, 8, value), {}};
  kept.image.rgba[5] = 0.1f;
  kept.report.pixels = 96;
  kept.report.stages = {StageCounters{StageId::resolve}};
  kept.report.stages[0].items_out = 96;
  return kept;
}

TEST(PictureCache, TellsApartAllThatAPictureDependsOn) {
  const TemporaryFolder folder;
  const PictureCache cache(folder / "cache", small_trace());
  cache.keep("reference", 0, kByPlace, picture_of(0.3f));
  EXPECT_FALSE(cache.find("reference:set=2", 0, kByPlace));
  EXPECT_FALSE(cache.find("reference", 1, kByPlace));
  EXPECT_FALSE(cache.find("reference", 0, SurfaceColors::by_pixel));
  EXPECT_FALSE(PictureCache(folder / "cache", small_trace(2)).find("reference", 0, kByPlace));
  Trace wider = small_trace();
  wider.frames[0].width = 13;
  EXPECT_FALSE(PictureCache(folder / "cache", wider).find("reference", 0, kByPlace));
  EXPECT_TRUE(PictureCache(folder / "cache", small_trace()).find("reference", 0, kByPlace));
}

TEST(PictureCache, ServesNoDamagedFile) {
  for (const char* const extension : {".exr", ".json"}) {
    const TemporaryFolder folder;
    const PictureCache cache(folder / "cache", small_trace());
    cache.keep("reference", 0, kByPlace, picture_of(0.3f));
    for (const auto& entry : std::filesystem::directory_iterator(folder / "cache")) {
      if (entry.path().extension() != extension) continue;
      std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
      file.seekg(static_cast<std::streamoff>(entry.file_size()) / 2);
      const char byte = static_cast<char>(file.get());
      file.seekp(static_cast<std::streamoff>(entry.file_size()) / 2);
      file.put(static_cast<char>(byte ^ 1));
    }
    EXPECT_FALSE(cache.find("reference", 0, kByPlace)) << extension;
    cache.keep("reference", 0, kByPlace, picture_of(0.3f));
    EXPECT_TRUE(cache.find("reference", 0, kByPlace)) << extension;
  }
}

TEST(PictureCache, KeepsWhatWasUsedLast) {
  const TemporaryFolder folder;
  PictureCache(folder / "cache", small_trace()).keep("reference", 0, kByPlace, picture_of(0.3f));
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "cache")) bytes += entry.file_size();
  const PictureCache cache(folder / "cache", small_trace(), bytes * 5 / 2);  // room for two
  cache.keep("reference", 1, kByPlace, picture_of(0.3f));
  EXPECT_TRUE(cache.find("reference", 0, kByPlace)) << "now used last";
  cache.keep("reference", 2, kByPlace, picture_of(0.3f));
  EXPECT_FALSE(cache.find("reference", 1, kByPlace));
  EXPECT_TRUE(cache.find("reference", 0, kByPlace));
  EXPECT_TRUE(cache.find("reference", 2, kByPlace));
}

TEST(PictureCache, IsNoErrorWhereItCannotBeWritten) {
  const PictureCache cache("/proc/nowhere", small_trace());
  cache.keep("reference", 0, kByPlace, picture_of(0.3f));
  EXPECT_FALSE(cache.find("reference", 0, kByPlace));
}

// What a kept picture says about the frame is what rendering it says.
TEST(PictureCache, ChangesNothingInAFrame) {
  const TemporaryFolder folder;
  RunPlan plan;
  plan.trace = small_trace();
  plan.frames = {0};
  plan.options.threads = 1;
  Progress silent(false);
  const Technique reference = parse_technique(kReferenceSpec);
  const FrameResult rendered = render_kept(reference, plan, 0, silent);  // nothing is kept yet
  plan.pictures = std::make_shared<PictureCache>(folder / "cache", plan.trace);
  for (const std::string which : {"first", "kept"}) {
    WallTime time;
    const FrameResult found = render_kept(reference, plan, 0, silent, &time);
    EXPECT_EQ(time.kept, which == "kept");
    EXPECT_EQ(found.image.rgba, rendered.image.rgba) << which;
    EXPECT_EQ(found.bin_operations, rendered.bin_operations) << which;
    EXPECT_EQ(found.bin_pixels, rendered.bin_pixels) << which;
    EXPECT_EQ(found.buffers, rendered.buffers) << which;
    ASSERT_EQ(found.stages.size(), rendered.stages.size()) << which;
    for (std::size_t i = 0; i < found.stages.size(); ++i) EXPECT_EQ(found.stages[i], rendered.stages[i]) << which;
  }
  EXPECT_TRUE(plan.pictures->find(kReferenceSpec, 0, kByPlace));
}

}  // namespace beampipe::picture_cache_test

#include "tools/cli/trace_notes.h"

#include "tests/tools/program.h"
#include "tests/tools/varying_trace.h"

namespace beampipe::trace_notes_test {

// Three frames, each of which draws one triangle that has the trace's first material.
Trace three_frames() {
  Trace trace;
  trace.materials.resize(2);
  trace.materials[0].name = "clay", trace.materials[1].name = "lamp";
  trace.materials[1].emissive = glm::vec3(0, 0, 1);
  trace.meshes.resize(1);
  trace.meshes[0].positions.resize(3);
  trace.meshes[0].triangles = {{0, 1, 2}};
  trace.meshes[0].materials = {0};
  trace.frames.resize(3);
  for (Frame& frame : trace.frames) frame.draws.resize(1);
  return trace;
}

TEST(NoteOnDarkness, NamesTheFirstFrameAndAMaterial) {
  Trace trace = three_frames();
  const std::string black = " neither lights nor ambient light, so surfaces of material \"clay\" are black";
  EXPECT_EQ(note_on_darkness(trace, {0, 1, 2}, "a.json"), "a.json: frame 0 and 2 others have" + black);
  EXPECT_EQ(note_on_darkness(trace, {1, 2}, "a.json"), "a.json: frame 1 and 1 other have" + black);
  EXPECT_EQ(note_on_darkness(trace, {2}, "a.json"), "a.json: frame 2 has" + black);
  trace.frames[0].lighting.lights.resize(1);
  trace.frames[1].lighting.ambient.emplace();
  EXPECT_EQ(note_on_darkness(trace, {0, 1, 2}, "a.json"), "a.json: frame 2 has" + black);
  EXPECT_EQ(note_on_darkness(trace, {0, 1}, "a.json"), "");
}

TEST(NoteOnMotion, CountsDrawsWhoseMeshChanges) {
  Trace trace = three_frames();
  trace.meshes.push_back(trace.meshes[0]);
  trace.meshes[1].triangles = {{0, 2, 1}};
  EXPECT_EQ(note_on_motion(trace, {0, 1, 2}, {"taa:8"}, "a.json"), "");
  trace.frames[1].draws[0].mesh = 1;
  const std::string another = " draws show another mesh than in the frame before, whose motion is unknown to ";
  EXPECT_EQ(note_on_motion(trace, {0, 1}, {"taa:8"}, "a.json"), "a.json: 1 of 1" + another + "taa:8");
  EXPECT_EQ(note_on_motion(trace, {0, 1, 2}, {"taa:8", "dvm"}, "a.json"), "a.json: 2 of 2" + another + "taa:8 and dvm");
  EXPECT_EQ(note_on_motion(trace, {0, 2}, {"taa:8"}, "a.json"), "");
  EXPECT_EQ(note_on_motion(trace, {0, 1, 2}, {}, "a.json"), "");
  trace.meshes[1].triangles = trace.meshes[0].triangles;  // only vertices may be elsewhere
  EXPECT_EQ(note_on_motion(trace, {0, 1, 2}, {"taa:8"}, "a.json"), "");
  trace.meshes[1].triangles = {{0, 2, 1}};
  trace.frames[1].draws.resize(3);
  EXPECT_EQ(note_on_motion(trace, {0, 1, 2}, {"taa:8"}, "a.json"), "");
}

TEST(NoteOnDarkness, IsNotAboutSurfacesThatNeedNoLight) {
  const auto note = [](const Trace& trace) { return note_on_darkness(trace, {0}, "a.json"); };
  Trace trace = three_frames();
  trace.frames[0].draws[0].kd = glm::vec3(1.0f);  // flat
  EXPECT_EQ(note(trace), "");
  trace.frames[0].draws[0] = {.material = 1};  // emits light
  EXPECT_EQ(note(trace), "");
  trace.frames[0].draws[0] = {};
  trace.meshes[0].materials = {kNoMaterial};
  EXPECT_EQ(note(trace), "");
  trace.meshes[0].materials = {0};
  EXPECT_NE(note(trace), "");
  trace.materials[0].unlit = true;
  EXPECT_EQ(note(trace), "");
}

TEST(NoteOnDarkness, IsSaidOnceByInfoRunAndCompare) {
  const TemporaryFolder folder;
  const std::string file = (folder / "dark.json").string(), out = (folder / "out").string();
  write_text(file, R"({"beampipe_trace": 2, "materials": {"clay": {}},
    "meshes": {"m": {"positions": [-1,-1,0, 1,-1,0, 0,1,0], "indices": [0,1,2], "materials": ["clay"]}},
    "frames": [{"width": 2, "height": 2, "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "m"}]}]})");
  for (const std::vector<std::string>& command : {std::vector<std::string>{"info", file},
                                                  {"run", file, "-t", "msaa:1", "beam", "-o", out},
                                                  {"compare", file, "-t", "msaa:1", "-o", out}}) {
    const Outcome outcome = run_program(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::size_t found = outcome.err.find("material \"clay\" are black");
    EXPECT_NE(found, std::string::npos) << command[0];
    EXPECT_EQ(outcome.err.find("are black", found + 26), std::string::npos) << command[0];
  }
}

}  // namespace beampipe::trace_notes_test

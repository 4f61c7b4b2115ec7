#include "tests/traces/test_folder.h"

namespace beampipe::mesh_path_test {

const char kObj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class MeshPathTest : public FolderTest {
 protected:
  MeshPathTest() {
    write("outside.obj", kObj);
    write("in/ship.obj", kObj);
    write("in/deep/ship.obj", kObj);
  }

  Trace load(const std::string& obj, bool allow_outside) const {
    const std::string text = R"({"beampipe_trace": 1, "meshes": {"m": {"obj": ")" + obj +
                             R"("}}, "frames": [{"width": 1, "height": 1, "draws": [],
        "camera": {"eye": [0,0,1], "target": [0,0,0], "up": [0,1,0], "fovy_deg": 36, "near": 1, "far": 2}}]})";
    return read_trace(write("in/scene.json", text), {.allow_outside = allow_outside});
  }
  std::string error(const std::string& obj, bool allow_outside = false) const {
    return error_of([&] { load(obj, allow_outside); });
  }
};

constexpr char kStays[] =
    "in/scene.json: /meshes/m/obj: expected a path that stays in the trace's folder (--allow-outside allows others), "
    "found ";

TEST_F(MeshPathTest, ReadsFilesInTheFolder) {
  for (const char* obj : {"ship.obj", "./ship.obj", "deep/ship.obj", "deep/../ship.obj"}) {
    EXPECT_EQ(load(obj, false).meshes[0].triangles.size(), 1u) << obj;
  }
}

TEST_F(MeshPathTest, KeepsPathsInTheFolder) {
  EXPECT_EQ(error("../outside.obj"), std::string(kStays) + "\"../outside.obj\"");
  EXPECT_EQ(error("deep/../../outside.obj"), std::string(kStays) + "\"deep/../../outside.obj\"");
  EXPECT_EQ(error("../missing.obj"), std::string(kStays) + "\"../missing.obj\"");
  EXPECT_EQ(error("ship.obj\\u0000/../x"),
            "in/scene.json: /meshes/m/obj: expected a path without NUL characters, found \"ship.obj\\u0000/../x\"");
  EXPECT_EQ(error("/no/such.obj"), std::string(kStays) + "\"/no/such.obj\"");
  EXPECT_EQ(error(path("in/ship.obj").string()).substr(0, sizeof kStays - 1), kStays);
}

TEST_F(MeshPathTest, FollowsSymbolicLinks) {
  std::filesystem::create_symlink(path("outside.obj"), path("in/link.obj"));
  EXPECT_EQ(error("link.obj"), std::string(kStays) + "\"link.obj\"");
  std::filesystem::create_directory_symlink(path(""), path("in/up"));
  EXPECT_EQ(error("up/outside.obj"), std::string(kStays) + "\"up/outside.obj\"");
  std::filesystem::create_symlink(path("in/deep/ship.obj"), path("in/inner.obj"));
  EXPECT_EQ(error("inner.obj"), "no error");
}

TEST_F(MeshPathTest, TheUserMayAllowAnyPath) {
  EXPECT_EQ(error("../outside.obj", true), "no error");
  EXPECT_EQ(error(path("outside.obj").string(), true), "no error");
}

TEST_F(MeshPathTest, ReadsRegularFilesOnly) {
  for (const bool outside : {false, true}) {
    EXPECT_EQ(error("deep", outside), "in/scene.json: /meshes/m/obj: expected a regular file, found \"deep\"");
    EXPECT_EQ(error("none.obj", outside),
              "in/scene.json: /meshes/m/obj: expected an existing file, found \"none.obj\"");
  }
  EXPECT_EQ(error("/dev/null", true), "in/scene.json: /meshes/m/obj: expected a regular file, found \"/dev/null\"");
}

TEST_F(MeshPathTest, ErrorsInTheObjNameBothFiles) {
  write("in/bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  EXPECT_EQ(
      error("bad.obj"),
      "in/scene.json: /meshes/m/obj: in/bad.obj: face 1: expected indices of the 3 vertices, from 1 up or from -1 "
      "down, found another one at corner 3");
}

}  // namespace beampipe::mesh_path_test

#include "tests/traces/test_folder.h"
#include "traces/files/model_import.h"

namespace beampipe::obj_import_test {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class ObjImportTest : public FolderTest {
 protected:
  // Flat triangles, as a trace of version 1 has them.
  Mesh load(const std::string& text) const { return flat(write("mesh.obj", text)); }
  static Mesh flat(const std::filesystem::path& file, const std::string& named_by = "scene.json: /meshes/m/obj") {
    Trace trace;
    NotRead not_read;
    read_obj(file, {.named_by = named_by}, trace, not_read);
    EXPECT_TRUE(not_read.empty());
    EXPECT_TRUE(trace.materials.empty());
    EXPECT_EQ(trace.meshes.size(), 1u);
    return trace.meshes.at(0);
  }
  std::string error(const std::string& text) const {
    return error_of([&] { load(text); });
  }
};

constexpr glm::vec3 kGrey(0.8f);

TEST_F(ObjImportTest, TakesKdForEachFace) {
  write("colors.mtl", "newmtl red\nKd 1 0 0\nnewmtl dim green\nKa 1 1 1\nKd 0 0.25 0\n");
  const Mesh mesh = load("mtllib colors.mtl\n" + kSquare +
                         "f 1 2 3\nusemtl red\nf 1 2 3\nusemtl dim green\nf 1 2 3 4\nusemtl nowhere\nf 1 2 3\n");
  EXPECT_EQ(mesh.colors, (std::vector<glm::vec3>{kGrey, {1, 0, 0}, {0, 0.25f, 0}, {0, 0.25f, 0}, kGrey}));
}

// The library that is used here gives black or 0.6 grey, and 0.6 never after a material with Kd.
TEST_F(ObjImportTest, MaterialsWithoutKdAreGrey) {
  const std::string faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n";
  write("m.mtl", "newmtl a\nKs 1 1 1\nnewmtl b\r\nKd 1 0 0\r\nmap_Kd none.png\rnewmtl c\nmap_Kd none.png\n");
  EXPECT_EQ(load("mtllib m.mtl\n" + kSquare + faces).colors, (std::vector<glm::vec3>{kGrey, {1, 0, 0}, kGrey}));
  write("m.mtl", "newmtl a\nmap_Kd none.png\nnewmtl b\nKd 1 0 0\nnewmtl c");
  EXPECT_EQ(load("mtllib m.mtl\n" + kSquare + faces).colors, (std::vector<glm::vec3>{kGrey, {1, 0, 0}, kGrey}));
}

TEST_F(ObjImportTest, NamesOfMaterialLibrariesMayHaveBlanks) {
  write("my room.mtl", "newmtl red\nKd 1 0 0\n");
  write("b.mtl", "newmtl red\nKd 0 0 1\nnewmtl blue\nKd 0 0 1\n");
  const std::string faces = kSquare + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\n";
  const glm::vec3 red(1, 0, 0), blue(0, 0, 1);
  const auto colors = [&](const std::string& lines) { return load(lines + faces).colors; };
  EXPECT_EQ(colors("mtllib my room.mtl\n"), (std::vector<glm::vec3>{red, kGrey}));
  EXPECT_EQ(colors("mtllib  my room.mtl \r\nmtllib b.mtl\n"), (std::vector<glm::vec3>{red, blue}));
  EXPECT_EQ(colors("mtllib my\\ room.mtl\n"), (std::vector<glm::vec3>{red, kGrey}));
  EXPECT_EQ(colors("mtllib none.mtl b.mtl\n"), (std::vector<glm::vec3>{blue, blue})) << "or there are several";
  EXPECT_EQ(colors("mtllib " + std::string(255, 'x') + " b.mtl\n"), (std::vector<glm::vec3>{blue, blue}))
      << "which together are too long for one";
}

TEST_F(ObjImportTest, BlanksAroundMaterialNamesDoNotCount) {
  write("colors.mtl", "newmtl red \r\nKd 1 0 0\r\n");
  EXPECT_EQ(load("mtllib colors.mtl\r\n" + kSquare + "usemtl  red \r\nf 1 2 3\r\n").colors[0], glm::vec3(1, 0, 0));
}

// By triangulate(), whose tests have other polygons.
TEST_F(ObjImportTest, TriangulatesPolygons) {
  const Mesh mesh = load(kSquare + "f 1 2 3 4\n");
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(load("v 100 50 7\nv 104 50 7\nv 101 51 7\nv 100 54 7\nf 2 3 4 1\n").triangles,
            (std::vector<glm::uvec3>{{2, 3, 0}, {2, 0, 1}}))
      << "a fan from the first corner would fill the dent";
}

TEST_F(ObjImportTest, CountsNegativeIndicesFromTheLastVertexSoFar) {
  const Mesh mesh = load(kSquare + "f -4 -3 -2\nv 5 5 5\nf -1 1/1 2//3\n");
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {4, 0, 1}}));
}

TEST_F(ObjImportTest, KeepsCoordinatesExactly) {
  const Mesh mesh = load("v 0.1 -2.5e-3 +3\nv 1e10 .5 1.\nv 16777217 0.333333343 -0\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions[0], glm::vec3(0.1f, -2.5e-3f, 3.0f));
  EXPECT_EQ(mesh.positions[1], glm::vec3(1e10f, 0.5f, 1.0f));
  EXPECT_EQ(mesh.positions[2], glm::vec3(16777216.0f, 0.333333343f, 0.0f));
}

TEST_F(ObjImportTest, SaysWhatIsWrong) {
  const std::string start = "scene.json: /meshes/m/obj: mesh.obj: ";
  const std::string number = "expected three finite numbers after \"v\", found ";
  EXPECT_EQ(error("v 0 0 0\nv nan 0 0\n"), start + "line 2: " + number + "\"v nan 0 0\"");
  EXPECT_EQ(error("v 0 inf 0\n"), start + "line 1: " + number + "\"v 0 inf 0\"");
  EXPECT_EQ(error("v 0 0 1e39\n"), start + "line 1: " + number + "\"v 0 0 1e39\"");
  EXPECT_EQ(error("v 0 0\n"), start + "line 1: " + number + "\"v 0 0\"");
  EXPECT_EQ(error("v 0 0 1,5\n"), start + "line 1: " + number + "\"v 0 0 1,5\"");
  EXPECT_EQ(error(""), start + "expected at least one face, found none");
  EXPECT_EQ(error(kSquare), start + "expected at least one face, found none");
  EXPECT_EQ(error(kSquare + "f 1 2\n"), start + "face 1: expected three or more corners, found 2");
  const std::string range =
      "expected indices of the 4 vertices, from 1 up or from -1 down, found another one at corner ";
  EXPECT_EQ(error(kSquare + "f 1 2 3\nf 1 2 5\n"), start + "face 2: " + range + "3");
  EXPECT_EQ(error(kSquare + "f 0 1 2\n"), start + "face 1: " + range + "1");
  EXPECT_EQ(error(kSquare + "f 1 -5 2\n"), start + "face 1: " + range + "2");
  EXPECT_EQ(error(kSquare + "f 1 2 3 4 9\n"), start + "face 1: " + range + "5");
  std::string corners;
  for (int i = 0; i < 5000; ++i) corners.append(" ").append(std::to_string(i % 4 + 1));
  EXPECT_EQ(error(kSquare + "f" + corners + "\n"), start + "face 1: expected at most 4096 corners, found 5000");
}

TEST_F(ObjImportTest, ReadsNothingThatItsChecksHaveNotSeen) {
  const std::string start = "scene.json: /meshes/m/obj: mesh.obj: ";
  const std::string number = "expected three finite numbers after \"v\", found ";
  EXPECT_EQ(error("v 0 0 0\r\n#\rv 1e39 1 .5\n"), start + "line 3: " + number + "\"v 1e39 1 .5\"");
  EXPECT_EQ(error("v 0 0 0\rv nan 0 0\r"), start + "line 2: " + number + "\"v nan 0 0\"");
  EXPECT_EQ(error("#\rv 1"), start + "line 2: " + number + "\"v 1\"");
  EXPECT_EQ(error(" \tv\t0 0 \tnan\n"), start + "line 1: " + number + "\"v\\t0 0 \\tnan\"");
  EXPECT_EQ(error("v +-5 0 0\n"), start + "line 1: " + number + "\"v +-5 0 0\"");
  EXPECT_EQ(error(std::string("v 0 0 0\0001\n", 10)), start + "line 1: " + number + "\"v 0 0 0\\u00001\"");
  EXPECT_EQ(error("v 0 0 \\\n0\n"), start + "line 1: " + number + "\"v 0 0 \\\\\"");
  EXPECT_EQ(error("v 0 0 0\nv 0 0e500 0\nf 1 2 1\n"), start + "vertex 2: expected finite numbers, found others");
  write("m.mtl", "newmtl a\n#\rKd 1e39 1 1\n");
  EXPECT_EQ(error("mtllib m.mtl\n"),
            start + "m.mtl: line 3: expected three finite numbers after \"Kd\", found \"Kd 1e39 1 1\"");
  write("m.mtl", "newmtl a\nKd 1 0\n");
  EXPECT_EQ(error("mtllib m.mtl\n"),
            start + "m.mtl: line 2: expected three finite numbers after \"Kd\", found \"Kd 1 0\"");
  for (const char* kd : {"1 0e500 1", "1 -1 0"}) {
    write("m.mtl", std::string("newmtl a\nKd ") + kd + "\n");
    EXPECT_EQ(error("mtllib m.mtl\n"),
              start + "m.mtl: expected Kd from 0 to 65504, found another one in material \"a\"");
  }
}

TEST_F(ObjImportTest, TakesIndicesInEveryFormAndNothingElse) {
  for (const char* face :
       {"1 2 3", "1/5 2/5 3/5", "1//6 2//6 3//6", "1/5/6 2/5/6 3/5/6", "-4/-1 -3//-1 +3", "1/ 2/ 3/"})
    EXPECT_EQ(load(kSquare + "f " + face + "\r\n").triangles, (std::vector<glm::uvec3>{{0, 1, 2}})) << face;
  for (const char* index :
       {"4294967299", "99999999999999999999", "-4294967295", "3x", "2.9", "c", "+-3", "/3", "3/1x", "3/1/1/1"}) {
    const std::string face = std::string("f 1 2 ") + index;
    EXPECT_EQ(error(kSquare + "#\r\n" + face + "\n"),
              "scene.json: /meshes/m/obj: mesh.obj: line 6: expected corners such as 3, 3/1, 3//1 or 3/1/1 after "
              "\"f\", found \"" +
                  face + "\"");
  }
}

TEST_F(ObjImportTest, SkipsAByteOrderMark) {
  write("m.mtl", "\xEF\xBB\xBFnewmtl red\nKd 1 0 0\n");
  const Mesh mesh = load("\xEF\xBB\xBFv 5 0 0\nmtllib m.mtl\nusemtl red\n" + kSquare + "f 1 2 3\n");
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.colors[0], glm::vec3(1, 0, 0));
  EXPECT_NE(error("\xEF\xBB\xBFv nan 0 0\n").find("line 1: expected three finite numbers"), std::string::npos);
}

}  // namespace beampipe::obj_import_test

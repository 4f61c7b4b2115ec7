// Real materials of OBJ files; flat triangles are in obj_import_test.cpp.
#include "tests/traces/test_folder.h"
#include "tests/traces/test_images.h"
#include "traces/files/model_import.h"

namespace beampipe::obj_material_test {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

class ObjMaterialTest : public FolderTest {
 protected:
  ObjMaterialTest() {
    write("colors.png", std::string(kColors));
    write("heights.png", std::string(kHeights));
    write("holes.png", std::string(kHoles));
    write("glass.png", std::string(kGlass));
    write("normals.png", std::string(kNormals));
  }

  ImportedModel load(const std::string& mtl, const std::string& obj,
                     ObjMaterials materials = ObjMaterials::textured) const {
    write("m.mtl", mtl);
    ImportedModel model;
    read_obj(write("mesh.obj", "mtllib m.mtl\n" + kSquare + obj), {.materials = materials}, model.trace,
             model.not_read);
    return model;
  }
  // Of a square with all attributes, whose material "m" has these lines.
  ImportedModel load_material(const std::string& lines) const {
    return load("newmtl m\n" + lines, "usemtl m\nf 1/1 2/2 3/3 4/4\n", ObjMaterials::all);
  }
  Material material(const std::string& lines) const { return load_material(lines).trace.materials.at(0); }
  std::string error(const std::string& lines, const std::string& face = "f 1/1 2/2 3/3\n") const {
    return error_of([&] { load("newmtl m\n" + lines, "usemtl m\n" + face, ObjMaterials::all); });
  }
};

TEST_F(ObjMaterialTest, TexturedTrianglesGetMaterialsAndOthersStayFlat) {
  const std::string mtl = "newmtl plain\nKd 1 0 0\nKs 1 1 1\nNs 10\nnewmtl wood\nKd 0.5 1 1\nmap_Kd colors.png\n";
  const std::string obj = "usemtl plain\nf 1 2 3\nusemtl wood\nf 1/1 3/3 4/4\nf 2 3 4\n";
  const ImportedModel model = load(mtl, obj);
  ASSERT_EQ(model.trace.materials.size(), 1u);
  const Mesh& mesh = model.trace.meshes.at(0);
  EXPECT_EQ(mesh.materials, (std::vector<std::uint32_t>{kNoMaterial, 0, 0}));
  EXPECT_EQ(mesh.colors, (std::vector<glm::vec3>{{1, 0, 0}, {0.5f, 1, 1}, {0.5f, 1, 1}}));
  EXPECT_EQ(model.trace.materials[0].name, "wood");
  EXPECT_EQ(model.trace.materials[0].base_color, glm::vec4(0.5f, 1, 1, 1));
  EXPECT_TRUE(model.trace.materials[0].double_sided);
  ASSERT_EQ(model.trace.images.size(), 1u);
  EXPECT_EQ(model.trace.images[0].name, "colors.png");
  EXPECT_EQ(mesh.positions[mesh.triangles[1].z], glm::vec3(0, 1, 0));
  EXPECT_EQ(mesh.uvs[0][mesh.triangles[1].x], glm::vec2(0, 1));  // v is 0 on top
  EXPECT_EQ(mesh.uvs[0][mesh.triangles[1].z], glm::vec2(0, 0));
  EXPECT_EQ(mesh.uvs[0][mesh.triangles[2].x], glm::vec2(0, 0));  // the file names none

  const Trace flat = load(mtl, obj, ObjMaterials::none).trace;
  EXPECT_TRUE(flat.materials.empty() && flat.images.empty());
  EXPECT_EQ(flat.meshes[0].positions.size(), 4u);
  EXPECT_TRUE(flat.meshes[0].materials.empty() && flat.meshes[0].uvs[0].empty());
  EXPECT_EQ(load(mtl, obj, ObjMaterials::all).trace.meshes[0].materials, (std::vector<std::uint32_t>{0, 1, 1}));
}

TEST_F(ObjMaterialTest, WithoutTexturesTheMeshStaysAsItIs) {
  const Trace trace = load("newmtl m\nKd 0 1 0\nNs 5\n", "vn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\n").trace;
  EXPECT_TRUE(trace.materials.empty() && trace.meshes[0].normals.empty() && trace.meshes[0].uvs[0].empty());
  EXPECT_EQ(trace.meshes[0].positions.size(), 4u);
}

TEST_F(ObjMaterialTest, CornersShareVerticesWhereAllIndicesAgree) {
  const Mesh mesh =
      load("newmtl m\nmap_Kd colors.png\n",
           "vn 0 0 2\nvn 0 -1 0\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/2\nf 1/1/1 2/3/1 3/3/-1\n")
          .trace.meshes.at(0);
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}, {0, 4, 5}}));
  EXPECT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.normals[3], glm::vec3(0, -1, 0));
  EXPECT_EQ(mesh.normals[5], glm::vec3(0, -1, 0));
  EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));  // unit length
}

TEST_F(ObjMaterialTest, CornersWithoutNormalsTakeTheirFaces) {
  const Mesh mesh =
      load("newmtl m\nmap_Kd colors.png\n", "v 0 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\nf 1/1 2/2 5/3\n").trace.meshes.at(0);
  EXPECT_EQ(mesh.positions.size(), 7u);  // the square's triangles share two
  EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[mesh.triangles[2].x], glm::vec3(0, -1, 0));
}

TEST_F(ObjMaterialTest, ReadsFactors) {
  Material m = material("Kd 0.1 0.2 0.3\nKs 1 1 1\nNs 30\nKe 0 0.5 2\n");
  EXPECT_EQ(m.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 1));
  EXPECT_FLOAT_EQ(m.roughness, 0.5f);  // (2 / 32)^(1/4)
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.emissive, glm::vec3(0, 0.5f, 2));
  EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(material("Kd 1 1 1\nKs 0 0 0\nNs 30\n").roughness, 1.0f);
  m = material("Kd 1 1 1\nd 0.25\nPr 0.75\nPm 0.5\n");
  EXPECT_EQ(m.base_color.a, 0.25f);
  EXPECT_EQ(m.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(m.roughness, 0.75f);
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(material("Kd 1 1 1\nTr 0.75\n").base_color.a, 0.25f);
}

TEST_F(ObjMaterialTest, CutsOutWithMapD) {
  ImportedModel model = load_material("map_Kd colors.png\nmap_d holes.png\n");
  EXPECT_EQ(model.trace.materials[0].alpha_mode, AlphaMode::mask);
  EXPECT_EQ(model.trace.images[model.trace.materials[0].base_texture->image].texels,
            (std::vector<glm::u8vec4>{{255, 0, 0, 0}, {0, 255, 0, 255}, {0, 0, 255, 0}, {255, 255, 255, 255}}));
  model = load_material("Kd 1 1 1\nmap_d glass.png\n");  // has alpha of its own
  EXPECT_EQ(model.trace.images[model.trace.materials[0].base_texture->image].texels,
            (std::vector<glm::u8vec4>{{255, 255, 255, 10}, {255, 255, 255, 255}}));
}

TEST_F(ObjMaterialTest, TurnsHeightsIntoNormals) {
  const ImportedModel model = load_material("Kd 1 1 1\nbump -bm 10 -clamp on heights.png\n");
  const Material& m = model.trace.materials[0];
  ASSERT_TRUE(m.normal_texture);
  EXPECT_EQ(m.normal_texture->wrap_u, Wrap::clamp);
  EXPECT_EQ(m.normal_scale, 1.0f);
  // The heights are 0, 2, 4 and 6 texels: a slope of 2 inside, and of 1 at the ends.
  const double inner = std::sqrt(5.0), outer = std::sqrt(2.0);
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * x)); };
  const std::vector<glm::u8vec4>& texels = model.trace.images[m.normal_texture->image].texels;
  EXPECT_EQ(texels[1], glm::u8vec4(byte(-2 / inner), byte(0), byte(1 / inner), 255));
  EXPECT_EQ(texels[0], glm::u8vec4(byte(-1 / outer), byte(0), byte(1 / outer), 255));
  EXPECT_EQ(model.trace.meshes[0].tangents, std::vector<glm::vec4>(4, {1, 0, 0, 1}));  // the image stands upright
  EXPECT_EQ(model.trace.meshes[0].normals, std::vector<glm::vec3>(4, {0, 0, 1}));
}

TEST_F(ObjMaterialTest, TakesNormalMapsAsTheyAre) {
  for (const char* line : {"norm normals.png\n", "map_Bump normals.png\n", "norm -bm 1 heights.png\n"}) {
    const ImportedModel model = load_material(std::string("Kd 1 1 1\n") + line);
    EXPECT_EQ(model.trace.images.size(), 1u) << line;
    EXPECT_EQ(model.trace.materials[0].normal_texture, Texture{}) << line;
  }
}

TEST_F(ObjMaterialTest, ReadsEmission) {
  const Material m = material("Kd 0 0 0\nmap_Ke colors.png\n");
  EXPECT_TRUE(m.emissive_texture);
  EXPECT_EQ(m.emissive, glm::vec3(1));
}

TEST_F(ObjMaterialTest, ReadsColoursOfVertices) {
  const auto colors = [&](const std::string& obj) {
    Trace trace;
    NotRead not_read;
    read_obj(write("mesh.obj", obj), {.materials = ObjMaterials::all}, trace, not_read);
    return trace.meshes.at(0).vertex_colors;
  };
  EXPECT_EQ(colors("v 0 0 0 1 0 0\nv 1 0 0 0 +0.5 0\nv 0 1 0 0 0 2\nf 1 2 3\n"),
            (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 0.5f, 0, 1}, {0, 0, 1, 1}}));
  EXPECT_TRUE(colors("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").empty());
}

TEST_F(ObjMaterialTest, NamesWhatIsNotRead) {
  const ImportedModel model =
      load("newmtl m\nKd 1 1 1\nKa 1 1 1\nillum 2\nmap_Kd -s 2 2 1 colors.png\nmap_Ks colors.png\nmap_Ka colors.png\n",
           "usemtl m\n# a comment\nl 1 2\nl 2 3\ng group\ns off\nf 1 2 3\n");
  EXPECT_EQ(model.not_read,
            (NotRead{{"Ka", 1}, {"illum", 1}, {"l", 2}, {"map_Ka", 1}, {"map_Ks", 1}, {"option -s of map_Kd", 1}}));
  EXPECT_TRUE(load("newmtl m\nKa 1 1 1\n", "l 1 2\nf 1 2 3\n", ObjMaterials::none).not_read.empty());
}

TEST_F(ObjMaterialTest, NamesWhatIsMissing) {
  EXPECT_EQ(load("newmtl m\nKd 1 1 1\n", "usemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\nusemtl n\nf 1 2 3\n").not_read,
            (NotRead{{"usemtl n (in no mtllib)", 1}}));
  EXPECT_EQ(
      load("", "mtllib none.mtl\nmtllib none.mtl\nusemtl c\nf 1 2 3\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n").not_read,
      (NotRead{{"mtllib none.mtl (missing)", 1}, {"usemtl a and 2 more (in no mtllib)", 1}}));
  EXPECT_EQ(load("", "mtllib no such.mtl\nmtllib m.mtl none.mtl\nf 1 2 3\n").not_read,
            (NotRead{{"mtllib no such.mtl (missing)", 1}, {"mtllib none.mtl (missing)", 1}}));
  EXPECT_TRUE(load("", "usemtl\nf 1 2 3\n").not_read.empty());
}

TEST_F(ObjMaterialTest, MaterialsWithoutKdAreGrey) {
  EXPECT_EQ(material("map_Kd colors.png\n").base_color, glm::vec4(0.8f, 0.8f, 0.8f, 1));
  EXPECT_EQ(material("Pr 0.5\n").base_color, glm::vec4(0.8f, 0.8f, 0.8f, 1));
}

TEST_F(ObjMaterialTest, SharesImages) {
  const ImportedModel model = load("newmtl a\nmap_Kd colors.png\nnewmtl b\nmap_Kd colors.png\nmap_Ke colors.png\n",
                                   "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl a\nf 1 3 4\n");
  EXPECT_EQ(model.trace.images.size(), 1u);
  EXPECT_EQ(model.trace.meshes[0].materials, (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST_F(ObjMaterialTest, SaysWhatIsWrong) {
  write("no.png", "no image");
  EXPECT_EQ(error("map_Kd none.png\n"), "mesh.obj: none.png: expected a readable file, found none");
  EXPECT_EQ(error("map_Kd ../colors.png\n"),
            "mesh.obj: expected a file in the model's folder, found \"../colors.png\"");
  EXPECT_EQ(error("map_Kd ..\\colors.png\n"),
            "mesh.obj: expected a file in the model's folder, found \"../colors.png\"");
  EXPECT_EQ(error("map_Kd no.png\n").find("mesh.obj: no.png: expected "), 0u);
  EXPECT_EQ(error("Ns many\n"), "mesh.obj: m.mtl: line 2: expected a finite number after \"Ns\", found \"Ns many\"");
  EXPECT_EQ(error("d nan\n"), "mesh.obj: m.mtl: line 2: expected a finite number after \"d\", found \"d nan\"");
  EXPECT_EQ(error("d 2\n"), "mesh.obj: material m: expected d in its range, found another one");
  EXPECT_EQ(error("Ke -1 0 0\n"), "mesh.obj: material m: expected Ke in its range, found another one");
  const std::string range = ", from 1 up or from -1 down, found another one at corner 3";
  EXPECT_EQ(error("Kd 1 1 1\n", "f 1/1 2/2 3/5\n"),
            "mesh.obj: face 1: expected indices of the 4 texture coordinates" + range);
  EXPECT_EQ(error("Kd 1 1 1\n", "vn 0 0 1\nf 1/1/1 2/2/-1 3/3/2\n"),
            "mesh.obj: face 1: expected indices of the 1 normals" + range);
  EXPECT_EQ(error("Kd 1 1 1\n", "vn 0 nan 1\nf 1 2 3\n"),
            "mesh.obj: line 11: expected three finite numbers after \"vn\", found \"vn 0 nan 1\"");
  EXPECT_EQ(error("Kd 1 1 1\n", "vt\nf 1 2 3\n"),
            "mesh.obj: line 11: expected one to three finite numbers after \"vt\", found \"vt\"");
  EXPECT_EQ(error("Kd 1 1 1\n", "vt 0e500 0\nf 1 2 3\n").find("mesh.obj: texture coordinate 5: expected finite"), 0u);
}

}  // namespace beampipe::obj_material_test

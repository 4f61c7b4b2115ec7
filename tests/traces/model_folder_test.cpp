#include "traces/files/model_folder.h"

#include "tests/traces/test_folder.h"
#include "traces/files/model_import.h"

namespace beampipe::model_folder_test {

namespace fs = std::filesystem;

// A model under version control, as git-annex keeps it: the folder "room" has links to contents elsewhere.
class ModelFolderTest : public FolderTest {
 protected:
  ModelFolderTest() {
    write("store/room.obj", "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    write("store/a1/colors", "newmtl red\nKd 1 0 0\n");
    write("room/own.mtl", "newmtl red\nKd 0 0 1\n");
    fs::create_symlink(path("store/a1/colors"), path("room/room.mtl"));
    fs::create_symlink(path("store/lost"), path("room/lost.mtl"));
    fs::create_symlink(path("room/own.mtl"), path("room/inner.mtl"));
    fs::create_symlink(path("store/room.obj"), path("room/room.obj"));
    fs::copy_file(path("store/room.obj"), path("room/copy.obj"));
  }

  std::string error(const std::string& model, const std::string& name, bool follow_links) const {
    return error_of([&] { ModelFolder(path(model), follow_links).read(name, "W"); });
  }
  Mesh load(const std::string& model, bool follow_links) const {
    Trace trace;
    NotRead not_read;
    read_obj(path(model), {.follow_links = follow_links}, trace, not_read);
    return trace.meshes.at(0);
  }
};

TEST_F(ModelFolderTest, NamesStayInTheFolder) {
  for (const bool follow : {false, true}) {
    for (const std::string& name :
         {std::string("../store/room.obj"), std::string("x/../../store/room.obj"), std::string("/etc/passwd"),
          std::string(".."), std::string(), path("room/own.mtl").string()})
      EXPECT_EQ(error("room/copy.obj", name, follow),
                without_folder("W: expected a file in the model's folder, found \"" + name + "\""));
    EXPECT_EQ(error("room/copy.obj", "own.mtl", follow), "no error");
    EXPECT_EQ(error("room/copy.obj", "none/../own.mtl", follow), "no error");
    EXPECT_EQ(error("room/copy.obj", "inner.mtl", follow), "no error");
    EXPECT_EQ(error("room/copy.obj", "none.mtl", follow), "W: none.mtl: expected a readable file, found none");
  }
}

TEST_F(ModelFolderTest, LinksOutOfTheFolderAreFollowedIfTheUserSaysSo) {
  const std::string refusal =
      "W: expected a file in the model's folder (--follow-links, or --allow-outside of traces, allows others), found "
      "\"room.mtl\", through a link";
  EXPECT_EQ(error("room/copy.obj", "room.mtl", false), refusal);
  EXPECT_EQ(error("room/copy.obj", "room.mtl", true), "no error");
  EXPECT_EQ(error("room/room.obj", "room.mtl", false), refusal) << "it is beside the link and not beside the model";
  EXPECT_EQ(error("room/room.obj", "room.mtl", true), "no error");
  EXPECT_EQ(error("room/copy.obj", "lost.mtl", true), "W: lost.mtl: expected a readable file, found a link to none");
}

TEST_F(ModelFolderTest, ModelsAreReadThroughLinks) {
  EXPECT_EQ(load("room/room.obj", true).colors.at(0), glm::vec3(1, 0, 0));
  EXPECT_EQ(error_of([&] { load("room/room.obj", false); }).find("room/room.obj: expected a file in the model's"), 0u);
}

}  // namespace beampipe::model_folder_test

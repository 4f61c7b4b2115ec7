#include "traces/files/atomic_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include "tests/traces/test_folder.h"

namespace beampipe::atomic_file_test {

class AtomicFileTest : public FolderTest {
 protected:
  std::string failure(const std::string& name) const {
    return without_folder(message_of<std::runtime_error>([&] { AtomicFile file(path(name)); }));
  }
};

TEST_F(AtomicFileTest, ThereWhenCommittedAndNotBefore) {
  write("a", "old");
  AtomicFile file(path("a"));
  file.write("new");
  EXPECT_EQ(read("a"), "old");
  file.commit();
  EXPECT_EQ(read("a"), "new");
  EXPECT_FALSE(std::filesystem::exists(AtomicFile::temporary_of(path("a"))));
}

TEST_F(AtomicFileTest, WritesOverWhatAKilledProgramLeft) {
  write("a.tmp", "half of a long file");
  AtomicFile file(path("a"));
  file.write("new");
  file.commit();
  EXPECT_EQ(read("a"), "new");
  EXPECT_FALSE(std::filesystem::exists(path("a.tmp")));
}

TEST_F(AtomicFileTest, TwoAtOnceAreAnErrorOfTheSecond) {
  AtomicFile first(path("a"));
  EXPECT_EQ(failure("a"), "a: cannot write: a.tmp is being written by another program");
  first.write("1");
  first.commit();
  EXPECT_EQ(read("a"), "1");
  EXPECT_EQ(failure("a"), "no error");
}

TEST_F(AtomicFileTest, FollowsNothingUnderTheTemporaryName) {
  write("victim", "whole");
  ASSERT_EQ(symlink(path("victim").c_str(), path("a.tmp").c_str()), 0);
  EXPECT_NE(failure("a").find("a: cannot create a file beside it"), std::string::npos);
  EXPECT_EQ(read("victim"), "whole");
  ASSERT_EQ(mkfifo(path("b.tmp").c_str(), 0666), 0);
  EXPECT_NE(failure("b").find("b: cannot"), std::string::npos) << "and does not wait for a reader";
}

}  // namespace beampipe::atomic_file_test

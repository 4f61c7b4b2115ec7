#include "tools/files/output.h"

#include <unistd.h>

#include <csignal>

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"

namespace beampipe::output_test {

using Names = std::vector<std::string>;

class OutputFolderTest : public InFolder {
 protected:
  InterruptGate gate_;
};

TEST_F(OutputFolderTest, IsMadeWithTheFirstFile) {
  OutputFolder output(folder_ / "a/b", gate_);
  EXPECT_EQ(folder_.list(), Names{});
  output.write("c/d.txt", "hello");
  output.keep();
  EXPECT_EQ(folder_.list(), (Names{"a/", "a/b/", "a/b/c/", "a/b/c/d.txt"}));
  EXPECT_EQ(read_text(folder_ / "a/b/c/d.txt"), "hello");
}

TEST_F(OutputFolderTest, ReplacesAFileAsAWhole) {
  OutputFolder output(folder_ / "a", gate_);
  output.write("f", std::string(10000, 'x'));
  output.write("f", "short");
  EXPECT_EQ(read_text(folder_ / "a/f"), "short");
  EXPECT_EQ(folder_.list(), (Names{"a/", "a/f"}));
}

TEST_F(OutputFolderTest, WhatWasNotKeptGoesAwayButEarlierFilesStay) {
  write_text(folder_ / "earlier", "1");
  {
    OutputFolder output(folder_.string(), gate_);
    output.write("kept/a", "2");
    output.keep();
    output.write("kept/b", "3");
    output.write("new/c", "4");
    output.write("earlier", "5");
  }
  EXPECT_EQ(folder_.list(), (Names{"earlier", "kept/", "kept/a"}));
  EXPECT_EQ(read_text(folder_ / "earlier"), "5");
}

// A new file and an old report about its predecessor never exist at the same time, and the old report is not removed if
// the new file cannot be written.
TEST_F(OutputFolderTest, WhatIsOutdatedGoesWhenTheNewFileIsReadyAndBeforeItAppears) {
  write_text(folder_ / "report", "1");
  OutputFolder output(folder_.string(), gate_);
  std::filesystem::create_directory(folder_ / "taken");
  EXPECT_THROW(output.write("taken", "bytes", {"report"}), std::runtime_error);
  EXPECT_EQ(folder_.list(), (Names{"report", "taken/"}));
  output.write("picture", "bytes", {"report", "never_there"});
  EXPECT_EQ(folder_.list(), (Names{"picture", "taken/"}));
  write_text(folder_ / "taken/file", "so that the folder cannot be removed");
  EXPECT_THROW(output.write("second", "bytes", {"taken"}), std::runtime_error);
  EXPECT_EQ(folder_.list(), (Names{"picture", "taken/", "taken/file"}));
}

TEST_F(OutputFolderTest, IsLockedAgainstOthers) {
  const auto expect_locked = [&](auto call) {
    EXPECT_EQ(message_of<std::runtime_error>(call), (folder_ / "a").string() + ": is being written by another program");
  };
  OutputFolder early(folder_ / "a", gate_), late(folder_ / "a", gate_);
  early.lock();  // both locks are possible as long as the folder does not exist
  {
    OutputFolder output(folder_ / "a", gate_);
    output.lock();
    output.write("f", "1");
    output.keep();
    expect_locked([&] { early.write("b/g", "2"); });
    expect_locked([&] { late.lock(); });
    EXPECT_EQ(folder_.list(), (Names{"a/", "a/f"}));
  }
  late.lock();
  expect_locked([&] { early.lock(); });
}

TEST_F(OutputFolderTest, RemovesAFileThatMayNotBeThere) {
  write_text(folder_ / "f", "1");
  OutputFolder output(folder_.string(), gate_);
  output.remove("f");
  output.remove("g");
  EXPECT_EQ(folder_.list(), Names{});
}

using RequireWritableFolder = InFolder;

TEST_F(RequireWritableFolder, LeavesNothingBehind) {
  require_writable_folder(folder_.string());
  require_writable_folder(folder_ / "a/b/c");
  require_writable_folder(folder_ / "a/");
  EXPECT_EQ(folder_.list(), Names{});
}

TEST_F(RequireWritableFolder, ProgramsThatAskTogetherDoNotDisturbOneAnother) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int k = 0; k < 200; ++k) EXPECT_NO_THROW(require_writable_folder(folder_ / "new"));
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(folder_.list(), Names{});
}

TEST_F(RequireWritableFolder, RefusesNamesThatNoFileCanHave) {
  EXPECT_THROW(require_writable_folder(folder_ / std::string(256, 'x') / "below"), std::runtime_error);
  require_writable_file(folder_ / "new" / std::string(251, 'x'));
  EXPECT_THROW(require_writable_file(folder_ / "new" / std::string(252, 'x')), std::runtime_error)
      << "the temporary name, with .tmp, is too long";
}

TEST_F(RequireWritableFolder, RefusesAFolderInWhichNobodyCanCreateFiles) {
  EXPECT_THROW(require_writable_folder("/proc"), std::runtime_error);
  EXPECT_THROW(require_writable_folder("/proc/new/folder"), std::runtime_error);
}

TEST(InterruptGateDeathTest, WaitsWhileTheGateIsHeld) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        InterruptGate gate;
        auto held = gate.hold();
        kill(getpid(), SIGINT);
        pause(200);
        std::fputs("still here", stderr);
        held.unlock();
        pause(20000);
      },
      testing::ExitedWithCode(130), "still here");
}

TEST(InterruptGate, GivesTheSignalsBack) {
  sigset_t before, after;
  pthread_sigmask(SIG_SETMASK, nullptr, &before);
  { InterruptGate gate; }
  pthread_sigmask(SIG_SETMASK, nullptr, &after);
  EXPECT_EQ(sigismember(&before, SIGINT), sigismember(&after, SIGINT));
  EXPECT_EQ(sigismember(&after, SIGINT), 0);
}

}  // namespace beampipe::output_test

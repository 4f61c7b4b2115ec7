#include "tools/files/output.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/tools/fixtures.h"

namespace beampipe::output_test {

using Names = std::vector<std::string>;

TEST(OutputFolder, IsMadeWithTheFirstFile) {
  TemporaryFolder folder;
  InterruptGate gate;
  OutputFolder output(folder / "a/b", gate);
  EXPECT_EQ(folder.list(), Names{});
  output.write("c/d.txt", "hello");
  output.keep();
  EXPECT_EQ(folder.list(), (Names{"a/", "a/b/", "a/b/c/", "a/b/c/d.txt"}));
  EXPECT_EQ(read_text(folder / "a/b/c/d.txt"), "hello");
}

TEST(OutputFolder, ReplacesAFileAsAWhole) {
  TemporaryFolder folder;
  InterruptGate gate;
  OutputFolder output(folder / "a", gate);
  output.write("f", std::string(10000, 'x'));
  output.write("f", "short");
  EXPECT_EQ(read_text(folder / "a/f"), "short");
  EXPECT_EQ(folder.list(), (Names{"a/", "a/f"}));
}

TEST(OutputFolder, WhatWasNotKeptGoesAwayButEarlierFilesStay) {
  TemporaryFolder folder;
  InterruptGate gate;
  write_text(folder / "earlier", "1");
  {
    OutputFolder output(folder.string(), gate);
    output.write("kept/a", "2");
    output.keep();
    output.write("kept/b", "3");
    output.write("new/c", "4");
    output.write("earlier", "5");
  }
  EXPECT_EQ(folder.list(), (Names{"earlier", "kept/", "kept/a"}));
  EXPECT_EQ(read_text(folder / "earlier"), "5");
}

TEST(OutputFolder, AFailureLeavesNothingNew) {
  TemporaryFolder folder;
  InterruptGate gate;
  std::filesystem::create_directory(folder / "taken");
  {
    OutputFolder output(folder.string(), gate);
    EXPECT_THROW(output.write("taken", "bytes"), std::runtime_error);
  }
  EXPECT_EQ(folder.list(), Names{"taken/"});
}

// A new file and an old report about its predecessor never exist at the same time, and the old report is not removed if
// the new file cannot be written.
TEST(OutputFolder, WhatIsOutdatedGoesWhenTheNewFileIsReadyAndBeforeItAppears) {
  TemporaryFolder folder;
  InterruptGate gate;
  write_text(folder / "report", "1");
  OutputFolder output(folder.string(), gate);
  std::filesystem::create_directory(folder / "taken");
  EXPECT_THROW(output.write("taken", "bytes", {"report"}), std::runtime_error);
  EXPECT_EQ(folder.list(), (Names{"report", "taken/"}));
  output.write("picture", "bytes", {"report", "never_there"});
  EXPECT_EQ(folder.list(), (Names{"picture", "taken/"}));
  write_text(folder / "taken/file", "so that the folder cannot be removed");
  EXPECT_THROW(output.write("second", "bytes", {"taken"}), std::runtime_error);
  EXPECT_EQ(folder.list(), (Names{"picture", "taken/", "taken/file"}));
}

TEST(OutputFolder, IsLockedAgainstOthers) {
  TemporaryFolder folder;
  InterruptGate gate;
  const auto expect_locked = [&](auto call) {
    try {
      call();
      ADD_FAILURE() << "the folder is not locked";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), (folder / "a").string() + ": is being written by another program");
    }
  };
  OutputFolder early(folder / "a", gate), late(folder / "a", gate);
  early.lock();  // both locks are possible as long as the folder does not exist
  {
    OutputFolder output(folder / "a", gate);
    output.lock();
    output.write("f", "1");
    output.keep();
    expect_locked([&] { early.write("b/g", "2"); });
    expect_locked([&] { late.lock(); });
    EXPECT_EQ(folder.list(), (Names{"a/", "a/f"}));
  }
  late.lock();
  expect_locked([&] { early.lock(); });
}

TEST(OutputFolder, RemovesAFileThatMayNotBeThere) {
  TemporaryFolder folder;
  InterruptGate gate;
  write_text(folder / "f", "1");
  OutputFolder output(folder.string(), gate);
  output.remove("f");
  output.remove("g");
  EXPECT_EQ(folder.list(), Names{});
}

TEST(RequireWritableFolder, LeavesNothingBehind) {
  TemporaryFolder folder;
  require_writable_folder(folder.string());
  require_writable_folder(folder / "a/b/c");
  require_writable_folder(folder / "a/");
  EXPECT_EQ(folder.list(), Names{});
}

TEST(RequireWritableFolder, ProgramsThatAskTogetherDoNotDisturbOneAnother) {
  TemporaryFolder folder;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int k = 0; k < 200; ++k) EXPECT_NO_THROW(require_writable_folder(folder / "new"));
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(folder.list(), Names{});
}

TEST(RequireWritableFolder, RefusesNamesThatNoFileCanHave) {
  TemporaryFolder folder;
  EXPECT_THROW(require_writable_folder(folder / std::string(256, 'x') / "below"), std::runtime_error);
  require_writable_file(folder / "new" / std::string(251, 'x'));
  EXPECT_THROW(require_writable_file(folder / "new" / std::string(252, 'x')), std::runtime_error)
      << "the temporary name, with .tmp, is too long";
}

TEST(RequireWritableFolder, RefusesWhatIsInTheWay) {
  TemporaryFolder folder;
  write_text(folder / "file", "");
  EXPECT_THROW(require_writable_folder(folder / "file"), std::runtime_error);
  EXPECT_THROW(require_writable_folder(folder / "file/below"), std::runtime_error);
  EXPECT_THROW(require_writable_folder(""), std::runtime_error);
}

TEST(RequireWritableFolder, RefusesAFolderInWhichNobodyCanCreateFiles) {
  EXPECT_THROW(require_writable_folder("/proc"), std::runtime_error);
  EXPECT_THROW(require_writable_folder("/proc/new/folder"), std::runtime_error);
}

void wait(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

TEST(InterruptGateDeathTest, EndsTheProgramWith128PlusTheSignal) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(
        {
          InterruptGate gate;
          kill(getpid(), signal);
          wait(20000);
        },
        testing::ExitedWithCode(128 + signal), "");
  }
}

TEST(InterruptGateDeathTest, WaitsWhileTheGateIsHeld) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        InterruptGate gate;
        auto held = gate.hold();
        kill(getpid(), SIGINT);
        wait(200);
        std::fputs("still here", stderr);
        held.unlock();
        wait(20000);
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

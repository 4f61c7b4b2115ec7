// Interrupting the program, two programs in one folder, and progress on a terminal.
#include <fcntl.h>
#include <pty.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "tests/tools/cli/program_fixture.h"
#include "tools/files/image_io.h"
#include "tools/files/output.h"

namespace beampipe::interruption_test {

// A run that would take hours after it has written its first image.
std::vector<std::string> long_run(const std::string& trace, const std::string& out) {
  return {"run", trace, "-t", "msaa:1", "-o", out, "--frames", "0", "--repeat", "1000000", "--threads", "1"};
}

TEST_F(ProgramTest, CtrlCKeepsFinishedImagesAndLeavesNothingElse) {
  std::filesystem::create_directory(folder_ / "out");
  write_text(folder_ / "out/report.json", "of pictures that will be replaced");
  Program program(long_run(path("trace.json"), path("out")));
  for (int i = 0; i < 3000 && !std::filesystem::exists(folder_ / "out/msaa_1/frame_0000_counters.exr"); ++i) pause(10);
  pause(1500);  // long enough for a line of progress to appear
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "") << "progress is shown on terminals only";
  EXPECT_EQ(folder_.list(), (Names{"out/", "out/msaa_1/", "out/msaa_1/frame_0000.exr", "out/msaa_1/frame_0000.png",
                                   "out/msaa_1/frame_0000_counters.exr", "trace.json"}));
  EXPECT_EQ(read_exr(folder_ / "out/msaa_1/frame_0000.exr").width, 20u);
}

TEST_F(ProgramTest, CtrlCSaysWhatIsKeptAndHowToGoOn) {
  succeed({"make", "soup", "--triangles", "50", "--width", "64", "--height", "64", "--frames", "10000", "--orbit", "1",
           "-o", path("long.json")});
  for (const std::string command : {"run", "compare"}) {
    Program program({command, path("long.json"), "-t", "msaa:1", "-o", path(command), "--threads", "1"});
    for (int i = 0; i < 3000 && !std::filesystem::exists(path(command) + "/unfinished/frame_0001.json"); ++i) pause(10);
    program.signal(SIGINT);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 130);
    std::size_t kept = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path(command) + "/unfinished"))
      kept += entry.is_regular_file();
    EXPECT_GE(kept, 2u);
    const std::string rest = " of 10000 frames are kept, and the same command with --resume goes on from there\n";
    // The last record may have been written after the text was set.
    EXPECT_TRUE(outcome.err == "beampipe: stopped; " + std::to_string(kept) + rest ||
                outcome.err == "beampipe: stopped; " + std::to_string(kept - 1) + rest)
        << outcome.err << kept;
  }
}

// Ctrl-C waits neither for a long frame nor for a large file.
TEST_F(ProgramTest, CtrlCEndsALongFrameAndALongFileAtOnce) {
  Program file({"make", "hairball", "--triangles", "5000000", "-o", path("big.json")});
  pause(1500);
  file.signal(SIGINT);
  EXPECT_EQ(file.wait().exit_code, 130);
  EXPECT_EQ(folder_.list(), Names{"trace.json"});

  succeed({"make", "soup", "--triangles", "2000", "--width", "4096", "--height", "4096", "-o", path("wide.json")});
  Program frame({"run", path("wide.json"), "-t", "reference", "-o", path("out")});
  pause(500);
  frame.signal(SIGINT);
  EXPECT_EQ(frame.wait().exit_code, 130);
  EXPECT_EQ(folder_.list(), (Names{"trace.json", "wide.json"}));
}

TEST_F(ProgramTest, CtrlCLeavesNoSoup) {
  succeed({"make", "hairball", "--triangles", "300000", "-o", path("big.json")});
  const Names before = folder_.list();
  Program program({"export-soup", path("big.json"), "-o", path("big.soup")});
  for (int i = 0; i < 30000 && folder_.list() == before; ++i) pause(1);
  program.signal(SIGTERM);
  if (program.wait().exit_code == 0) return;  // it had already finished
  EXPECT_EQ(folder_.list(), before);
}

TEST_F(ProgramTest, OneProgramAtATimeWritesIntoAFolder) {
  Program program(long_run(path("trace.json"), path("out")));
  for (int i = 0; i < 3000 && !std::filesystem::exists(folder_ / "out/msaa_1/frame_0000_counters.exr"); ++i) pause(10);
  const Names before = folder_.list();
  const std::vector<Names> others = {{"run", path("trace.json"), "-t", "beam", "-o", path("out")},
                                     {"run", path("trace.json"), "-t", "beam", "-o", path("out"), "--resume"},
                                     {"compare", path("trace.json"), "-t", "beam", "-o", path("out")}};
  for (const Names& other : others) {
    expect_error(other, 1, path("out") + ": is being written by another program");
    EXPECT_EQ(folder_.list(), before);
  }
  program.signal(SIGKILL);
  program.wait();
  succeed(others[0]);
}

TEST_F(ProgramTest, ReportKeepsOutOfAFolderInUse) {
  succeed({"compare", path("trace.json"), "-t", "msaa:1", "--ladder", "1", "-o", path("out")});
  InterruptGate gate;
  OutputFolder writer(path("out"), gate);
  writer.lock();
  expect_error({"report", path("out")}, 1, "is being written by another program");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/report.html"));
}

TEST_F(ProgramTest, ATerminalShowsProgressAfterASecond) {
  int terminal = -1, program_side = -1;
  if (openpty(&terminal, &program_side, nullptr, nullptr, nullptr) != 0)
    GTEST_SKIP() << "there is no pseudo-terminal on this system: " << std::strerror(errno);
  fcntl(terminal, F_SETFL, O_NONBLOCK);
  const auto start = std::chrono::steady_clock::now();
  Program program(long_run(path("trace.json"), path("out")), program_side);
  std::string shown;
  for (int i = 0; i < 3000 && shown.find("msaa:1") == std::string::npos; ++i) {
    char bytes[256];
    const ssize_t count = read(terminal, bytes, sizeof bytes);
    if (count > 0) shown.append(bytes, static_cast<std::size_t>(count));
    pause(10);
  }
  EXPECT_NE(shown.find("msaa:1"), std::string::npos);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 130);
  close(terminal);
  close(program_side);
}

}  // namespace beampipe::interruption_test

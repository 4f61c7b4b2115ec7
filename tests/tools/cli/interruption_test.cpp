// Interrupting the program, two programs in one folder, and progress on a terminal.
#include <fcntl.h>
#include <pty.h>
#include <unistd.h>

#include <csignal>

#include "tests/tools/cli/program_fixture.h"
#include "tools/files/image_io.h"
#include "tools/files/output.h"

namespace beampipe::interruption_test {

// A run that would take hours after it has written its first image.
std::vector<std::string> long_run(const std::string& trace, const std::string& out) {
  return {"run", trace, "-t", "msaa:1", "-o", out, "--frames", "0", "--repeat", "1000000", "--threads", "1"};
}

// Returns whether it happened within half a minute.
template <class Condition>
bool wait_until(const Condition& happens) {
  for (int i = 0; i < 30000 && !happens(); ++i) pause(1);
  return happens();
}

constexpr const char* kNoTerminal = "there is no pseudo-terminal on this system";

class Terminal {
 public:
  Terminal() {
    if (openpty(&side_, &program_side_, nullptr, nullptr, nullptr) == 0) fcntl(side_, F_SETFL, O_NONBLOCK);
  }
  ~Terminal() { close(side_), close(program_side_); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  bool is_open() const { return side_ >= 0; }
  int program_side() const { return program_side_; }

  // Waits for this text.
  bool shows(const std::string& text) {
    return wait_until([&] {
      char bytes[256];
      const ssize_t count = read(side_, bytes, sizeof bytes);
      if (count > 0) shown_.append(bytes, static_cast<std::size_t>(count));
      return shown_.find(text) != std::string::npos;
    });
  }

 private:
  int side_ = -1, program_side_ = -1;
  std::string shown_;
};

TEST_F(ProgramTest, CtrlCKeepsFinishedImagesAndLeavesNothingElse) {
  std::filesystem::create_directory(folder_ / "out");
  write_text(folder_ / "out/report.json", "of pictures that will be replaced");
  Program program(long_run(path("trace.json"), path("out")));
  wait_until([&] { return std::filesystem::exists(folder_ / "out/msaa_1/frame_0000_counters.exr"); });
  pause(1500);  // long enough for a line of progress to appear
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "beampipe: stopped; no frame is complete\n") << "progress is shown on terminals only";
  EXPECT_EQ(folder_.list(), (Names{"out/", "out/msaa_1/", "out/msaa_1/frame_0000.exr", "out/msaa_1/frame_0000.png",
                                   "out/msaa_1/frame_0000_counters.exr", "trace.json"}));
  EXPECT_EQ(read_exr(folder_ / "out/msaa_1/frame_0000.exr").width, 20u);
}

TEST_F(ProgramTest, CtrlCSaysWhatIsKeptAndHowToGoOn) {
  succeed({"make", "soup", "--triangles", "50", "--width", "64", "--height", "64", "--frames", "10000", "--orbit", "1",
           "-o", path("long.json")});
  for (const std::string command : {"run", "compare"}) {
    Program program({command, path("long.json"), "-t", "msaa:1", "-o", path(command), "--threads", "1"});
    wait_until([&] { return std::filesystem::exists(path(command) + "/unfinished/frame_0001.json"); });
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

// Ctrl-C waits neither for a large file nor for a long frame.
TEST_F(ProgramTest, CtrlCEndsALargeFileAtOnce) {
  const auto stop = [&](const Names& command, int signal) {
    const Names before = folder_.list();
    Program program(command);
    wait_until([&] { return folder_.list() != before; });
    program.signal(signal);
    const Outcome outcome = program.wait();
    if (command[0] == "export-soup" && outcome.exit_code == 0) return;  // it had already finished
    EXPECT_EQ(outcome.exit_code, 128 + signal);
    EXPECT_EQ(outcome.err, "beampipe: stopped\n");
    EXPECT_EQ(folder_.list(), before);
  };
  const Names make = {"make", "hairball", "--triangles", "3000000", "-o", path("big.json")};
  stop(make, SIGINT);
  stop(joined(make, {"--binary"}), SIGINT);
  succeed({"make", "hairball", "--triangles", "1500000", "--binary", "-o", path("big.json")});
  stop({"export-soup", path("big.json"), "-o", path("big.soup")}, SIGTERM);
}

TEST_F(ProgramTest, CtrlCEndsALongFrameAtOnce) {
  Terminal terminal;
  if (!terminal.is_open()) GTEST_SKIP() << kNoTerminal;
  succeed({"make", "soup", "--triangles", "2000", "--width", "4096", "--height", "4096", "-o", path("wide.json")});
  Program program({"run", path("wide.json"), "-t", "reference", "-o", path("out")}, terminal.program_side());
  EXPECT_TRUE(terminal.shows("reference"));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 130);
  EXPECT_EQ(folder_.list(), (Names{"trace.json", "wide.json"}));
}

TEST_F(ProgramTest, OneProgramAtATimeWritesIntoAFolder) {
  Program program(long_run(path("trace.json"), path("out")));
  wait_until([&] { return std::filesystem::exists(folder_ / "out/msaa_1/frame_0000_counters.exr"); });
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
  Terminal terminal;
  if (!terminal.is_open()) GTEST_SKIP() << kNoTerminal;
  const auto start = std::chrono::steady_clock::now();
  Program program(long_run(path("trace.json"), path("out")), terminal.program_side());
  EXPECT_TRUE(terminal.shows("msaa:1"));
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 130);
}

}  // namespace beampipe::interruption_test

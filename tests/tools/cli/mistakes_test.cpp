// Errors are reported in one line, and nothing half done is left.
#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/tools/cli/program_fixture.h"

namespace beampipe::mistakes_test {

TEST_F(ProgramTest, EveryMistakeIsOneLineAndLeavesNothing) {
  write_text(folder_ / "broken.json", "{\"beampipe_trace\": 1,");
  write_text(folder_ / "model.obj", "v 0 0 0\nv 4 0 0\nv 0 3 0\nf 1 2 3\n");
  write_text(folder_ / "picture.png", "\x89PNG\r\n\x1a\n");
  write_text(folder_ / "nested.json", std::string(1 << 20, '['));
  for (const char* report : {"piped", "endless"}) std::filesystem::create_directory(folder_ / report);
  ASSERT_EQ(mkfifo(path("piped/report.json").c_str(), 0666), 0);
  std::filesystem::create_symlink("/dev/zero", folder_ / "endless/report.json");
  const std::string trace = path("trace.json"), out = path("out");
  const std::tuple<Names, int, const char*> mistakes[] = {
      {{}, 2, "subcommand"},
      {{"frobnicate"}, 2, "no command frobnicate"},
      {{"comapre"}, 2, "did you mean 'compare'"},
      {{"run", trace, "-t", "beam", "--outptu", out}, 2, "no option --outptu (did you mean '--output'?)"},
      {{"run", trace, "-t", "mssa:8", "-o", out}, 2, "did you mean 'msaa'"},
      {{"run", "fence", "-t", "beam", "-o", out},
       2,
       "fence is a scene: expected its trace, which `beampipe make fence"},
      {{"make", "fnece", "-o", out}, 2, "no scene named fnece (did you mean 'fence'?)"},
      {{"make", path("model.obj"), "--targte", "1,2,3", "-o", out}, 2, "--targte (did you mean '--target'?)"},
      {{"--versoin"}, 2, "no option --versoin (did you mean '--version'?)"},
      {{"run", trace, "-t", "beam", "--framebuffer", "on-chp", "-o", out}, 2, "(did you mean 'on-chip'?)"},
      {{"plot", path("a"), path("b"), "--kind", "traffic", "-o", path("p.svg")}, 1, "no such folder"},
      {{"run", trace, "-t", "beam:ordr=sorted", "-o", out}, 2, "no option 'ordr' (did you mean 'order'?)"},
      {{"run", path("model.OBJ"), "-t", "beam", "-o", out}, 1, "expected a trace, found a model"},
      {{"run", trace, "-t", "beam", "-o", out, "--memory-trace-format", "csv"}, 2, "requires --memory-trace"},
      {{"run", trace, "-t", "beam", "--frames", "0", "-o", out, "--memory-trace", path("f"), "--trace-events",
        path("f")},
       2,
       "name the same file"},
      {{"run", trace, "-t", "reference", "--frames", "0", "-o", out, "--memory-trace", path("f")},
       2,
       "the reference makes no requests"},
      {{"run", trace, "-t", "beam"}, 2, "--output"},
      {{"run", trace, "-o", out}, 2, "--technique"},
      {{"run", trace, "-t", "nonsense", "-o", out}, 2, "nonsense"},
      {{"run", trace, "-t", "beam\nbeam", "-o", out}, 2, "beam?beam"},
      {{"run", trace, "-t", "msaa:3", "-o", out}, 2, "msaa:3"},
      {{"run", trace, "-t", "beam,msaa:8", "-o", out}, 2, "or reference; spaces separate techniques"},
      {{"run", trace, "-t", "beam", "beam", "-o", out}, 2, "twice"},
      {{"run", trace, "-t", "msaa:1,2,1", "-o", out}, 2, "twice"},
      {{"run", "-t", "beam", trace, "-o", out}, 2, "was taken for a technique; write the trace before -t"},
      {{"run", "-t", "beam", "-o", out}, 2, "TRACE is missing"},
      {{"make", path("model.obj"), "--background", "0,1e9,0", "-o", out},
       2,
       "--background: expected numbers from 0 to 65504"},
      {{"run", "/dev/zero", "-t", "beam", "-o", out}, 1, "expected a regular file"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", path("piped/report.json")}, 1, "expected a regular file"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", "/dev/zero"}, 1, "expected a regular file"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", "titan"}, 1, "or one of titan_v"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", "mali_g720"}, 1, "did you mean 'mali_g710'"},
      {{"run", trace, "-t", "beam", "-o", out, "--material-cost", "1,2,3,4"}, 2, "expected OPERATIONS[,FETCHES"},
      {{"run", trace, "-t", "beam", "-o", out, "--light-cost", "x"}, 2, "expected OPERATIONS[,FETCHES"},
      {{"capture", "--list", "--", "no_such_program"}, 1, "no_such_program: there is no such program"},
      {{"counters", "componse"}, 2, "expected the name of a stage, found none (did you mean 'compose'?)"},
      {{"model", out, "--sensitivity"}, 2, "expected --over TECHNIQUE beside it"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", path("broken.json")}, 1, "expected valid JSON"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", path("nested.json")}, 1, "nested.json: byte 33"},
      {{"report", path("piped")}, 1, "piped/report.json: expected a regular file"},
      {{"report", path("a"), path("b")}, 2, "several folders: expected -o FILE.html for their page, found none"},
      {{"report", path("a"), path("b"), "-o", path("p.html"), "--frame", "0"}, 2, "--output excludes --frame"},
      {{"report", path("a"), "-o", path("p.txt")}, 2, "p.txt: expected a name that ends in .html"},
      {{"report", path("a"), path("piped"), "-o", path("p.html")}, 1, "/a: no such folder"},
      {{"plot", path("endless"), "-o", path("p.svg")}, 1, "endless/report.json: expected a regular file"},
      {{"claims", path("piped")}, 1, "piped/report.json: expected a regular file"},
      {{"diff", path("piped/report.json"), path("piped/report.json")}, 1, "not a file"},
      {{"run", trace, "-t", "beam", "-o", out, "--simd", "avx9"}, 2, "avx9 not in {"},
      {{"run", trace, "-t", "beam", "-o", out, "--frames", "1-2"}, 2, "--frames 1-2"},
      {{"run", trace, "-t", "beam", "-o", out, "--threads", "0"}, 2, "--threads"},
      {{"run", trace, "-t", "beam", "-o", out, "--on-chip-memory", "16"},
       2,
       "expected 1024 to 2147483648 bytes, such as 64KB, found 16"},
      {{"run", trace, "-t", "beam", "-o", out, "--repeat", "0"}, 2, "--repeat"},
      {{"run", path("missing.json"), "-t", "beam", "-o", out}, 1, "missing.json"},
      {{"run", path("broken.json"), "-t", "beam", "-o", out}, 1, "broken.json"},
      {{"run", trace, "-t", "beam", "-o", path("trace.json")}, 1, "expected a folder"},
      {{"run", trace, "-t", "beam", "-o", path("trace.json/below")}, 1, "expected a folder"},
      {{"run", trace, "-t", "beam", "-o", ""}, 1, "empty"},
      {{"compare", trace, "-t", "beam", "-o", out, "--ladder", "1,3"}, 2, "msaa:3"},
      {{"compare", trace, "-t", "nonsense", "-o", out}, 2, "nonsense"},
      {{"diff", trace, trace}, 1, "trace.json"},
      {{"diff", path("picture.png"), trace}, 1, "picture.png: not a readable EXR image: it is a PNG; expected an EXR"},
      {{"report", trace}, 1, "trace.json: not a folder; expected one that"},
      {{"diff", trace}, 2, "B"},
      {{"info", path("missing.json")}, 1, "missing.json"},
      {{"export-soup", trace, "-o", trace}, 2, "the trace itself"},
      {{"make", "-o", path("a.json")}, 2, "SCENE"},
      {{"make", "fence"}, 2, "-o"},
      {{"make", "no_such_scene", "-o", path("a.json")}, 2, "no_such_scene"},
      {{"make", "fence", "--eye", "1,2,3", "-o", path("a.json")}, 2, "--eye"},
      {{"make", "fence", "--width", "16385", "-o", path("a.json")}, 2, "--width"},
      {{"make", path("missing.obj"), "-o", path("a.json")}, 1, "missing.obj"},
      {{"make", path("model.obj"), "-o", path("./model.obj")}, 2, "the model itself"},
      {{"make", path("model.obj"), "--seed", "2", "-o", path("a.json")}, 2, "--seed"},
      {{"make", path("model.obj"), "--eye", "1,2", "-o", path("a.json")}, 2, "--eye"},
      {{"make", path("model.obj"), "--near", "3", "--far", "2", "-o", path("a.json")}, 2, "near"},
      {{"make", path("model.obj"), "--ambient", "0.5", "--unlit", "-o", path("a.json")}, 2, "excludes"},
      {{"make", path("missing.glb"), "-o", path("a.json")}, 1, "missing.glb"},
      {{"make", path("model.obj"), "--materials", "some", "-o", path("a.json")}, 2, "--materials"},
      {{"make", path("model.obj"), "--animation", "0", "-o", path("a.json")}, 2, "--animation"},
      {{"make", path("model.glb"), "--materials", "all", "-o", path("a.json")}, 2, "--materials"},
      {{"make", path("model.glb"), "--cull", "back", "-o", path("a.json")}, 2, "--cull"},
      {{"make", path("model.glb"), "--animation", "0", "--orbit", "9", "-o", path("a.json")}, 2, "excludes"},
      {{"make", "fence", "--animation", "0", "-o", path("a.json")}, 2, "--animation"},
      {{"make", "soup", "-o", path("trace.json/a.json")}, 1, "trace.json"},
      {{"make", "fence", "--pan", "1,1", "-o", path("a.json")}, 2, "--pan"},
      {{"make", "fence", "--pan", "1,1", "--frames", "3", "--orbit", "2", "-o", path("a.json")}, 2, "--pan"},
      {{"make", path("model.obj"), "--ambient", "1.1", "-o", path("a.json")},
       2,
       "--ambient: expected a number from 0 to 1"},
      {{"make", path("model.obj"), "--light", "0,0,0", "-o", path("a.json")},
       2,
       "--light: expected a vector with a length"},
      {{"check-capture", trace, "-o", out}, 1, "trace.json: expected the captured program's depths or picture"},
      {{"schema", "trace", "--built-in", "mali_g710"}, 2, "expected the kind hardware, found trace"},
      {{"compare", trace, "-t", "beam", "-o", out, "--metric", "bias"}, 2, "--metric"},
      {{"compare", trace, "-t", "beam", "-o", out, "--pixels-per-degree", "0"},
       2,
       "--pixels-per-degree: expected a number in 1..1000, found 0"},
      {{"export-soup", trace, "--frame", "9", "-o", path("x.soup")}, 2, "--frame"},
      {{"preview", trace, "--frame", "2", "-o", path("x.png")}, 2, "--frame: expected 0 to 1, found 2"},
      {{"preview", path("model.obj"), "-o", path("x.exr")}, 2, "ends in .png"},
      {{"preview", path("model.obj"), "--frame", "1", "-o", path("x.png")}, 2, "--frame"},
      {{"preview", trace, "--unlit", "-o", path("x.png")}, 2, "--unlit is for models"},
  };
  const Names before = folder_.list();
  for (const auto& [arguments, exit_code, part] : mistakes) {
    std::string command;
    for (const std::string& argument : arguments) command += " " + argument;
    SCOPED_TRACE("beampipe" + command);
    expect_error(arguments, exit_code, part);
    EXPECT_EQ(folder_.list(), before);
  }
}

TEST_F(ProgramTest, MeshesOutsideTheTracesFolderNeedPermission) {
  std::filesystem::create_directory(folder_ / "inner");
  write_text(folder_ / "model.obj", "v 0 0 0\nv 4 0 0\nv 0 3 0\nf 1 2 3\n");
  write_text(folder_ / "inner/trace.json",
             R"({"beampipe_trace": 1, "meshes": {"m": {"obj": "../model.obj"}}, "frames": [
      {"width": 8, "height": 8, "background": [0,0,0], "draws": [{"mesh": "m"}],
       "camera": {"eye": [0,0,9], "target": [0,0,0], "up": [0,1,0], "fovy_deg": 36, "near": 1, "far": 20}}]})");
  expect_error({"info", path("inner/trace.json")}, 1, "model.obj");
  succeed({"info", path("inner/trace.json"), "--allow-outside"});
  expect_error({"run", path("inner/trace.json"), "-t", "msaa:1", "-o", path("out")}, 1, "model.obj");
  succeed({"run", path("inner/trace.json"), "-t", "msaa:1", "-o", path("out"), "--allow-outside"});
}

// As long as this exists, this process and its children can write no file with more bytes, as if the disk were full.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_;
};

TEST_F(ProgramTest, AFailedWriteIsOneLineAndLeavesEarlierResultsWhole) {
  const std::vector<std::string> run = {"run", path("trace.json"), "-t", "msaa:1", "-o", path("out")};
  succeed(run);
  const Names before = folder_.list();
  const std::string image = read_text(folder_ / "out/msaa_1/frame_0000.exr");
  const std::string report = read_text(folder_ / "out/report.json");
  {
    const FileSizeLimit limit(200);
    expect_error(run, 1, "frame_0000.exr: cannot write");
  }
  EXPECT_EQ(folder_.list(), before);
  EXPECT_EQ(read_text(folder_ / "out/msaa_1/frame_0000.exr"), image);
  EXPECT_EQ(read_text(folder_ / "out/report.json"), report);
}

// Of every other command that writes: nothing that is new stays, and nothing that was there changes.
TEST_F(ProgramTest, AFullDiskLeavesFilesAsTheyWere) {
  const std::string trace = path("trace.json"), out = path("out");
  succeed({"compare", trace, "-t", "beam", "msaa:1", "--ladder", "1", "--frames", "0", "-o", path("results")});
  const std::vector<Names> commands = {
      {"compare", trace, "-t", "beam", "--ladder", "1", "-o", out},
      {"run", trace, "-t", "beam", "--frames", "0", "-o", out, "--trace-events", path("events.json")},
      {"run", trace, "-t", "beam", "--frames", "0", "-o", out, "--memory-trace", path("requests")},
      {"report", path("results"), "-o", path("page.html")},
      {"plot", path("results"), "-o", path("plot.svg")},
      {"figure", path("results"), "-o", path("figure.svg")},
      {"inspect", trace, "--pixel", "3,3", "-t", "beam", "-o", path("pixel.svg")},
      {"export-soup", trace, "-o", path("soup")},
      {"make", "soup", "--triangles", "50", "-o", path("made.json")},
      {"make", "soup", "--triangles", "50", "--binary", "-o", path("made.json")},
      {"preview", trace, "-o", path("preview.png")},
      {"stress", "--case", "layers", "-t", "beam", "-o", path("stress")},
  };
  std::filesystem::create_directories(folder_ / "stress/traces");  // new folders may stay
  const Names before = folder_.list();
  for (const Names& command : commands) {
    SCOPED_TRACE(command[0] + " " + command.back());
    const Outcome outcome = [&] {  // the limit must be over when a failure is printed
      const FileSizeLimit limit(100);
      return run_program(command);
    }();
    EXPECT_EQ(outcome.exit_code, 1);
    expect_parts(outcome.err, {"beampipe: error: "});  // which is cut, too
    EXPECT_EQ(folder_.list(), before) << outcome.err;
  }
}

TEST_F(ProgramTest, AFolderInTheReportsPlaceIsRefusedAtOnce) {
  std::filesystem::create_directories(folder_ / "out/report.json");
  const Names before = folder_.list();
  expect_error({"run", path("trace.json"), "-t", "msaa:1", "-o", path("out")}, 1,
               "out/report.json: expected a regular file or none, found something else");
  EXPECT_EQ(folder_.list(), before);
}

}  // namespace beampipe::mistakes_test

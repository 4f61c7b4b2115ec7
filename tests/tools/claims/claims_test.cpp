// Claims: the published figures, the formulas of our numbers, and the claims made of both.
#include "tools/claims/claims.h"

#include "tests/message_of.h"
#include "tests/pipeline/test_traces.h"
#include "tests/tools/fixtures.h"
#include "tests/tools/report_frames.h"
#include "tools/claims/our_figures.h"
#include "tools/claims/published_figures.h"
#include "tools/files/digest.h"
#include "tools/report/claims_text.h"
#include "traces/scenes.h"

namespace beampipe::claims_test {

// ---- The data ----

// A file with one group of one claim; `fields` are those of the claim, beside its name.
std::string file_with(const std::string& fields, const std::string& topic = "design") {
  return R"({"beampipe_claims": 1, "publication": "A book", "groups": [{"topic": ")" + topic +
         R"(", "source": "page 1", "unit": "ms", "trace": "0123456789abcdef", "command": "beampipe claims",
             "claims": [{"name": "a claim", )" +
         fields + "}]}]}";
}

PublishedFigure figure_with(const std::string& fields) {
  return parse_published_figures(file_with(fields), "book.json").at(0);
}

std::string refusal(const std::string& text) {
  return message_of<std::exception>([&] { parse_published_figures(text, "book.json"); });
}

TEST(PublishedFigures, AreOneNumberOrARangeOrALowerBound) {
  EXPECT_EQ(figure_with(R"("published": 4, "formula": "f")").low, 4);
  EXPECT_EQ(figure_with(R"("published": 4, "formula": "f")").high, 4);
  EXPECT_EQ(figure_with(R"("published_low": 4, "published_high": 6, "formula": "f")").high, 6);
  EXPECT_EQ(figure_with(R"("published_low": 4, "formula": "f")").high, std::numeric_limits<double>::infinity());
}

TEST(PublishedFigures, AClaimsOwnFieldsComeBeforeThoseOfItsGroup) {
  const PublishedFigure shared = figure_with(R"("published": 4, "formula": "f")");
  EXPECT_EQ(shared.unit, "ms");
  EXPECT_EQ(shared.source, "page 1");
  const PublishedFigure own = figure_with(R"("published": 4, "formula": "f", "unit": "", "source": "page 2")");
  EXPECT_EQ(own.unit, "");
  EXPECT_EQ(own.source, "page 2");
}

TEST(PublishedFigures, NameAFormulaOrTheReasonWhyThereIsNone) {
  EXPECT_EQ(figure_with(R"("published": 4, "no_number": "nobody counted")").remark, "none: nobody counted");
  EXPECT_EQ(figure_with(R"("published": 4, "no_number": "nobody counted", "reason": "why")").reason, "");
  EXPECT_EQ(figure_with(R"("published": 4, "formula": "f", "reason": "why")").reason, "why");
}

TEST(PublishedFigures, OrTwoOthersToDivide) {
  const PublishedFigure figure = figure_with(R"("published": 4, "quotient_of": ["a", "b"])");
  EXPECT_EQ(figure.formula, "");
  EXPECT_EQ(figure.numerator, "a");
  EXPECT_EQ(figure.denominator, "b");
}

TEST(PublishedFigures, OfDesignAreTrueByDefinition) {
  EXPECT_TRUE(figure_with(R"("published": 4, "formula": "f")").by_definition);
  EXPECT_FALSE(parse_published_figures(file_with(R"("published": 4, "formula": "f")", "time"), "book.json")
                   .front()
                   .by_definition);
}

TEST(PublishedFigures, ErrorsNameThePlace) {
  const std::string several = ": expected one of \"formula\", \"quotient_of\" and \"no_number\", found several";
  const std::pair<const char*, std::string> cases[] = {
      {R"("formula": "f")", ": expected the key \"published_low\", found none"},
      {R"("published": "4", "formula": "f")", "/published: expected a number"},
      {R"("published": 4, "formula": "f", "colour": 1)", "/colour: expected one of the keys"},
      {R"("published": 4)", ": expected the key \"formula\", found none"},
      {R"("published": 4, "formula": "f", "no_number": "why")", several},
      {R"("published": 4, "formula": "f", "quotient_of": ["a", "b"])", several},
      {R"("published": 4, "quotient_of": ["a"])", "/quotient_of: expected the names of two claims, found 1"}};
  for (const auto& [fields, start] : cases)
    EXPECT_TRUE(refusal(file_with(fields)).starts_with("book.json: /groups/0/claims/0" + start)) << fields;
  EXPECT_TRUE(refusal(file_with(R"("published": 4, "formula": "f")", "gossip"))
                  .starts_with("book.json: /groups/0/topic: expected one of"));
}

TEST(PublishedStatements, SayWhetherTheyCanBeHadHere) {
  const auto file = [](const std::string& answer) {
    return R"({"beampipe_claims": 1, "publication": "A book", "groups": [],
               "statements": [{"source": "page 1", "text": "it floats", "answer": ")" +
           answer + R"("}]})";
  };
  const Statement statement = parse_published_statements(file("works: in water"), "book.json").at(0);
  EXPECT_EQ(statements_text({statement}), "A book\n  page 1: it floats\n    works: in water\n");
  EXPECT_EQ(message_of<std::exception>([&] { parse_published_statements(file("yes"), "book.json"); }),
            "book.json: /statements/0/answer: expected works: ..., partly: ... or not here: ..., found yes");
}

TEST(PublishedStatements, OfAllPublicationsAreAnswered) {
  std::map<std::string, int> count;
  for (const Statement& statement : published_statements()) ++count[statement.publication];
  EXPECT_EQ(count.size(), 3u);
  for (const auto& [publication, statements] : count) EXPECT_GT(statements, 10) << publication;
}

TEST(PublishedFigures, ThatNeedRenderingNameTheirTrace) {
  EXPECT_EQ(parse_published_figures(file_with(R"("published": 4, "formula": "f")", "time"), "book.json").front().trace,
            "0123456789abcdef");
  const std::string text = file_with(R"("published": 4, "formula": "f")", "time");
  EXPECT_EQ(refusal(replaced(text, "\"trace\"", "\"remark\"")),
            "book.json: /groups/0: expected the key \"trace\", found none");
}

// Splits at blanks.
std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

// What the command `beampipe make SCENE OPTIONS -o FILE` makes.
Trace trace_of_command(const std::string& command) {
  const std::vector<std::string> words = words_of(command);
  SceneOptions options;
  std::uint32_t frames = 1;
  for (std::size_t i = 3; words.at(i) != "-o"; i += 2) {
    const auto value = static_cast<std::uint32_t>(std::stoul(words.at(i + 1)));
    if (words[i] == "--width")
      options.width = value;
    else if (words[i] == "--height")
      options.height = value;
    else if (words[i] == "--triangles")
      options.triangles = value;
    else if (words[i] == "--frames")
      frames = value;
    else
      throw std::runtime_error("what is " + words[i] + "?");
  }
  Trace trace = make_scene(words.at(2), options);
  if (frames > 1) orbit_camera(trace, frames, 0);
  return trace;
}

TEST(PublishedFigures, NameTheTracesThatTheirCommandsMake) {
  std::map<std::string, std::string> made;  // digests, by the part of a command that makes the trace
  for (const PublishedFigure& figure : published_figures()) {
    if (figure.by_definition) {
      EXPECT_EQ(figure.trace, "") << figure.name;
      continue;
    }
    const std::string make = figure.command.substr(0, figure.command.find(" && "));
    if (!made.contains(make)) made[make] = digest_of(trace_of_command(make));
    EXPECT_EQ(figure.trace, made[make]) << figure.name;
  }
  EXPECT_EQ(made.size(), 8u);
}

// ---- Figures and formulas ----

// Whose trace is that of the claim with this name.
Report report_for(const std::string& claim) {
  Report report;
  for (const PublishedFigure& figure : published_figures())
    if (figure.name == claim) report.made_by = {{"trace", figure.trace}};
  EXPECT_TRUE(report.made_by.is_object()) << "there is no claim " << claim;
  return report;
}

// Adds the result of one frame.
TechniqueReport& add_result(Report& report, const std::string& technique, const FrameReport& frame) {
  TechniqueReport& result = report.results.emplace_back();
  result.technique = technique;
  result.frames.push_back(frame);
  return result;
}

FrameReport frame_with(const std::vector<StageCounters>& stages) {
  FrameReport frame;
  frame.stages = stages;
  return frame;
}

// Our number of the claim with this name.
std::optional<double> ours(const Report& report, const std::string& name) {
  for (const Claim& claim : all_claims(report))
    if (claim.name == name) return claim.ours;
  ADD_FAILURE() << "no claim " << name;
  return {};
}

std::string mismatch(const std::vector<PublishedFigure>& figures, const std::vector<Formula>& formulas) {
  return message_of<std::logic_error>([&] { expect_formulas_match(figures, formulas); });
}

TEST(Formulas, EachIsNamedByAFigureAndEachFigureNamesOneThatIsThere) {
  const std::vector<PublishedFigure> figures = published_figures();
  std::vector<Formula> formulas = our_formulas();
  EXPECT_EQ(mismatch(figures, formulas), "no error");

  const Formula last = formulas.back();
  formulas.pop_back();
  EXPECT_TRUE(mismatch(figures, formulas).ends_with(": there is no formula " + last.id)) << mismatch(figures, formulas);
  formulas.push_back(last);
  formulas.push_back(last);
  EXPECT_EQ(mismatch(figures, formulas), "claims: there are two formulas " + last.id);
  formulas.back().id = "beam.beauty";
  EXPECT_EQ(mismatch(figures, formulas), "claims: no published figure names the formula beam.beauty");

  std::vector<PublishedFigure> quotient(1);
  quotient[0].name = "half", quotient[0].numerator = "one", quotient[0].denominator = "two";
  EXPECT_EQ(mismatch(quotient, {}), "claims: \"half\": there is no claim \"one\" before it");
}

TEST(Formulas, OfEveryPassAreModelledTimesOfItsStages) {
  Report report = report_for("low density, DVM, Material");
  report.hardware = titan_v();
  StageCounters shade{StageId::shade}, light{StageId::light};
  shade.dram_bytes = 1'000'000, light.dram_bytes = 3'000'000;
  TechniqueReport& result = add_result(report, "dvm:clamp=camera", frame_with({shade, light}));
  const double megabyte = 1'000'000 / (448.7 * 0.77) / 1455e3;
  EXPECT_DOUBLE_EQ(ours(report, "low density, DVM, Material").value(), megabyte);
  EXPECT_DOUBLE_EQ(ours(report, "low density, DVM, Lighting").value(), 3 * megabyte);
  EXPECT_DOUBLE_EQ(ours(report, "low density, DVM, all passes").value(), 4 * megabyte);
  EXPECT_FALSE(ours(report, "low density, DVM, Motion"));
  EXPECT_FALSE(ours(report, "low density, Deferred, Material"));
  EXPECT_FALSE(ours(report, "high density, DVM, Material"));
  report.made_by = report_for("high density, DVM, Material").made_by;
  EXPECT_DOUBLE_EQ(ours(report, "high density, DVM, Material").value(), megabyte);
  EXPECT_FALSE(ours(report, "high density, brute-force supersampling of visibility, 8x, Material and Lighting"));
  result.technique = "visibility:8";
  EXPECT_DOUBLE_EQ(
      ours(report, "high density, brute-force supersampling of visibility, 8x, Material and Lighting").value(),
      4 * megabyte);
  result.technique = "dvm:clamp=camera";
  EXPECT_TRUE(ours(report, "high density, DVM, Material"));
  report.memory.modelled = false;
  EXPECT_FALSE(ours(report, "high density, DVM, Material"));
}

// Every stage of a path belongs to one pass. A stage of 2^i megabytes shows where it went.
TEST(Formulas, ThePassesAddUpToTheTotal) {
  const Hardware titan = titan_v();
  const double megabyte = 1'000'000 / (448.7 * 0.77) / 1455e3;
  const Trace trace = random_trace(16, 16, 20, 2);
  for (const auto& [name, spec] :
       std::map<std::string, std::string>{{"Forward", "taa:8,shading=forward"},
                                          {"Msaa 4x", "msaa:4,prepass,motion,resolve=reinhard"},
                                          {"Deferred", "taa:8,shading=deferred"},
                                          {"Visibility", "taa:8"},
                                          {"DVM", "dvm:clamp=camera"}}) {
    Report report = report_for("low density, DVM, all passes");
    report.hardware = titan;
    std::vector<StageCounters> stages;
    for (const StageCounters& stage : parse_technique(spec).render(trace, 0, {1}).stages) {
      stages.push_back(StageCounters{stage.stage});
      stages.back().dram_bytes = 1'000'000ull << stages.size();
    }
    add_result(report, spec, frame_with(stages));
    double passes = 0, total = 0;
    for (const Claim& claim : all_claims(report)) {
      if (!claim.ours || !claim.name.starts_with("low density, " + name + ", ") || claim.unit != "ms") continue;
      (claim.name.ends_with(", all passes") ? total : passes) += *claim.ours;
    }
    EXPECT_NEAR(total, megabyte * ((2ull << stages.size()) - 2), 1e-6 * total) << name;
    EXPECT_NEAR(passes, total, 1e-6 * total) << name;
  }
}

// ---- Claims ----

TEST(Claims, SayWhyThereIsNoNumberOfOurs) {
  int without = 0;
  for (const PublishedFigure& figure : published_figures()) {
    const bool none = figure.formula.empty() && figure.numerator.empty();
    without += none;
    EXPECT_EQ(none, figure.remark.starts_with("none: ")) << figure.name;
  }
  EXPECT_GT(without, 0);
  EXPECT_LE(without, 10);
}

// The pass at high density is divided by the one at low density, which another report has.
TEST(Claims, AreQuotientsOfClaimsOfSeveralReports) {
  std::vector<Claim> claims = all_claims({});
  const auto claim = [&](const std::string& name) -> Claim& {
    return *std::find_if(claims.begin(), claims.end(), [&](const Claim& each) { return each.name == name; });
  };
  const std::string over_low = "high density, Forward, forward pass over Forward's at low density";
  claim("high density, Forward, Material").ours = 6;
  find_quotients(claims);
  EXPECT_FALSE(claim(over_low).ours);
  claim("low density, Forward, Material").ours = 1.5;
  claim("high density, Forward, invocations for each one that is needed (quads)").ours = 3.2;
  find_quotients(claims);
  EXPECT_EQ(claim(over_low).ours, 4);
  EXPECT_EQ(claim("high density, cost of an invocation over one at low density").ours, 1.25);
}

TEST(Claims, AreCounted) {
  const Claim formula{"a", "", 1, 1, 2, "", "", ""}, constant{"b", "", 1, 1, 1, "", "", "", true},
      none{"c", "", 1, 1, {}, "", "", "none: why"};
  const std::string text = claims_text({formula, constant, none});
  EXPECT_TRUE(text.ends_with("Of 2 claims with a number of ours, 1 hold within 10 per cent.\n")) << text;
  EXPECT_LT(text.find("  a "), text.find("True by definition"));
  EXPECT_GT(text.find("  b "), text.find("True by definition"));
  EXPECT_EQ(claim_form().write(constant)["kind"].get<std::string>(), "true by definition");
  EXPECT_EQ(claim_form().write(formula)["kind"].get<std::string>(), "rendered");
}

TEST(Claims, OfTimesAreThereForEachImplementation) {
  Report report;
  report.hardware = titan_v();
  report.hardware.implementations.resize(1);
  report.hardware.implementations[0].name = "relays";
  const auto names = [&] {
    std::set<std::string> found;
    for (const Claim& claim : all_claims(report))
      if (claim.name.starts_with("msaa:32 / casav, time")) found.insert(claim.name);
    return found;
  };
  EXPECT_EQ(names(), std::set<std::string>{"msaa:32 / casav, time, casav as relays"});
  report.hardware = {};
  EXPECT_EQ(names(), (std::set<std::string>{"msaa:32 / casav, time, casav as shaders",
                                            "msaa:32 / casav, time, casav as fixed_function"}));
}

// Without a report there are the numbers that need no rendering.
TEST(Claims, BytesPerPixelAreThePublishedOnes) {
  const std::vector<Claim> claims = answered_claims({});
  EXPECT_GE(claims.size(), 20u);
  for (const Claim& claim : claims) {
    const double published = std::clamp(*claim.ours, claim.published_low, claim.published_high);
    EXPECT_NEAR(*claim.ours, published, claim.unit == "MiB" ? 0.5 : 0.001) << claim.name;
    EXPECT_TRUE(claim.by_definition) << claim.name;
  }
}

TEST(Claims, HaveDistinctNamesAndCommandsThatRun) {
  std::set<std::string> names;
  for (const Claim& claim : all_claims({})) {
    EXPECT_TRUE(names.insert(claim.name).second) << claim.name;
    EXPECT_FALSE(claim.source.empty()) << claim.name;
    EXPECT_EQ(claim.command.rfind("beampipe ", 0), 0u) << claim.command;
    for (const char* placeholder : {"TRACE", "SPEC", "DIR"})
      EXPECT_EQ(claim.command.find(placeholder), std::string::npos) << claim.command;
    EXPECT_TRUE(claim.published_low <= claim.published_high) << claim.name;
    const std::size_t technique = claim.command.rfind(" -t ");
    if (technique == std::string::npos) continue;
    const std::size_t end = claim.command.find(' ', technique + 4);
    EXPECT_NO_THROW(parse_technique(claim.command.substr(technique + 4, end - technique - 4))) << claim.command;
  }
  EXPECT_GT(names.size(), 150u);
}

TEST(Claims, HoldWithinTenPerCentOfTheNearerEnd) {
  Claim claim{"", "", 24, 32, 40, "", "", ""};
  EXPECT_EQ(claim.per_cent(), 25);
  EXPECT_EQ(claim.holds(), false);
  for (const auto& [ours, per_cent, holds] : {std::tuple{18.0, -25.0, false},
                                              {21.75, -9.375, true},
                                              {24.0, 0.0, true},
                                              {30.0, 0.0, true},
                                              {34.0, 6.25, true}}) {
    claim.ours = ours;
    EXPECT_EQ(claim.per_cent(), per_cent) << ours;
    EXPECT_EQ(claim.holds(), holds) << ours;
  }
  claim.published_low = claim.published_high = 0;
  EXPECT_EQ(claim.per_cent(), INFINITY);
  EXPECT_EQ(claim.holds(), false);
  EXPECT_TRUE(claim_form().write(claim)["per_cent"].is_null());
  EXPECT_FALSE(claim_form().write(claim)["holds"].get<bool>());
  claim.ours.reset();
  EXPECT_FALSE(claim.per_cent());
  EXPECT_FALSE(claim.holds());
  EXPECT_TRUE(claim_form().write(claim)["holds"].is_null());
  EXPECT_TRUE(claim_form().write(claim)["ours"].is_null());
}

// The lines of the text that belong to this claim.
std::string line_of(const std::string& text, const std::string& name) {
  const std::size_t from = text.find("  " + name + "  ");
  return from == text.npos ? "" : text.substr(from, text.find('\n', from) - from);
}

TEST(Claims, StandBelowTheirCommandOnce) {
  const std::vector<Claim> claims = all_claims({});
  const std::string text = "\n\n" + claims_text(claims);
  std::size_t last = 0;
  for (const Claim& claim : claims) {
    EXPECT_TRUE(line_of(text, claim.name).ends_with(claim.source)) << claim.name;
    if (claim.by_definition) continue;
    const std::string title = "\n\n" + claim.command + "\n";
    const std::size_t command = text.find(title);
    ASSERT_NE(command, text.npos) << claim.command;
    EXPECT_EQ(text.find(title, command + 1), text.npos) << claim.command;
    last = std::max(last, command);
  }
  EXPECT_LT(last, text.find("True by definition"));
}

TEST(Claims, SayInNotesWhatOursIsAndWhyItDiffers) {
  Claim above{"above", "ms", 1, 2, 2.5, "page 1", "run", "a kind of time", false, "we are slow"};
  Claim within{"within", "ms", 1, 2, 1.5, "page 2", "run", "a kind of time", false, "we are slow"};
  const std::string text = claims_text({above, within});
  EXPECT_TRUE(text.starts_with("run\n")) << text;
  EXPECT_NE(line_of(text, "above").find("1 to 2   2.5        25  no     ms    (1) (2)  page 1"), std::string::npos)
      << text;
  EXPECT_EQ(line_of(text, "within").find("(2)"), std::string::npos) << "it does not differ:\n" << text;
  expect_parts(text, {"  (1) a kind of time\n  (2) why: we are slow\n"});
  EXPECT_EQ(claim_form().write(above)["reason"].get<std::string>(), "we are slow");
}

// Times are shorter than the published ones everywhere, and other numbers differ for stated reasons.
TEST(Claims, ThatNeedRenderingHaveAReasonToDiffer) {
  std::set<std::string> without;
  for (const Claim& claim : all_claims({}))
    if (!claim.by_definition && claim.reason.empty() && !claim.beside.starts_with("none: ")) without.insert(claim.name);
  EXPECT_EQ(without,
            (std::set<std::string>{"ACAA, part of MSAA's frame time that is saved",
                                   "ACAA, part of MSAA's off-chip traffic that is saved (abstract)",
                                   "classroom, most fragments of a pixel",
                                   "two triangles per pixel, msaa:1,prepass, invocations per pixel",
                                   "two triangles per pixel, msaa:8,prepass, invocations per pixel",
                                   "two triangles per pixel, part of the triangles that cover no pixel's centre"}))
      << "these are the numbers that do not differ";
}

// MSAA adds 30 bytes to those of one sample per pixel, and ACAA saves half of them.
TEST(Claims, AcaaGivesBack) {
  const std::string name = "ACAA, part of what MSAA adds to 1x in framebuffer traffic that is saved";
  Report report = report_for(name);
  const auto add = [&](const char* spec, std::uint64_t dram) {
    StageCounters setup{StageId::vertex_setup}, raster{StageId::sample_raster}, testing{StageId::depth_test},
        resolving{StageId::resolve};
    setup.dram_bytes = 1000, raster.dram_bytes = 2000, testing.dram_bytes = dram - 5, resolving.dram_bytes = 5;
    add_result(report, spec, frame_with({setup, raster, testing, resolving}));
  };
  add("msaa:1,prepass", 10);
  EXPECT_FALSE(ours(report, name));
  change_frames(report.results[0], [](FrameReport& frame, std::size_t) {
    frame.stages.push_back(StageCounters{{StageId::depth_test, Pass::prepass}});
  });
  EXPECT_FALSE(ours(report, name));
  add("msaa:8,color=rgba16f,prepass", 40);
  add("acaa:8", 25);
  EXPECT_EQ(ours(report, name), 0.5);
  // Of the 40 bytes that depth and colour move in MSAA, and of all, with geometry.
  EXPECT_EQ(ours(report, "ACAA, part of MSAA's framebuffer traffic that is saved (section 1)"), 15.0 / 40);
  EXPECT_EQ(ours(report, "ACAA, part of MSAA's off-chip traffic that is saved (abstract)"), 15.0 / 3040);
}

// Two stages whose only work is DRAM traffic. ACAA saves half of what MSAA adds to the second one.
TEST(Claims, AcaaGivesBackTime) {
  const std::string all = "ACAA, part of MSAA's frame time that is saved";
  Report report = report_for(all);
  report.hardware = titan_v();
  const auto add = [&](const char* spec, std::uint64_t dram) {
    StageCounters setup{StageId::vertex_setup}, testing{StageId::depth_test};
    setup.dram_bytes = 1'000'000, testing.dram_bytes = dram;
    add_result(report, spec, frame_with({setup, testing}));
  };
  add("msaa:1,prepass", 1'000'000), add("msaa:8,color=rgba16f,prepass", 3'000'000), add("acaa:8", 2'000'000);
  for (const char* how : {"", ", stages in turn"}) {
    EXPECT_NEAR(ours(report, all + how).value(), 0.25, 1e-12) << how;
    EXPECT_NEAR(
        ours(report, "ACAA, part of what MSAA adds to 1x in frame time that is saved" + std::string(how)).value(), 0.5,
        1e-12)
        << how;
  }
}

// 42 bytes of framebuffer and 418 of A-buffer, over 80.
TEST(Claims, BytesOfTheBeamWithItsABuffer) {
  const std::string name = "classroom, casav with its A-buffer, bytes over those of MSAA 8x";
  Report report = report_for(name);
  FrameReport frame;
  frame.pixels = 10, frame.a_buffer_peak_bytes = 4180;
  add_result(report, "casav", frame);
  EXPECT_EQ(ours(report, name), 5.75);
}

TEST(Claims, MostFragmentsOfAPixelAreThoseOfTheClassroomWhateverItsFileIsCalled) {
  const std::string name = "classroom, most fragments of a pixel";
  Report report;
  FrameReport frame;
  frame.pixel_counters["fragments"] = {2.5, 61};
  add_result(report, "casav", frame);
  const auto most = [&] { return ours(report, name); };
  report.trace = "some/classroom.json";
  EXPECT_FALSE(most()) << "the name of a file is not enough";
  report.made_by = {{"trace", "0123456789abcdef"}};
  EXPECT_FALSE(most()) << "another trace";
  report.trace = "some/room_7.json";
  report.made_by = report_for(name).made_by;
  EXPECT_EQ(most(), 61);
}

}  // namespace beampipe::claims_test

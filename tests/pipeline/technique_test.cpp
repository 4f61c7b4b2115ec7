#include "pipeline/technique.h"

#include "pipeline/technique_table.h"
#include "tests/message_of.h"
#include "tests/test.h"

namespace beampipe::technique_test {

// With pixels in memory. The published ones are claims (tools/claims/published/), which have a test. A round of ACAA
// has 16 samples at most.
TEST(Technique, FramebufferBytes) {
  const std::map<std::uint32_t, std::vector<const char*>> specs_of_bytes = {
      {10, {"alpha"}},
      {32, {"casav:storage=text"}},
      {42, {"beam:order=sorted", "casav"}},
      {46, {"beam"}},
      {48, {"acaa:8,double=stencil"}},
      {50, {"z3"}},
      {72, {"acaa:16", "acaa:256"}},
      {74, {"z3:shape=128x3"}},
      {96, {"beam:order=stream", "msaa:8,color=rgba16f"}},
      {320, {"msaa:32"}}};
  for (const auto& [bytes, specs] : specs_of_bytes)
    for (const char* const spec : specs)
      EXPECT_EQ(parse_technique(spec).framebuffer_bytes_per_pixel({.framebuffer = Place::in_memory}), bytes) << spec;
}

TEST(Technique, EveryMsaaRateOfTheRangeIsKnown) {
  for (std::uint32_t samples = 1; samples <= 1024; samples *= 2) {
    const std::string spec = std::string("msaa:").append(std::to_string(samples));
    EXPECT_EQ(parse_technique(spec).samples, samples);
    EXPECT_EQ(parse_technique(spec).spec, spec);
  }
}

// The error of a wrong spec, which must be one line that names the spec; without "technique 'SPEC': ".
std::string error_of(const std::string& spec) {
  const std::string message = message_of<SpecError>([&] { parse_technique(spec); });
  const std::string start = "technique '" + spec + "': ";
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_EQ(message.rfind(start, 0), 0u) << message;
  return message.substr(std::min(start.size(), message.size()));
}

TEST(Technique, WrongSpecsSayWhatWouldBeRight) {
  std::vector<std::string> all;
  for (const TechniqueKind& kind : technique_kinds())
    if (all.empty() || all.back() != kind.name) all.push_back(kind.name);
  const std::string names = "the name must be " + list_of(all);
  const std::string msaa_rates = "N of msaa:N must be 1, 2, 4, 8, 16, 32, 64, 128, 256, 512 or 1024";
  const std::string acaa_rates = "N of acaa:N must be 1, 2, 4, 8, 16, 32, 64, 128 or 256";
  const std::string taa_rates = "N of taa:N must be 1, 2, 4, 8 or 16";
  const std::string of_beam = "; it has bits, pool, at, tolerance, alpha, bin, order and filter";
  const std::string of_casav =
      "; it has reading, mask, depths, sort, tiny, overlap, regional, fuzzy, extents, slab, plane, thickness, storage, "
      "order, layers and filter";
  const std::string of_dvm = "; it has blend, material, clamp, extra and filter";
  const std::map<std::string, std::vector<const char*>> specs_of_error = {
      {names, {"", "wireframe"}},
      {names + " (did you mean 'beam'?)", {"bean", "beam ", "bean:bits=64"}},
      {"msaa:N has no option 'prepas' (did you mean 'prepass'?); it has color, at, alpha, blend, prepass, motion, "
       "resolve and "
       "filter",
       {"msaa:8,prepas"}},
      {msaa_rates,
       {"msaa", "msaa:", "msaa:3", "msaa:0", "msaa:08", "msaa:-8", "msaa:8x", "msaa:N=8", "msaa:2048", "msaa:prepass",
        "msaa:prepass,8"}},
      {"'8' is there twice", {"msaa:8,8"}},
      {"msaa:N has no option '16'; it has color, at, alpha, blend, prepass, motion, resolve and filter", {"msaa:8,16"}},
      {"msaa:N has no option ''; it has color, at, alpha, blend, prepass, motion, resolve and filter", {"msaa:8,"}},
      {"msaa:N has no option 'N'; it has color, at, alpha, blend, prepass, motion, resolve and filter", {"msaa:8,N=8"}},
      {"color must be rgb16f, rgba16f, rgba8 or rgba32f", {"msaa:8,color"}},
      {"'prepass' is there twice", {"msaa:8,prepass,prepass"}},
      {"prepass must be without a value", {"msaa:8,prepass=1"}},
      {"beam has no option ''" + of_beam, {"beam:"}},
      {"beam:order=sorted has no option 'mask'; it has bits, window, order and filter",
       {"beam:order=sorted,bits=32,mask=exact"}},
      {"bits must be 32 or 256", {"beam:order=sorted,bits="}},
      {"filter must be sampler, anisotropic, 1, 4 or 16", {"beam:filter=2", "msaa:8,filter=", "alpha:filter=yes"}},
      {"tolerance needs at=adaptive", {"beam:at=visible,tolerance=0.1"}},
      {"'order' is there twice", {"beam:order=stream,order=sorted"}},
      {"beam:order=stream has no option 'pool'; it has bits, order and filter", {"beam:order=stream,pool=16"}},
      {"layers needs order=near-first or order=stream", {"casav:layers=3", "casav:order=sorted,layers=1"}},
      {"sort needs order=sorted", {"casav:order=stream,sort=nearest", "casav:order=near-first,sort=centroid"}},
      {"casav has no option 'bits'" + of_casav, {"casav:bits=64"}},
      {"z3 has no option 'layers'; it has shape and filter", {"z3:layers=3"}},
      {"alpha has no option '1'; it has filter", {"alpha:1"}},
      {"reference has no option '64'; it has samples, set and filter", {"reference:64"}},
      {"deferred has no option ''; it has filter", {"deferred:"}},
      {acaa_rates, {"acaa", "acaa:512"}},
      {"N of visibility:N must be 1, 2, 4, 8 or 16", {"visibility:3", "visibility:"}},
      {"'4' is there twice", {"visibility:4,4"}},
      {"visibility:N has no option '8'; it has filter", {"visibility:4,8"}},
      {taa_rates, {"taa", "taa:32"}},
      {"blend must be a number from 0.001 to 1",
       {"taa:8,blend=0", "taa:8,blend=1.5", "taa:8,blend=nan", "taa:8,blend=x", "taa:8,blend=0.5x"}},
      {"dvm has no option '8'" + of_dvm, {"dvm:8"}},
      {"dvm has no option ''" + of_dvm, {"dvm:=8"}}};
  for (const auto& [error, specs] : specs_of_error)
    for (const char* const spec : specs) EXPECT_EQ(error_of(spec), error);
}

// A spec with samples, where the technique needs them, one option, and what the option needs: "msaa:8,at=centroid".
std::string spec_with(const TechniqueKind& kind, const SpecOption& option, const std::string& word) {
  std::string spec = title_of(kind);
  if (spec.ends_with(":N")) spec.replace(spec.size() - 1, 1, "8");
  spec += (spec.find(':') == spec.npos ? ':' : ',') + option.key + '=' + word;
  const std::string needed = option.needs.substr(0, option.needs.find_first_of(" ,"));
  return needed.empty() ? spec : spec + ',' + needed;
}

SpecOptions options_of(const TechniqueKind& kind) {
  SpecOptions options;
  kind.make([&](const SpecOptions& all) { options = all; });
  return options;
}

TEST(TechniqueTable, EveryWordIsTakenAndNoOther) {
  std::size_t words = 0;
  for (const TechniqueKind& kind : technique_kinds()) {
    for (const SpecOption& option : options_of(kind)) {
      if (option.form != SpecOption::Form::value) continue;
      for (const std::string& word : option.words) {
        const std::string spec = spec_with(kind, option, word);
        EXPECT_EQ(parse_technique(spec).spec, spec);
        EXPECT_NE(option.expected.find(word), std::string::npos) << option.expected;
        ++words;
      }
      EXPECT_EQ(error_of(spec_with(kind, option, "other")), option.key + " must be " + option.expected);
    }
  }
  EXPECT_GT(words, 50u);
}

TEST(TechniqueTable, ExamplesAreSpecsOfTheirTechnique) {
  for (const TechniqueKind& kind : technique_kinds()) {
    ASSERT_FALSE(kind.examples.empty()) << title_of(kind);
    for (const std::vector<std::string>* const specs : {&kind.examples, &kind.stressed})
      for (const std::string& spec : *specs) {
        EXPECT_EQ(parse_technique(spec).spec, spec);
        EXPECT_EQ(spec.substr(0, spec.find(':')), kind.name);
      }
  }
}

TEST(TechniqueTable, DefaultsAreAmongTheValues) {
  for (const TechniqueKind& kind : technique_kinds()) {
    for (const SpecOption& option : options_of(kind)) {
      if (option.form != SpecOption::Form::value || option.words.empty()) continue;
      EXPECT_EQ(std::count(option.words.begin(), option.words.end(), option.fallback), 1)
          << title_of(kind) << ", " << option.key << ": '" << option.fallback << "'";
    }
  }
}

TEST(TechniqueTable, HelpNamesEveryTechniqueAndOption) {
  const std::string help = technique_help();
  for (const TechniqueKind& kind : technique_kinds()) {
    EXPECT_NE(help.find("\n  " + title_of(kind) + "\n    "), std::string::npos) << title_of(kind);
    for (const SpecOption& option : options_of(kind)) EXPECT_NE(help.find("      " + option.usage), std::string::npos);
  }
  EXPECT_NE(help.find("bits=32|64|128|256"), std::string::npos);
  EXPECT_NE(help.find("weight of each new frame (0.1)"), std::string::npos);
  for (std::size_t begin = 0; begin < help.size();) {
    const std::size_t end = help.find('\n', begin);
    EXPECT_LE(end - begin, 100u) << help.substr(begin, end - begin);
    begin = end + 1;
  }
}

// BEAMPIPE_WRITE_DOCS=1 writes the tables into the page in place of comparing them.
TEST(TechniqueTable, ThePageHasItsTables) {
  const std::filesystem::path file = std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "docs/techniques.md";
  std::ifstream stream(file, std::ios::binary);
  std::string page{std::istreambuf_iterator<char>(stream), {}};
  const std::string first = "<!-- tables of pipeline/technique_table.cpp: begin -->\n";
  const std::string last = "<!-- tables of pipeline/technique_table.cpp: end -->\n";
  const std::size_t begin = page.find(first) + first.size(), end = page.find(last);
  ASSERT_NE(page.find(first), std::string::npos);
  ASSERT_NE(end, std::string::npos);
  if (std::getenv("BEAMPIPE_WRITE_DOCS")) {
    page.replace(begin, end - begin, technique_tables());
    std::ofstream(file, std::ios::binary) << page;
  } else {
    EXPECT_EQ(page.substr(begin, end - begin), technique_tables());
  }
}

}  // namespace beampipe::technique_test

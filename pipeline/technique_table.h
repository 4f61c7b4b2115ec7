// The table of techniques: what each is called, what it is, where it comes from, and its options. Specs are parsed by
// it; the errors, --help and the list in docs/techniques.md are written from it.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/bins/threads.h"
#include "pipeline/spec.h"
#include "pipeline/technique.h"

namespace beampipe {

// "key=word" in a spec chooses this one of the techniques that share a name.
struct Variant {
  std::string key, word;
};

struct TechniqueKind {
  std::string name;
  Variant variant = {};     // empty: the only technique of this name. The first one in the table is the default.
  std::string description;  // one line, no full stop
  std::string source;       // "ours", or who published it and when
  // Specs that together take every way through its code. What is asked of every technique is asked of these, in tests,
  // digests and docs.
  std::vector<std::string> examples;
  int texture_taps = 0;                    // ShadingRules::texture_taps, unless the spec says otherwise
  std::vector<std::string> stressed = {};  // specs that `beampipe stress` compares with exact arithmetic
  std::vector<std::string> counters = {};  // of its pixels, besides `fragments` and `bytes` (counter_registry.h)
  // Identifies code outside the program that makes the pictures, so that results of other code are not taken for its
  // own; empty: there is none.
  std::string code = {};
  // Gives the options, bound to variables that have their defaults, to `read`, which may set them. Then makes the
  // technique from these variables, without its spec.
  std::function<Technique(const std::function<void(const SpecOptions&)>& read)> make;
};

// Those of beampipe, in the order of --help and the docs.
const std::vector<TechniqueKind>& built_in_kinds();

// Those that specs can name: the built-in ones, unless a program that has techniques of its own defines this function
// itself (docs/manual.md).
const std::vector<TechniqueKind>& technique_kinds();

// The option that every technique has.
SpecOption filter_option(int& texture_taps);

// The specs of all techniques.
std::vector<std::string> example_specs();
std::vector<std::string> stressed_specs();

// "beam", "beam:order=stream", "msaa:N".
std::string title_of(const TechniqueKind& kind);

// Two tables in Markdown, for docs/techniques.md: all techniques, and all of their options.
std::string technique_tables();

// TechniqueKind::make for a technique whose options are a struct. `bind(options)` returns the options that a spec can
// set, and `build(options)` makes the technique.
template <class Options, class Bind, class Build>
auto make_from(Options defaults, Bind bind, Build build) {
  return [=](const std::function<void(const SpecOptions&)>& read) {
    Options options = defaults;
    read(bind(options));
    return build(options);
  };
}

// The same for a technique without options.
template <class Build>
auto make_plain(Build build) {
  return [=](const std::function<void(const SpecOptions&)>& read) {
    read({});
    return build();
  };
}

// Technique::renderer from a function of the job and, if the technique has any, its options. It runs on as many threads
// as FrameInput says.
template <class Render, class... Options>
auto bind_options(Render* render, const Options&... options) {
  return [=](const Trace& trace, std::size_t frame, const FrameInput& run, const FrameSinks& sinks) {
    const FrameJob job{trace, trace.frames.at(frame), run, sinks};
    return on_threads(run.threads, [&] { return render(job, options...); });
  };
}

}  // namespace beampipe

// What `run` and `compare` are to render.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/technique.h"
#include "stages/geometry/draw_notes.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/picture_cache.h"
#include "traces/trace.h"

namespace beampipe {

struct RunPlan {
  std::string trace_file;    // as the user named it
  std::string command_line;  // the one that asks for it; empty if none does
  Trace trace;
  std::vector<Technique> techniques;
  std::vector<std::size_t> frames;      // indices into the trace, rising
  std::vector<std::size_t> unmeasured;  // those before them, which only techniques with a history render
  int repeat = 1;
  Hardware hardware = titan_v();
  std::string shading_options;                 // as on the command line, with a blank before each
  std::shared_ptr<const TextureSet> textures;  // of the trace
  FrameInput options;                          // `threads` is the actual number, never 0
  FrameSinks sinks;
  std::vector<DrawNote> notes;                   // of `frames`
  std::shared_ptr<const PictureCache> pictures;  // of the reference; null: none are kept
};

inline std::vector<std::string> specs_of(const std::vector<Technique>& techniques) {
  std::vector<std::string> specs;
  for (const Technique& technique : techniques) specs.push_back(technique.spec);
  return specs;
}

}  // namespace beampipe

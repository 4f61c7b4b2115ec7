// Traces of the user's own models: the options of `make` and `preview` for them, and what these choose by themselves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/cli/command_line.h"
#include "traces/trace.h"

namespace beampipe {

// As the user wrote them.
struct ModelOptions {
  std::string view, camera;
  std::vector<double> eye, target, up, background, light;
  double fovy = 0, near = 0, far = 0, ambient = 0;
  bool unlit = false, follow_links = false;
  std::string materials = "textured", animation;
};

// `options` must live until the command line is parsed. Returns --animation, for what excludes it.
Option add_model_options(Command& command, ModelOptions& options);

// Throws UsageError, one line, if one of these options was given that only models have (all but --camera); or one that
// models of this kind do not have.
void require_no_model_options(const Command& command);
void require_options_of(const std::string& model, const Command& command);

// The frames that a model is to have.
struct ModelFrames {
  std::uint32_t width = 0, height = 0;
  std::uint32_t count = 1;
  bool move = false;  // the camera or the picture does, and the model does not, unless an animation is named
};

// A model as a trace: its camera (chosen, if it has none), its lights, its background. What was chosen and what is not
// read is said on standard error. Throws TraceError, and UsageError if there is no such camera.
Trace trace_of_model(const std::string& model, const ModelOptions& options, const Command& command,
                     const ModelFrames& frames);

// The camera of a trace made with these options, as options that make the same one: "--eye 3,2,5 --target 0,1,0 --fovy
// 36", and the planes that the user chose.
std::string text_of(const Camera& camera, const ModelOptions& options, const Command& command);

}  // namespace beampipe

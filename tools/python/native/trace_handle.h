// A trace that Python holds.
#pragma once

#include <memory>
#include <string>

#include "stages/surface/texture_set.h"
#include "tools/evaluate/picture_size.h"
#include "traces/trace.h"

namespace beampipe {

// Copies share the trace and its textures, which nothing changes.
class TraceHandle {
 public:
  // `name`: for messages.
  TraceHandle(Trace trace, std::string name)
      : trace_(std::make_shared<const Trace>(std::move(trace))),
        textures_(std::make_shared<const TextureSet>(*trace_, name)),
        name_(std::move(name)) {}

  const Trace& trace() const { return *trace_; }
  const TextureSet& textures() const { return *textures_; }
  const std::string& name() const { return name_; }

  // All frames in this size. Throws as resize() does.
  TraceHandle resized(const PictureSize& size) const;

 private:
  std::shared_ptr<const Trace> trace_;
  std::shared_ptr<const TextureSet> textures_;
  std::string name_;
};

// Throws std::runtime_error, one line, if there is no such frame.
const Frame& frame_of(const TraceHandle& trace, std::size_t frame);

}  // namespace beampipe

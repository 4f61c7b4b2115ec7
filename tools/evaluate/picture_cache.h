// Pictures of the reference, which take long to render and which many runs need again.
//
// A folder has two files for each: KEY.exr, and KEY.json with what made it, its counters, and digests of both files.
// KEY is a digest of all that a picture depends on: the program, the trace with its frames' sizes, the frame, the
// technique. A file that is damaged or belongs to something else is as good as none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/technique.h"
#include "tools/evaluate/frame_reports.h"
#include "traces/files/json.h"

namespace beampipe {

// The folder that the user names; if that is empty, $XDG_CACHE_HOME/beampipe/references, or the same in ~/.cache. Empty
// for "none", and if neither variable is set.
std::filesystem::path picture_cache_folder(const std::string& named);

struct KeptPicture {
  Image image;
  FrameReport report;  // its counters and times
};

class PictureCache {
 public:
  // The folder is made when a picture is kept; until it has more than `most_bytes`, all stay, and then those that were
  // used last.
  explicit PictureCache(std::filesystem::path folder, const Trace& trace,
                        std::uint64_t most_bytes = std::uint64_t{4} << 30);

  std::optional<KeptPicture> find(const std::string& spec, std::size_t frame, SurfaceColors colors) const;

  // Does nothing if the folder cannot be written.
  void keep(const std::string& spec, std::size_t frame, SurfaceColors colors, const KeptPicture& picture) const;

 private:
  Json key_of(const std::string& spec, std::size_t frame, SurfaceColors colors) const;
  void remove_oldest() const;

  std::filesystem::path folder_;
  std::string program_, trace_;  // digests
  std::uint64_t most_bytes_;
};

}  // namespace beampipe

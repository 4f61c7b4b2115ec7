#include "tools/evaluate/picture_cache.h"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "tools/evaluate/frame_json.h"
#include "tools/files/digest.h"
#include "tools/files/image_io.h"
#include "tools/files/sealed_json.h"
#include "traces/files/atomic_file.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

void write_file(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace

fs::path picture_cache_folder(const std::string& named) {
  if (!named.empty()) return named == "none" ? fs::path() : fs::path(named);
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  const char* const home = std::getenv("HOME");
  if (cache && *cache) return fs::path(cache) / "beampipe" / "references";
  return home && *home ? fs::path(home) / ".cache" / "beampipe" / "references" : fs::path();
}

PictureCache::PictureCache(fs::path folder, const Trace& trace, std::uint64_t most_bytes)
    : folder_(std::move(folder)),
      program_(program_digest()),
      trace_(digest_of(trace)),
      most_bytes_(most_bytes) {}

Json PictureCache::key_of(const std::string& spec, std::size_t frame, SurfaceColors colors) const {
  return {{"program", program_},
          {"trace", trace_},
          {"technique", spec},
          {"frame", std::uint64_t{frame}},
          {"by_pixel", colors == SurfaceColors::by_pixel}};
}

std::optional<KeptPicture> PictureCache::find(const std::string& spec, std::size_t frame, SurfaceColors colors) const {
  const Json key = key_of(spec, frame, colors);
  const fs::path stem = folder_ / digest_of(key.dump()), picture = stem.string() + ".exr";
  try {
    const Json json = unsealed(parse_json(stem.string() + ".json"));
    if (json.at("key") != key || json.at("picture") != digest_of_file(picture)) return std::nullopt;
    KeptPicture found{read_exr(picture), stored_frame(json.at("report"))};
    fs::last_write_time(picture, fs::file_time_type::clock::now());
    return found;
  } catch (const std::exception&) {  // there is none, or it is damaged
    return std::nullopt;
  }
}

void PictureCache::keep(const std::string& spec, std::size_t frame, SurfaceColors colors,
                        const KeptPicture& kept) const {
  const Json key = key_of(spec, frame, colors);
  const std::string stem = (folder_ / digest_of(key.dump())).string(), bytes = encode_exr(kept.image);
  try {
    fs::create_directories(folder_);
    write_file(stem + ".exr", bytes);
    write_file(stem + ".json",
               json_text(sealed({{"key", key}, {"picture", digest_of(bytes)}, {"report", stored_json(kept.report)}})));
    remove_oldest();
  } catch (const std::exception&) {  // a run is right without the cache
  }
}

void PictureCache::remove_oldest() const {
  std::vector<std::pair<fs::file_time_type, fs::path>> pictures;
  std::uint64_t bytes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    bytes += entry.file_size();
    if (entry.path().extension() == ".exr") pictures.emplace_back(entry.last_write_time(), entry.path());
  }
  std::ranges::sort(pictures);
  for (auto& [written, picture] : pictures) {
    if (bytes <= most_bytes_) return;
    for (const char* const extension : {".exr", ".json"}) {
      picture.replace_extension(extension);
      if (std::error_code none; fs::exists(picture, none)) bytes -= fs::file_size(picture);
      fs::remove(picture);
    }
  }
}

}  // namespace beampipe

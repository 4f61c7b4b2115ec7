#include "tools/sweep/sweep_store.h"

#include "tools/evaluate/results.h"
#include "tools/files/digest.h"
#include "tools/files/sealed_json.h"
#include "traces/files/trace_io.h"

namespace beampipe {

SweepStore::SweepStore(OutputFolder& output) : output_(output), program_(program_digest()) {}

Json SweepStore::full(const Json& key) const {
  return {{"version", program_version()}, {"program", program_}, {"of", key}};
}

std::string SweepStore::name_of(const std::string& kind, const Json& full_key) {
  return kind + "/" + digest_of(full_key.dump()) + ".json";
}

std::optional<Json> SweepStore::read(const std::string& kind, const Json& key) const {
  const Json full_key = full(key);
  const std::filesystem::path file = output_.path() / name_of(kind, full_key);
  if (std::error_code ignored; !std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  try {
    const Json json = unsealed(parse_json(file.string()));
    const Json* result = json.find("result");
    if (!result || !json.contains("key") || json.at("key") != full_key) return std::nullopt;
    return *result;
  } catch (const TraceError&) {  // damaged
    return std::nullopt;
  }
}

void SweepStore::write(const std::string& kind, const Json& key, const Json& result) {
  const Json full_key = full(key);
  const Json json = {{"beampipe_sweep_result", 1}, {"key", full_key}, {"result", result}};
  const std::lock_guard lock(mutex_);
  output_.write(name_of(kind, full_key), sealed(json).dump() + "\n");
  output_.keep();
}

}  // namespace beampipe

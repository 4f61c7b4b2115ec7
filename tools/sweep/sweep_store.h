// What a sweep has found out so far: one file for each result, under a name that says what the result depends on.
//
// A file appears when it is complete, and is not changed any more. So a sweep that was killed goes on where it was, any
// number of programs may work on the same folder, and results of other plans, traces or builds are never taken for
// those that are wanted.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "tools/files/output.h"
#include "traces/files/json.h"

namespace beampipe {

class SweepStore {
 public:
  explicit SweepStore(OutputFolder& output);

  // `kind`: the name of a subfolder. `key`: everything that the result depends on, besides the program. A file that is
  // missing, damaged in any byte, or holds another key, is no result.
  std::optional<Json> read(const std::string& kind, const Json& key) const;

  // Thread-safe. Throws std::runtime_error, one line.
  void write(const std::string& kind, const Json& key, const Json& result);

 private:
  Json full(const Json& key) const;
  static std::string name_of(const std::string& kind, const Json& full_key);

  OutputFolder& output_;
  std::string program_;  // its digest
  std::mutex mutex_;
};

}  // namespace beampipe

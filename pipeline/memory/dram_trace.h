// The DRAM requests of a frame, in one address space and in the order in which the modelled machine makes them: pass by
// pass over the frame, in each pass bin by bin.
//
// Bins hand over their logs in any order, from any thread. Runs of sectors wait in a temporary file without a name, so
// memory holds little more than the place of each bin's runs.
//
// Addresses: the arrays of the frame lie one after the other, then those of bins, each group in the order of their
// names. In an array of bins, the parts follow one another in the order of bins. Arrays and parts begin at multiples of
// 256 bytes, the largest block that a cache moves.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/memory/dram_log.h"

namespace beampipe {

// One sector.
struct DramRequest {
  std::uint64_t address = 0;
  DramAccess access = DramAccess::read;
  std::string_view stage;
  const std::string& array;
};

class DramTrace {
 public:
  // `sector_bytes`: of the memory system whose requests these are. The temporary file is in `folder`. All functions
  // that use it throw std::runtime_error, one line that names the folder, if it cannot be created, written or read.
  explicit DramTrace(const std::filesystem::path& folder, std::uint32_t sector_bytes = MemoryParameters{}.sector_bytes);

  // What a part of the frame does in a pass comes in the order of these.
  enum class Step : std::uint8_t { setup, binning, lists, bin, texels };

  // Runs of the log's pass `log_pass` become part of the frame's pass `pass`. Thread-safe.
  void add(const DramLog& log, std::uint32_t log_pass, std::uint32_t pass, Step step, std::size_t bin);

  // Every pass of a log, from the frame's pass `first` on.
  void add(const DramLog& log, std::uint32_t first, std::size_t bin);

  // A pass over the geometry: the frame's pass that it is part of, and whether it is the depth pre-pass's.
  struct GeometryPass {
    std::uint32_t pass;
    bool is_prepass;
  };

  // What was added at the given steps to the pass of passes[0] was recorded once, for all these passes over the
  // geometry. The others get a copy.
  void repeat(const std::vector<GeometryPass>& passes, Step first, Step last);

  // One more than the last pass that holds anything.
  std::uint32_t passes() const;

  // Calls visit(request) for every sector. To be called when no thread adds any more.
  void for_each(const std::function<void(const DramRequest&)>& visit) const;

  // An array's name and its address range [begin, end), in increasing order.
  struct Range {
    std::string name;
    std::uint64_t begin, end;
  };
  std::vector<Range> ranges() const;

 private:
  // Some runs in the file.
  struct Chunk {
    std::uint32_t pass;
    Step step;
    std::uint32_t bin;
    std::uint64_t first_run, runs;
    bool is_prepass = false;
    auto order() const {
      return std::pair(std::pair(pass, step == Step::setup || step == Step::binning ? step : Step::lists),
                       std::pair(bin, step));
    }
  };

  // What the logs call an array, and how many sectors of it there are: of the frame, or by bin.
  struct Array {
    std::string name;
    bool of_bins;
    std::vector<std::uint64_t> sectors;
  };

  // The first sector of each array, by number, of the frame or by bin; and the end of all.
  using Places = std::vector<std::vector<std::uint64_t>>;
  Places place(std::vector<Range>* ranges) const;
  std::uint16_t array_number(const DramArray& array, std::size_t bin);
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path folder_;
  std::uint64_t sector_bytes_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::mutex mutex_;
  std::uint64_t runs_ = 0;  // in the file
  std::vector<Chunk> chunks_;
  std::vector<Array> arrays_;
};

}  // namespace beampipe

#include "pipeline/memory/dram_trace.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <stdexcept>

namespace beampipe {
namespace {

constexpr std::uint64_t kAlignedSectors = kMaxBlockSectors;

std::uint64_t aligned(std::uint64_t sectors) {
  return (sectors + kAlignedSectors - 1) / kAlignedSectors * kAlignedSectors;
}

}  // namespace

DramTrace::DramTrace(const std::filesystem::path& folder, std::uint32_t sector_bytes)
    : folder_(folder), sector_bytes_(sector_bytes), file_(nullptr, std::fclose) {
  std::string name = folder / ".beampipe-XXXXXX";
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) fail("create");
  ::unlink(name.c_str());
  file_.reset(::fdopen(descriptor, "w+b"));
  if (!file_) fail("open");
}

void DramTrace::fail(const std::string& what) const {
  throw std::runtime_error(folder_.string() + ": cannot " + what +
                           " a temporary file in this folder: " + std::strerror(errno));
}

std::uint16_t DramTrace::array_number(const DramArray& array, std::size_t bin) {
  const auto found = std::find_if(arrays_.begin(), arrays_.end(), [&](const Array& a) { return a.name == array.name; });
  const auto number = static_cast<std::uint16_t>(found - arrays_.begin());
  if (found == arrays_.end()) arrays_.push_back({array.name, array.of_bins, {}});
  Array& known = arrays_[number];
  if (known.of_bins != array.of_bins)
    throw std::logic_error("the array " + array.name + " belongs to the frame and to bins");
  const std::size_t part = array.of_bins ? bin : 0;
  if (known.sectors.size() <= part) known.sectors.resize(part + 1);
  known.sectors[part] = std::max(known.sectors[part], array.sectors);
  return number;
}

void DramTrace::add(const DramLog& log, std::uint32_t log_pass, std::uint32_t pass, Step step, std::size_t bin) {
  std::vector<DramRun> runs = log.passes()[log_pass];
  const std::lock_guard lock(mutex_);
  std::vector<std::uint16_t> arrays;
  for (const DramArray& array : log.arrays()) arrays.push_back(array_number(array, bin));
  if (runs.empty()) return;
  for (DramRun& run : runs) run.array = arrays[run.array];
  if (std::fwrite(runs.data(), sizeof runs[0], runs.size(), file_.get()) != runs.size()) fail("write");
  chunks_.push_back({pass, step, static_cast<std::uint32_t>(bin), runs_, runs.size()});
  runs_ += runs.size();
}

void DramTrace::add(const DramLog& log, std::uint32_t first, std::size_t bin) {
  for (std::uint32_t pass = 0; pass < log.passes().size(); ++pass) add(log, pass, first + pass, Step::bin, bin);
}

void DramTrace::repeat(const std::vector<GeometryPass>& passes, Step first, Step last) {
  const std::size_t count = chunks_.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (chunks_[i].pass != passes[0].pass || chunks_[i].step < first || chunks_[i].step > last) continue;
    for (std::size_t p = passes.size(); p-- > 0;) {
      Chunk chunk = chunks_[i];
      chunk.pass = passes[p].pass, chunk.is_prepass = passes[p].is_prepass;
      if (p > 0) {
        chunks_.push_back(chunk);
      } else {
        chunks_[i] = chunk;
      }
    }
  }
}

std::uint32_t DramTrace::passes() const {
  std::uint32_t passes = 0;
  for (const Chunk& chunk : chunks_) passes = std::max(passes, chunk.pass + 1);
  return passes;
}

DramTrace::Places DramTrace::place(std::vector<Range>* ranges) const {
  std::vector<std::size_t> order(arrays_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(arrays_[a].of_bins, arrays_[a].name) < std::pair(arrays_[b].of_bins, arrays_[b].name);
  });
  Places places(arrays_.size());
  std::uint64_t end = 0;
  for (const std::size_t i : order) {
    const std::uint64_t begin = end;
    for (const std::uint64_t sectors : arrays_[i].sectors) {
      places[i].push_back(end);
      end += aligned(sectors);
    }
    if (ranges && end > begin) ranges->push_back({arrays_[i].name, begin * sector_bytes_, end * sector_bytes_});
  }
  return places;
}

std::vector<DramTrace::Range> DramTrace::ranges() const {
  std::vector<Range> ranges;
  place(&ranges);
  return ranges;
}

void DramTrace::for_each(const std::function<void(const DramRequest&)>& visit) const {
  const Places places = place(nullptr);
  std::vector<Chunk> chunks = chunks_;
  std::stable_sort(chunks.begin(), chunks.end(), [](const Chunk& a, const Chunk& b) { return a.order() < b.order(); });
  std::vector<DramRun> runs;
  for (const Chunk& chunk : chunks) {
    runs.resize(chunk.runs);
    if (::fseeko(file_.get(), static_cast<off_t>(chunk.first_run * sizeof(DramRun)), SEEK_SET) != 0 ||
        std::fread(runs.data(), sizeof(DramRun), runs.size(), file_.get()) != runs.size())
      fail("read");
    for (const DramRun& run : runs) {
      const Array& array = arrays_[run.array];
      Stage stage = Stage::of_number(run.stage);
      if (chunk.is_prepass) stage.pass = Pass::prepass;
      const std::uint64_t first = places[run.array][array.of_bins ? chunk.bin : 0] + run.first;
      for (std::uint64_t i = 0; i < run.sectors; ++i)
        visit({(first + i) * sector_bytes_, run.access, name_of(stage), array.name});
    }
  }
}

}  // namespace beampipe

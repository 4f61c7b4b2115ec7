// The modelled caches against stack distances, another algorithm for the same question (Mattson et al. 1970,
// "Evaluation Techniques for Storage Hierarchies"; dirty levels: Thompson and Smith 1989, "Efficient (Stack) Algorithms
// for Analysis of Write-Back and Sector Memories"). One look at a sequence of accesses gives the traffic of caches with
// any number of ways.

#include "pipeline/memory/block_cache.h"
#include "pipeline/memory/dram_trace.h"
#include "pipeline/memory/texture_memory.h"
#include "pipeline/technique.h"
#include "tests/pipeline/test_traces.h"
#include "tests/test.h"

namespace beampipe::stack_distance_test {

constexpr std::uint32_t kLineBytes = 128, kSectors = 4, kMostWays = 24;

struct Access {
  std::size_t line;
  std::uint32_t sector;
  bool is_write;  // of the whole sector
};

struct Traffic {
  std::uint64_t fetched = 0, written_back = 0;  // sectors
  bool operator==(const Traffic&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Traffic& traffic) {
  return out << traffic.fetched << " fetched, " << traffic.written_back << " written back";
}

// The traffic of caches of `sets` sets with 1, 2, ... kMostWays ways that replace the least recently used line.
class StackDistances {
 public:
  explicit StackDistances(std::size_t sets) : stacks_(sets), traffic_(kMostWays + 1) {}

  void access(const Access& access) {
    std::vector<std::size_t>& stack = stacks_[access.line % stacks_.size()];  // most recently used line first
    const auto found = std::find(stack.begin(), stack.end(), access.line);
    // A line at distance d is in the caches of d ways and more.
    const auto distance = found == stack.end() ? kNever : static_cast<std::uint32_t>(found - stack.begin()) + 1;
    if (found != stack.end()) stack.erase(found);
    stack.insert(stack.begin(), access.line);
    Line& line = lines_[access.line];
    for (Sector& sector : line) {  // smaller caches have evicted the line since its last access
      for (std::uint32_t ways = sector.dirty_from; ways < distance && ways <= kMostWays; ++ways)
        ++traffic_[ways].written_back;
      if (sector.dirty_from != kNever) sector.dirty_from = std::max(sector.dirty_from, distance);
      sector.valid_from = std::max(sector.valid_from, distance);
    }
    Sector& sector = line[access.sector];
    for (std::uint32_t ways = 1; !access.is_write && ways < sector.valid_from && ways <= kMostWays; ++ways)
      ++traffic_[ways].fetched;
    sector.valid_from = 1;
    if (access.is_write) sector.dirty_from = 1;
  }

  Traffic traffic(std::uint32_t ways) const {
    Traffic traffic = traffic_[ways];
    for (const auto& [number, line] : lines_)
      for (const Sector& sector : line) traffic.written_back += sector.dirty_from <= ways;  // at the end
    return traffic;
  }

 private:
  static constexpr std::uint32_t kNever = ~0u;
  // The sector is valid, or dirty, in caches of so many ways and more.
  struct Sector {
    std::uint32_t valid_from = kNever, dirty_from = kNever;
  };
  using Line = std::array<Sector, kSectors>;

  std::vector<std::vector<std::size_t>> stacks_;
  std::map<std::size_t, Line> lines_;
  std::vector<Traffic> traffic_;  // by ways
};

Traffic traffic_of_cache(const std::vector<Access>& accesses, std::size_t sets, std::uint32_t ways) {
  std::size_t lines = 0;
  for (const Access& access : accesses) lines = std::max(lines, access.line + 1);
  const CacheParameters parameters{static_cast<std::uint32_t>(sets) * ways * kLineBytes, ways, kLineBytes};
  DramLog log;
  const MemorySystem memory({}, &log);
  BlockCache cache(memory, parameters, BlockCache::Level::l2,
                   {.count = lines, .bytes = kLineBytes, .places = BlockPlaces(memory, "array", true)});
  StageCounters counters{StageId::compose};
  std::uint32_t request = 0;
  for (const Access& access : accesses) {
    if (access.is_write)
      cache.write(++request, access.line, access.sector * 32, 32, counters);
    else
      cache.read(++request, access.line, access.sector * 32, 32, counters);
  }
  cache.flush(counters);
  Traffic traffic;
  for (const std::vector<DramRun>& pass : log.passes())
    for (const DramRun& run : pass)
      (run.access == DramAccess::write ? traffic.written_back : traffic.fetched) += run.sectors;
  EXPECT_EQ((traffic.fetched + traffic.written_back) * 32, counters.dram_bytes);
  return traffic;
}

void expect_same_traffic(const std::vector<Access>& accesses, const std::string& name) {
  for (const std::size_t sets : {std::size_t{1}, std::size_t{4}, std::size_t{32}}) {
    StackDistances distances(sets);
    for (const Access& access : accesses) distances.access(access);
    for (const std::uint32_t ways : {1u, 2u, 3u, 4u, 8u, 24u})
      EXPECT_EQ(traffic_of_cache(accesses, sets, ways), distances.traffic(ways))
          << name << ", " << sets << " sets of " << ways << " ways";
  }
}

// Lines are drawn from a window that moves, so that some are used again soon and others much later.
std::vector<Access> random_accesses(std::uint32_t seed, std::size_t lines, std::size_t count, double writes) {
  std::mt19937 bits(seed);
  std::vector<Access> accesses;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t window = bits() % 4 == 0 ? lines : 1 + lines / 8;
    accesses.push_back({(i * lines / count + bits() % window) % lines, static_cast<std::uint32_t>(bits() % kSectors),
                        bits() / 4294967296.0 < writes});
  }
  return accesses;
}

// All that a frame asks DRAM for, as accesses of one memory. Lines are numbered anew, so that there are few.
std::vector<Access> recorded_accesses(const char* spec) {
  DramTrace trace(testing::TempDir());
  parse_technique(spec).render(random_trace(40, 40, 60, 3), 0, {2}, {.dram_trace = &trace});
  std::map<std::uint64_t, std::size_t> numbers;
  std::vector<Access> accesses;
  trace.for_each([&](const DramRequest& request) {
    const std::uint64_t sector = request.address / 32;
    const std::size_t line = numbers.emplace(sector / kSectors, numbers.size()).first->second;
    accesses.push_back({line, static_cast<std::uint32_t>(sector % kSectors), request.access == DramAccess::write});
  });
  return accesses;
}

TEST(StackDistances, HandWorked) {
  StackDistances one(1);
  for (const std::size_t line : {0, 1, 0, 2, 1}) one.access({line, 0, line == 0});
  // One way: 1, 2 and 1 are fetched, and 0 goes back twice. Two ways: 0 stays for its second access.
  EXPECT_EQ(one.traffic(1), (Traffic{3, 2}));
  EXPECT_EQ(one.traffic(2), (Traffic{3, 1}));
  EXPECT_EQ(one.traffic(3), (Traffic{2, 1}));
}

TEST(StackDistances, RandomAccesses) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed)
    for (const double writes : {0.0, 0.3, 1.0})
      expect_same_traffic(random_accesses(seed, 40 * seed, 3000, writes),
                          "seed " + std::to_string(seed) + ", writes " + std::to_string(writes));
}

TEST(StackDistances, AccessesOfFrames) {
  for (const char* spec : {"msaa:4", "beam", "beam:order=sorted"}) {
    const std::vector<Access> accesses = recorded_accesses(spec);
    ASSERT_GT(accesses.size(), 500u) << spec;
    expect_same_traffic(accesses, spec);
  }
}

TEST(StackDistances, CachesOfTexels) {
  const std::vector<Access> accesses = random_accesses(7, 300, 20000, 0);
  for (const std::size_t sets : {std::size_t{1}, std::size_t{8}}) {
    StackDistances distances(sets);
    for (const Access& access : accesses) distances.access(access);
    for (const std::uint32_t ways : {1u, 2u, 4u, 16u}) {
      ReadCache cache({static_cast<std::uint32_t>(sets) * ways * kLineBytes, ways, kLineBytes});
      std::uint64_t missed = 0;
      for (const Access& access : accesses)
        missed += cache.read(access.line, static_cast<Sectors>(1u << access.sector)) != 0;
      EXPECT_EQ(missed, distances.traffic(ways).fetched) << sets << " sets of " << ways << " ways";
    }
  }
}

}  // namespace beampipe::stack_distance_test

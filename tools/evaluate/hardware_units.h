// The units of described hardware: what each is, and the clocks that it needs for the work of a stage.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "stages/cost/counters.h"
#include "tools/evaluate/hardware.h"

namespace beampipe {

inline constexpr const char *kL2 = "l2", *kDram = "dram", *kExport = "export", *kLatency = "latency";
inline constexpr double kProbeBytes = 16;  // a bilinear probe: four texels of 4 bytes

// What a unit needs for the work of a stage, and the rate by which that is so long. A unit does several kinds of work
// at a time, each at a rate of its own; a sum has the rate of its greater part.
struct Clocks {
  double count = 0;
  const char* rate = "";

  bool operator<(const Clocks& other) const { return count < other.count; }
  Clocks operator+(const Clocks& other) const { return {count + other.count, *this < other ? other.rate : rate}; }
};

// The rates of all cores together, and of the other units.
class Rates {
 public:
  explicit Rates(const Hardware& hardware) : rates_(hardware.rates), cores_(hardware.memory.cores) {}

  double at(const char* rate) const { return rates_.at(rate); }
  Clocks over(double work, const char* rate) const { return {work / rates_.at(rate), rate}; }
  Clocks over_cores(double work, const char* rate) const { return {work / (cores_ * rates_.at(rate)), rate}; }

 private:
  const std::map<std::string, double>& rates_;
  double cores_;
};

struct StageWork : StageCounters {
  bool pixels_on_chip = false;  // the state of pixels that it reads and writes; otherwise it is in memory
  double threads = 1;           // in flight, of all cores
  double sector_bytes = kLeastSectorBytes;
};

struct HardwareUnit {
  enum class Kind {
    fixed_function,
    shader,
    beside,   // both kinds of stages use it beside the unit that does their work
    implied,  // a description does not name it: every stage uses it, or it follows from others
  };
  std::string_view name;
  Kind kind;
  Clocks (*clocks)(const Rates& rates, const StageWork& stage);
  bool is_rop = false, is_of_cores = false;  // of_cores: each core has its own
};

// In the order of their names.
const std::vector<HardwareUnit>& hardware_units();
// Throws std::out_of_range if there is none.
const HardwareUnit& info_of_unit(std::string_view name);

// The unit, and the rate that limits it where that is not the unit's own: "dram", or "rop_samples: on_chip_bytes" for
// core_on_chip_bytes_per_clk.
std::string limit_text(const std::string& unit, const std::string& rate);

}  // namespace beampipe

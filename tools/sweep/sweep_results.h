// What rendering a cell finds out, and what comparing pictures with the reference does, as stored results.
#pragma once

#include <optional>
#include <vector>

#include "tools/evaluate/metrics.h"
#include "tools/evaluate/results.h"
#include "tools/sweep/sweep_store.h"
#include "tools/sweep/trace_shelf.h"

namespace beampipe {

// The counts of a cell.
struct CountedCell {
  TechniqueReport report;  // without pictures, times and counters of pixels
  CacheReach reach;        // of all frames
};

// Would rendering with `wanted` give the same counts as rendering with `rendered` gave? It would if they differ in
// nothing but caches that hold everything that they stand before.
bool counts_the_same(const MemoryParameters& wanted, const MemoryParameters& rendered, const CacheReach& reach);

// The error of a technique's pictures, over all frames.
struct PictureErrors {
  ErrorStats error;
  EquivalentMsaa equivalent_msaa;
};

// Pictures depend on the bins, and on nothing else of a memory system.
struct PictureVariant {
  std::size_t technique;  // of the plan
  std::uint32_t bin_pixels, on_chip_bytes, bins_per_core;
  std::optional<Place> framebuffer;

  PictureVariant(std::size_t of_technique, const MemoryParameters& memory)
      : technique(of_technique),
        bin_pixels(memory.bin_pixels),
        on_chip_bytes(memory.on_chip_bytes),
        bins_per_core(memory.bins_per_core),
        framebuffer(memory.framebuffer) {}

  // A memory system with these bins.
  MemoryParameters memory() const {
    MemoryParameters memory;
    memory.bin_pixels = bin_pixels, memory.on_chip_bytes = on_chip_bytes, memory.bins_per_core = bins_per_core;
    memory.framebuffer = framebuffer;
    return memory;
  }

  auto operator<=>(const PictureVariant&) const = default;
};

// The results of a plan, as the store has them.
class SweepResults {
 public:
  // All must outlive it.
  SweepResults(const SweepPlan& plan, TraceShelf& shelf, SweepStore& store)
      : plan_(plan), shelf_(shelf), store_(store) {}

  std::optional<CountedCell> counts(const SweepCell& cell) const;
  void write(const SweepCell& cell, const CountedCell& counts);

  // One result for all pictures of a trace in a size, in the order of the variants.
  std::optional<std::vector<PictureErrors>> errors(std::size_t trace, std::size_t size) const;
  void write(std::size_t trace, std::size_t size, const std::vector<PictureErrors>& errors);

  // Of a trace in a size: the plan's techniques, with the bins of all its memory systems, each once.
  std::vector<PictureVariant> variants(std::size_t trace, std::size_t size) const;

 private:
  Json key_of(const SweepCell& cell) const;
  Json key_of_errors(std::size_t trace, std::size_t size) const;

  const SweepPlan& plan_;
  TraceShelf& shelf_;
  SweepStore& store_;
};

}  // namespace beampipe

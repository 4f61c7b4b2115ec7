// The results of one technique's frames, in order.
#pragma once

#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

#include "tools/evaluate/frame_report.h"

namespace beampipe {

// A list that can be too long for memory: frames beyond a limit are kept in a temporary file, which has no name and so
// is gone with the program. All functions throw std::runtime_error, one line, if the file cannot be written or read.
class FrameReports {
 public:
  // As many frames as this stay in memory.
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  FrameReports() = default;
  explicit FrameReports(std::size_t in_memory) : most_in_memory_(in_memory) {}

  void push_back(FrameReport frame);

  bool empty() const { return size() == 0; }
  std::size_t size() const { return in_memory_.size() + places_.size(); }
  FrameReport operator[](std::size_t i) const;
  FrameReport front() const { return (*this)[0]; }
  const FrameReport& back() const { return last_; }  // in memory

  // `for (const FrameReport& frame : reports)` reads one frame after the other.
  class Iterator {
   public:
    Iterator(const FrameReports& reports, std::size_t at) : reports_(&reports), at_(at) {}
    FrameReport operator*() const { return (*reports_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const FrameReports* reports_;
    std::size_t at_;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }

 private:
  std::size_t most_in_memory_ = kAll;
  std::vector<FrameReport> in_memory_;  // the first ones
  FrameReport last_;
  // The others, one JSON text after the other, and where each starts. Copies of the list share the file: it only grows,
  // and no copy sees what another one adds.
  std::shared_ptr<std::FILE> file_;
  std::vector<std::uint64_t> places_;
};

}  // namespace beampipe

// A pool of records in memory that all bins of a frame share, in streaming order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <vector>

#include "stages/data/pooled_pixels.h"

namespace beampipe {

// The modelled machine draws the triangles of the frame one after the other, this program its bins. So the pool never
// says no to a bin. When it was full is found afterwards, from what all bins have claimed.
class FramePool {
 public:
  FramePool(std::size_t pixels, std::size_t bytes_per_pixel, std::uint32_t guaranteed_chunks)
      : free_(pixels * bytes_per_pixel / (kChunkBytes + kFrameChunkLinkBytes) - pixels * guaranteed_chunks) {}

  // Of a bin: its claims, and the most chunks that it had beyond those that are guaranteed. Thread-safe.
  void add(const std::vector<PoolClaim>& claims, std::size_t most) {
    const std::lock_guard lock(mutex_);
    claims_.insert(claims_.end(), claims.begin(), claims.end());
    most_ += most;
  }

  // The first triangle for which the pool has too few chunks beyond those that are guaranteed; ~0: there is none. A
  // triangle takes what it needs before it gives back what others had.
  std::uint32_t full_at() {
    if (most_ <= free_) return ~0u;
    std::sort(claims_.begin(), claims_.end(), [](const PoolClaim& a, const PoolClaim& b) {
      return a.triangle != b.triangle ? a.triangle < b.triangle : a.chunks > b.chunks;
    });
    std::int64_t claimed = 0;
    for (const PoolClaim& claim : claims_)
      if ((claimed += claim.chunks) > static_cast<std::int64_t>(free_)) return claim.triangle;
    return ~0u;
  }

 private:
  std::size_t free_;  // chunks beyond those that are guaranteed
  std::size_t most_ = 0;
  std::mutex mutex_;
  std::vector<PoolClaim> claims_;
};

}  // namespace beampipe

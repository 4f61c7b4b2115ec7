// A pool of records in memory that all bins of a frame share, in streaming order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "stages/data/pooled_pixels.h"

namespace beampipe {

// The modelled machine draws the triangles of the frame one after the other, this program its bins. So the pool never
// says no to a bin. When it was full is found afterwards, from what all bins have claimed.
class FramePool {
 public:
  // It has no more chunks than numbers can name. Throws std::runtime_error if these are fewer than what is guaranteed.
  FramePool(std::size_t pixels, std::size_t bytes_per_pixel, std::uint32_t guaranteed_chunks)
      : free_(static_cast<std::int64_t>(std::min(pixels * bytes_per_pixel / (kChunkBytes + kFrameChunkLinkBytes),
                                                 std::size_t{1} << kFrameChunkNumberBits)) -
              static_cast<std::int64_t>(pixels * guaranteed_chunks)) {
    if (free_ < 0)
      throw std::runtime_error("the frame has " + std::to_string(pixels) + " pixels, more than the " +
                               std::to_string((1u << kFrameChunkNumberBits) / guaranteed_chunks) +
                               " whose chunks can be numbered");
  }

  // All claims of a bin, in the order of triangles. Thread-safe.
  void add(const std::vector<PoolClaim>& claims) {
    const std::lock_guard lock(mutex_);
    claims_.insert(claims_.end(), claims.begin(), claims.end());
    most_ += most_of(claims);
  }

  // The first triangle for which the pool has too few chunks beyond those that are guaranteed; ~0: there is none. A
  // triangle takes what it needs before it gives back what others had.
  std::uint32_t full_at() {
    if (most_ <= free_) return ~0u;  // nor would they be too few if all bins had the most at once
    std::sort(claims_.begin(), claims_.end(), [](const PoolClaim& a, const PoolClaim& b) {
      return a.triangle != b.triangle ? a.triangle < b.triangle : a.chunks > b.chunks;
    });
    std::int64_t claimed = 0;
    for (const PoolClaim& claim : claims_)
      if ((claimed += claim.chunks) > free_) return claim.triangle;
    return ~0u;
  }

 private:
  // The most chunks that a bin has at once, where a triangle takes before it gives.
  static std::int64_t most_of(const std::vector<PoolClaim>& claims) {
    std::int64_t had = 0, net = 0, taken = 0, most = 0;  // before the triangle, and by it
    std::uint32_t triangle = 0;
    for (const PoolClaim& claim : claims) {
      if (claim.triangle != triangle) had += net, net = taken = 0;
      triangle = claim.triangle;
      net += claim.chunks, taken += std::max(claim.chunks, 0);
      most = std::max(most, had + taken);
    }
    return most;
  }

  std::int64_t free_;  // chunks beyond those that are guaranteed
  std::int64_t most_ = 0;
  std::mutex mutex_;
  std::vector<PoolClaim> claims_;
};

}  // namespace beampipe

#include "stages/data/owner_weights.h"

#include <algorithm>

namespace beampipe {

std::vector<OwnerWeights::Part> OwnerWeights::parts_of(const Pixel& pixel, const RecordedOwner& owner) {
  if (owner.slot.is_merged()) return pixel.owners.at(owner.index);
  return {{owner.slot.triangle(), 1.0f, owner.color}};
}

void OwnerWeights::merge(std::size_t pixel, const RecordedOwner& one, const RecordedOwner& other, float part) {
  Pixel& of = pixels_[pixel];
  std::vector<Part> parts = parts_of(of, one);
  const std::vector<Part> others = parts_of(of, other);
  of.merges.push_back({parts, others, one.owned, other.owned, one.color, other.color, part});
  for (Part& each : parts) each.part *= part;
  for (const Part& each : others) parts.push_back({each.number, each.part * (1 - part), each.color});
  of.owners.resize(std::max(of.owners.size(), one.index + 1));
  of.owners[one.index] = std::move(parts);
}

void OwnerWeights::settle(std::size_t pixel, const RecordedOwner& owner, float area, float counted) {
  Pixel& of = pixels_[pixel];
  of.finals.push_back({parts_of(of, owner), owner.owned, area, counted, false, owner.slot.is_merged(), owner.color});
}

void OwnerWeights::add_speck(std::size_t pixel, std::uint32_t number, float area, const glm::vec3& color) {
  pixels_[pixel].finals.push_back({{{number, 1.0f, color}}, {}, area, 0, true, false, color});
}

void OwnerWeights::finish(std::size_t pixel, const PixelColor& analytic, const PixelColor& counted,
                          const PixelColor& result) {
  Pixel& of = pixels_[pixel];
  of.estimates = {analytic, counted, result};
  double area = 0, count = 0;
  for (const Final& each : of.finals) area += each.area, count += each.counted;
  // How far from the mean colour of the analytic estimate to that of the counted one, by least squares.
  double along = 0, length = 0;
  for (int c = 0; c < 3 && count > 0; ++c) {
    const double from = double{analytic.color[c]} / analytic.alpha, to = double{counted.color[c]} / counted.alpha;
    along += (to - from) * (double{result.color[c]} / result.alpha - from);
    length += (to - from) * (to - from);
  }
  const double part = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
  for (const Final& each : of.finals) {
    const double analytic_part = each.area / area, counted_part = count > 0 ? each.counted / count : 0.0;
    const double weight = result.alpha * ((1 - part) * analytic_part + part * counted_part);
    for (const Part& of_owner : each.parts)
      of.weights.push_back(
          {of_owner.number, static_cast<float>(of_owner.part * weight), each.speck, each.merged, of_owner.color});
  }
  of.owners.clear();
}

void OwnerWeights::finish_whole(std::size_t pixel, std::uint32_t number, const glm::vec3& color) {
  pixels_[pixel].weights = {{number, 1.0f, false, false, color}};
}

}  // namespace beampipe

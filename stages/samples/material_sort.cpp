#include "stages/samples/material_sort.h"

#include <array>

#include "stages/data/sample_tile.h"
#include "stages/samples/material_sort_cost.h"

namespace beampipe {
namespace {

struct Item {
  std::uint32_t material, sample;
};

// One pass: stable, by one digit.
std::vector<Item> sorted_by_digit(const std::vector<Item>& items, int shift) {
  std::array<std::uint32_t, kSortDigits> places{};
  for (const Item& item : items) ++places[digit_of(item.material, shift)];
  std::uint32_t before = 0;
  for (std::uint32_t& place : places) {
    const std::uint32_t count = place;
    place = before;
    before += count;
  }
  std::vector<Item> sorted(items.size());
  for (const Item& item : items) sorted[places[digit_of(item.material, shift)]++] = item;
  return sorted;
}

}  // namespace

std::vector<std::uint32_t> material_sort(const std::vector<std::uint32_t>& triangles,
                                         const std::vector<std::uint32_t>& materials, int digits,
                                         StageCounters& counters) {
  std::vector<Item> items;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (triangles[i] != kNoTriangle) items.push_back({materials[triangles[i]], static_cast<std::uint32_t>(i)});
  for (int digit = 0; digit < digits; ++digit) items = sorted_by_digit(items, 8 * digit);
  std::vector<std::uint32_t> order;
  order.reserve(items.size());
  for (const Item& item : items) order.push_back(item.sample);
  charge_material_sort(triangles.size(), items.size(), static_cast<std::uint64_t>(digits), counters);
  return order;
}

}  // namespace beampipe

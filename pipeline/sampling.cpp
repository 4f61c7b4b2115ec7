#include "pipeline/sampling.h"

#include <algorithm>

namespace beampipe {

std::vector<glm::ivec2> places_of(const Sampling& sampling) {
  std::vector<glm::ivec2> places;
  const CellGrid& grid = sampling.grid;
  for (int cell = 0; cell < grid.cells_per_pixel(); ++cell)
    for (std::size_t s = 0; s < static_cast<std::size_t>(sampling.pattern.count); ++s)
      places.emplace_back(cell % grid.columns * grid.cell_width() + sampling.pattern.x[s],
                          cell / grid.columns * grid.cell_height() + sampling.pattern.y[s]);
  return places;
}

std::vector<glm::ivec2> places_of(const std::vector<SamplePattern>& patterns) {
  std::vector<glm::ivec2> places;
  for (const SamplePattern& pattern : patterns)
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s)
      places.emplace_back(pattern.x[s], pattern.y[s]);
  return places;
}

Sampling msaa_sampling(int samples) {
  if (samples <= 16) return {CellGrid{}, standard_pattern(samples)};
  const CellCounts cells = split_into_cells(samples / 8);
  const CellGrid grid{cells.columns, cells.rows};
  return {grid, standard_pattern(8, grid.cell_width(), grid.cell_height())};
}

std::vector<Sampling> acaa_rounds(int samples) {
  const Sampling all = msaa_sampling(samples);
  std::vector<Sampling> rounds;
  SamplePattern pattern;
  for (int cell = 0; cell < all.grid.cells_per_pixel(); ++cell) {
    for (std::size_t s = 0; s < static_cast<std::size_t>(all.pattern.count); ++s) {
      const auto i = static_cast<std::size_t>(pattern.count++);
      pattern.x[i] = all.pattern.x[s] + cell % all.grid.columns * all.grid.cell_width();
      pattern.y[i] = all.pattern.y[s] + cell / all.grid.columns * all.grid.cell_height();
    }
    if (pattern.count < 16 && cell + 1 < all.grid.cells_per_pixel()) continue;
    rounds.push_back({CellGrid{}, pattern});
    pattern = {};
  }
  const auto central = std::ranges::min_element(rounds, {}, [](const Sampling& round) {
    return squared_distance_to_centre(round.pattern, nearest_to_centre(round.pattern));
  });
  std::rotate(rounds.begin(), central + 1, rounds.end());
  return rounds;
}

}  // namespace beampipe

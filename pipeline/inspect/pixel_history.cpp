#include "pipeline/inspect/pixel_history.h"

namespace beampipe {

glm::dvec3 PixelHistory::sum() const {
  glm::dvec3 sum(0.0);
  for (const HistoryTerm& term : terms) sum += term.weight * term.color;
  return sum;
}

glm::dvec3 PixelHistory::rest() const {
  const glm::dvec3 sum = this->sum();
  glm::dvec3 rest(0.0);
  for (int c = 0; c < 3; ++c)
    if (static_cast<float>(sum[c]) != pixel[c]) rest[c] = double{pixel[c]} - sum[c];
  return rest;
}

}  // namespace beampipe

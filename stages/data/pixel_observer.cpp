#include "stages/data/pixel_observer.h"

#include <algorithm>
#include <bit>
#include <map>

namespace beampipe {
namespace {

void count_move(std::uint32_t fragment, std::vector<PositionMove>& moves) {
  const auto known =
      std::find_if(moves.begin(), moves.end(), [&](const PositionMove& each) { return each.fragment == fragment; });
  if (known == moves.end()) {
    moves.push_back({fragment, 1});
  } else {
    ++known->positions;
  }
}

template <class Visit>
void for_each_bit(std::uint32_t word, Visit&& visit) {
  for (; word != 0; word &= word - 1) visit(static_cast<std::size_t>(std::countr_zero(word)));
}

std::vector<std::uint32_t> fragments_of(const std::vector<HistoryTerm>& terms) {
  std::vector<std::uint32_t> fragments;
  for (const HistoryTerm& term : terms) fragments.push_back(term.fragment);
  return fragments;
}

HeldSurface held_aggregate(const std::vector<HistoryTerm>& terms, const Aggregate& aggregate) {
  const glm::vec3 color(aggregate.color[0], aggregate.color[1], aggregate.color[2]);
  return {fragments_of(terms), static_cast<std::uint32_t>(std::popcount(aggregate.mask)), aggregate.alpha,
          aggregate.alpha > 0 ? color / aggregate.alpha : color};
}

glm::dvec4 packed(const PixelColor& color) { return glm::dvec4(color.color, color.alpha); }

// How far the result's colour lies from that of the analytic estimate (0) to that of the counted one (1), by least
// squares.
double part_of_counted(const PixelEstimates& found) {
  if (found.counted.a <= 0) return 0;
  const glm::dvec3 from = glm::dvec3(found.analytic) / found.analytic.a;
  const glm::dvec3 way = glm::dvec3(found.counted) / found.counted.a - from;
  const double length = glm::dot(way, way);
  const double along = glm::dot(way, glm::dvec3(found.result) / found.result.a - from);
  return length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
}

}  // namespace

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

PixelWeights PixelHistory::weights() const {
  std::map<std::uint32_t, double> sums;
  for (const HistoryTerm& term : terms)
    if (term.fragment != kNobody) sums[term.fragment] += term.weight;
  const auto is_part = [&](std::uint32_t fragment) { return sums.contains(fragment); };
  const bool merges = std::any_of(steps.begin(), steps.end(), [&](const HistoryStep& step) {
    return step.kind == HistoryStep::Kind::merged && std::ranges::any_of(step.after->fragments, is_part);
  });
  PixelWeights weights;
  for (const auto& [fragment, weight] : sums)
    weights.push_back({fragments[fragment].triangle, static_cast<float>(weight), merges ? fragment + 1 : 0,
                       fragments[fragment].is_tiny});
  return weights;
}

std::size_t PixelObserver::add_positions(const std::vector<glm::vec2>& positions) {
  const std::size_t first = history.positions.size();
  history.positions.insert(history.positions.end(), positions.begin(), positions.end());
  history.owners.resize(history.positions.size(), kNobody);
  return first;
}

std::uint32_t PixelObserver::fragment_of(std::uint32_t triangle, Fate fate) {
  const auto [known, is_new] = fragments_.try_emplace(triangle, static_cast<std::uint32_t>(history.fragments.size()));
  if (is_new) history.fragments.push_back({.triangle = triangle, .fate = fate});
  return known->second;
}

void PixelObserver::take(std::size_t position, std::uint32_t fragment) {
  std::uint32_t& owner = history.owners[position];
  if (position < layers_.size()) layers_[position].clear(), behind_layers_[position] = 1;
  if (owner == fragment) return;
  count_move(owner, history.fragments[fragment].taken);
  if (owner != kNobody) count_move(fragment, history.fragments[owner].lost);
  owner = fragment;
  history.fragments[fragment].fate = Fate::owner;
}

void PixelObserver::misses(std::size_t position, std::uint32_t fragment) {
  const std::uint32_t owner = history.owners[position];
  if (owner != fragment && owner != kNobody) count_move(owner, history.fragments[fragment].lost);
}

void PixelObserver::contends(std::uint32_t triangle, std::size_t first, std::uint32_t covered, std::uint32_t won) {
  const std::uint32_t fragment = fragment_of(triangle);
  HistoryFragment& noted = history.fragments[fragment];
  if (noted.fate == Fate::closed_off) noted.fate = Fate::hidden;
  noted.mask.resize(history.positions.size());
  for_each_bit(covered, [&](std::size_t i) { noted.mask[first + i] = true; });
  for_each_bit(won, [&](std::size_t i) { take(first + i, fragment); });
  for_each_bit(covered & ~won, [&](std::size_t i) { misses(first + i, fragment); });
}

void PixelObserver::arrives(const Fragment& fragment, const WideMask& won) {
  current_ = fragment_of(fragment.triangle);
  for (std::size_t first = 0; first < history.positions.size(); first += 32)
    contends(fragment.triangle, first, fragment.mask.words[first / 32], won.words[first / 32]);
  HistoryFragment& noted = history.fragments[current_];
  noted.area = fragment.alpha;
  noted.is_tiny = fragment.tiny;
  if (fragment.mask.none()) noted.fate = Fate::speck_hidden;
}

void PixelObserver::takes(std::uint32_t triangle, const WideMask& won) {
  current_ = fragment_of(triangle);
  for (std::size_t position = 0; position < history.positions.size(); ++position)
    if (won.test(position)) take(position, current_);
}

void PixelObserver::would_cover(std::uint32_t triangle, std::size_t first, std::uint32_t covered) {
  const std::uint32_t fragment = fragment_of(triangle);
  std::vector<bool>& mask = history.fragments[fragment].mask;
  mask.resize(history.positions.size());
  for_each_bit(covered, [&](std::size_t i) {
    if (!mask[first + i]) misses(first + i, fragment);
    mask[first + i] = true;
  });
}

// An index into surfaces_. A surface of one fragment is listed, with its colour, when it is first asked for.
std::size_t PixelObserver::surface_at(const WideMask& positions, const glm::vec3& color) {
  std::size_t position = 0;
  while (!positions.test(position)) ++position;
  const std::uint32_t fragment = history.owners[position];
  const auto has_it = [&](const HistoryTerm& part) { return part.fragment == fragment; };
  const auto surface = std::find_if(surfaces_.begin(), surfaces_.end(),
                                    [&](const Surface& each) { return std::ranges::any_of(each, has_it); });
  const auto index = static_cast<std::size_t>(surface - surfaces_.begin());
  if (index == surfaces_.size()) surfaces_.push_back({{fragment, 1.0, color}});
  return index;
}

HeldSurface PixelObserver::held(const Surface& surface, const WideMask& positions, const glm::vec3& color) const {
  const auto count = static_cast<std::uint32_t>(positions.count());
  return {fragments_of(surface), count, count / static_cast<double>(history.positions.size()), color};
}

void PixelObserver::join(std::size_t one, std::size_t other, double factor_of_one, double factor_of_other) {
  Surface& joined = surfaces_[one];
  for (HistoryTerm& part : joined) part.weight *= factor_of_one;
  for (const HistoryTerm& part : surfaces_[other])
    joined.push_back({part.fragment, part.weight * factor_of_other, part.color});
  surfaces_.erase(surfaces_.begin() + static_cast<std::ptrdiff_t>(other));
}

void PixelObserver::merges(const Owned& one, const Owned& other) {
  const std::size_t i = surface_at(one.positions, one.color), j = surface_at(other.positions, other.color);
  HistoryStep step{HistoryStep::Kind::merged, current_};
  step.before = {held(surfaces_[i], one.positions, one.color), held(surfaces_[j], other.positions, other.color)};
  join(i, j, one.part, other.part);
  step.after = held(surfaces_[i > j ? i - 1 : i], one.positions | other.positions,
                    static_cast<float>(one.part) * one.color + static_cast<float>(other.part) * other.color);
  history.steps.push_back(step);
}

void PixelObserver::settles(const WideMask& positions, const glm::vec3& color, double area, double counted) {
  const std::size_t index = surface_at(positions, color);
  HistoryStep step{HistoryStep::Kind::settled, current_};
  step.before = {held(surfaces_[index], positions, color)};
  step.before[0].area = area;
  history.steps.push_back(step);
  finals_.push_back({surfaces_[index], area, counted});
  surfaces_.erase(surfaces_.begin() + static_cast<std::ptrdiff_t>(index));
}

void PixelObserver::adds_speck(std::uint32_t triangle, double area, const glm::vec3& color) {
  shows_speck(triangle);
  finals_.push_back({{{fragment_of(triangle), 1.0, color}}, area, 0});
}

void PixelObserver::forgets_specks() {
  for (const Final& speck : finals_) history.fragments[speck.surface.front().fragment].fate = Fate::speck_hidden;
  finals_.clear();
}

void PixelObserver::finishes() {
  for (const Final& each : finals_)
    for (const HistoryTerm& part : each.surface) add_term(part.fragment, each.area * part.weight, part.color);
}

void PixelObserver::finishes(const PixelColor& analytic, const PixelColor& counted, const PixelColor& result) {
  history.estimates = {packed(analytic), packed(counted), packed(result)};
  const double part = part_of_counted(*history.estimates);
  double area = 0, count = 0;
  for (const Final& each : finals_) area += each.area, count += each.counted;
  for (Final& each : finals_) {
    const double counted_part = count > 0 ? each.counted / count : 0;
    each.area = result.alpha * ((1 - part) * each.area / area + part * counted_part);
  }
  finishes();
}

void PixelObserver::enters(std::size_t place, const Fragment& fragment) {
  WideMask won;
  for (std::size_t position = 0; position < history.owners.size(); ++position)
    if (fragment.mask.test(position) && history.owners[position] == kNobody) won.set(position);
  arrives(fragment, won);
  surfaces_.insert(surfaces_.begin() + static_cast<std::ptrdiff_t>(place),
                   {{current_, fragment.alpha, glm::dvec3(fragment.color) / double{fragment.alpha}}});
}

void PixelObserver::overwrites(std::size_t place) {
  if (place < surfaces_.size()) surfaces_.erase(surfaces_.begin() + static_cast<std::ptrdiff_t>(place));
}

void PixelObserver::joins(std::size_t place, const Joined& joined) {
  HistoryStep step{HistoryStep::Kind::merged, current_};
  step.before = {held_aggregate(surfaces_[place], joined.nearer), held_aggregate(surfaces_[place + 1], joined.farther)};
  join(place, place + 1, joined.factor_of_nearer, joined.factor_of_farther);
  step.after = held_aggregate(surfaces_[place], joined.together);
  history.steps.push_back(step);
}

void PixelObserver::finishes_aggregate() {
  if (surfaces_.empty()) return;
  for (const HistoryTerm& part : surfaces_.front()) {
    history.fragments[part.fragment].fate = part.weight > 0 ? Fate::composed : Fate::hidden;
    add_term(part.fragment, part.weight, part.color);
  }
}

void PixelObserver::adds(std::uint32_t triangle, double weight, const glm::dvec3& color) {
  add_term(triangle == kNobody ? kNobody : fragment_of(triangle), weight, color);
}

// Together with an earlier term of the same colour.
void PixelObserver::add_term(std::uint32_t fragment, double weight, const glm::dvec3& color) {
  for (HistoryTerm& term : history.terms) {
    if (term.fragment != fragment || term.color != color) continue;
    term.weight += weight;
    return;
  }
  history.terms.push_back({fragment, weight, color});
}

void PixelObserver::scales(double factor) {
  for (HistoryTerm& term : history.terms) term.weight *= factor;
}

void PixelObserver::composes(std::uint32_t positions, double area, const glm::vec3& color) {
  HistoryStep step{HistoryStep::Kind::composed, current_};
  step.before = {aggregate_};
  aggregate_ = {{}, positions, area, area > 0 ? color / static_cast<float>(area) : color};
  for (const HistoryTerm& term : history.terms)
    if (term.weight > 0) aggregate_.fragments.push_back(term.fragment);
  step.after = aggregate_;
  history.steps.push_back(step);
}

void PixelObserver::blends(std::uint32_t triangle, std::size_t position, double added, double kept,
                           const glm::dvec3& color) {
  layers_.resize(history.positions.size());
  behind_layers_.resize(history.positions.size(), 1.0);
  for (HistoryTerm& layer : layers_[position]) layer.weight *= kept;
  behind_layers_[position] *= kept;
  const std::uint32_t fragment = fragment_of(triangle);
  const bool is_blended = kept != 0 || history.fragments[fragment].fate == Fate::blended;
  layers_[position].push_back(
      {drawn_fragment(triangle, position, is_blended ? Fate::blended : Fate::stored), added, color});
}

void PixelObserver::goes_over(std::uint32_t triangle, std::size_t position, double alpha, const glm::dvec3& color) {
  scales(1 - alpha);
  add_term(drawn_fragment(triangle, position, Fate::blended), alpha, color);
}

std::uint32_t PixelObserver::drawn_fragment(std::uint32_t triangle, std::size_t position, Fate fate) {
  const std::uint32_t fragment = fragment_of(triangle);
  HistoryFragment& noted = history.fragments[fragment];
  noted.fate = fate;
  noted.mask.resize(history.positions.size());
  noted.mask[position] = true;
  return fragment;
}

double PixelObserver::seen_behind_layers(std::size_t position) const {
  return position < behind_layers_.size() ? behind_layers_[position] : 1.0;
}

void PixelObserver::adds_samples(std::uint32_t triangle, std::size_t begin, std::size_t end, double share,
                                 const glm::dvec3& color) {
  for (std::size_t position = begin; position < end; ++position) {
    adds(triangle, share * seen_behind_layers(position), color);
    if (position >= layers_.size()) continue;
    for (const HistoryTerm& layer : layers_[position]) add_term(layer.fragment, share * layer.weight, layer.color);
  }
}

void PixelObserver::puts_layers_over(double alpha) {
  scales(1 - alpha);
  for (const std::vector<HistoryTerm>& layers : layers_)
    for (const HistoryTerm& layer : layers)
      add_term(layer.fragment, layer.weight / static_cast<double>(history.positions.size()), layer.color);
}

}  // namespace beampipe

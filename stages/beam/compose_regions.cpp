#include "stages/beam/compose_regions.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "simd/plane_order.h"
#include "stages/beam/compose_regions_cost.h"
#include "stages/data/half_bits.h"
#include "stages/data/pixel_formats.h"
#include "stages/rop/stored_color.h"

namespace beampipe {
namespace {

constexpr auto kWhole = static_cast<float>(kWholeArea), kAllDrawn = static_cast<float>(kWhollyDrawn);

// As fp16, and what is no number as 0.
float stored(float channel) { return std::isnan(channel) ? 0.0f : rounded_to_half(channel); }

std::size_t first_position(const WideMask& positions) {
  std::size_t word = 0;
  while (positions.words[word] == 0) ++word;
  return 32 * word + static_cast<std::size_t>(std::countr_zero(positions.words[word]));
}

// Region b becomes part of a, which keeps its depth and stencil value.
void join(Region& a, const Region& b) {
  const float share = share_of(static_cast<float>(b.area), static_cast<float>(a.area + b.area));
  for (int c = 0; c < 4 && a.color != b.color; ++c) a.color[c] = stored(mixture(a.color[c], b.color[c], share));
  a.drawn = static_cast<std::uint8_t>(mixture(static_cast<float>(a.drawn), static_cast<float>(b.drawn), share) + 0.5f);
  a.is_touched = a.is_touched && b.is_touched;
  a.positions = a.positions | b.positions;
  a.area = static_cast<std::uint16_t>(a.area + b.area);
}

// What a fragment does in a region.
struct Meeting {
  WideMask inside, passed;  // of the region's positions; passed is inside
  std::uint16_t area = 0;   // inside
  bool changes_passed = false, changes_failed = false;
  std::uint8_t passed_stencil = 0, failed_stencil = 0;
};

class RegionComposer {
 public:
  RegionComposer(const RegionsBin& bin, RegionPixels& pixels, const RegionsMaps& maps, RegionsResult& result)
      : bin_(bin), pixels_(pixels), maps_(maps), result_(result), everywhere_(first_words(pixels.words)) {}

  // Returns whether the fragment's colour was needed.
  bool add(const Fragment& fragment, const glm::vec4& color) {
    const std::uint32_t draw = bin_.triangles.draws[fragment.triangle];
    bin_.rules.clear_before(draw, pixels_.next_clear, [this](const RopClear& what) { clear(what); });
    start(bin_.rules.of(bin_.triangles, fragment.triangle), bin_.triangles.triangles[fragment.triangle]);
    writes_color_ = rule_->writes_color() && !fragment.is_discarded;
    if (is_limited(fragment.plane)) return take(with_limited_depth(fragment), draw, color);
    return take(fragment, draw, color);
  }

  // After the last fragment.
  void finish() {
    for (RegionPixel& pixel : pixels_.pixels) add_specks(pixel);
  }

  RegionsWork work;

 private:
  // Draws that are not clipped limit depths to their own range, here by the pixel's centre.
  bool is_limited(const DepthPlane<float>& plane) const {
    const double depth = plane.z;
    return (rule_->nearest > -1 && depth < rule_->nearest) || (rule_->farthest < 0 && depth > rule_->farthest);
  }

  Fragment with_limited_depth(Fragment fragment) const {
    fragment.plane = {
        std::clamp(fragment.plane.z, static_cast<float>(rule_->nearest), static_cast<float>(rule_->farthest)), 0.0f,
        0.0f};
    return fragment;
  }

  bool take(const Fragment& fragment, std::uint32_t draw, const glm::vec4& color) {
    look_at(fragment, draw);
    if (fragment.mask.none()) return wait(fragment, color);
    meet(fragment);
    tell(fragment, color);
    const auto changes = [](const Meeting& met) { return met.changes_passed || met.changes_failed; };
    if (std::ranges::none_of(meetings_, changes)) return needs_color_;
    share_area(fragment);
    cut(fragment, color);
    store(fragment.triangle);
    return needs_color_;
  }

  // ---- The draw's state ----

  void start(const RopRule& rule, const SetupTriangle& triangle) {
    const Stencil& stencil = rule.stencil_of(triangle);
    if (&rule == rule_ && &stencil == stencil_) return;
    rule_ = &rule, stencil_ = &stencil;
    of_blend_ = stored_color_cost(rule, 4);
    of_test_ = of_pass_ = of_depth_fail_ = of_fail_ = {};
    if (!rule.has_stencil) return;
    of_test_ = stencil_test_cost(stencil);
    of_pass_ = stencil_operation_cost(stencil.pass, stencil);
    of_depth_fail_ = stencil_operation_cost(stencil.depth_fail, stencil);
    of_fail_ = stencil_operation_cost(stencil.fail, stencil);
  }

  void clear(const RopClear& what) {
    for (RegionPixel& pixel : pixels_.pixels) {
      for (Region& region : pixel.regions) {
        if (what.depth) region.triangle = kNobodysDepth, region.plane = {bin_.rules.clear_depth, 0.0f, 0.0f};
        if (what.stencil) region.stencil = static_cast<std::uint8_t>(*what.stencil);
      }
    }
  }

  std::uint8_t stencil_after_op(StencilOperation operation, const OperationCounts& cost, std::uint8_t value) {
    if (!rule_->has_stencil) return value;
    work.by_state += cost;
    return static_cast<std::uint8_t>(stencil_after(operation, *stencil_, std::uint32_t{value}));
  }

  // ---- The pixel at hand ----

  void look_at(const Fragment& fragment, std::uint32_t draw) {
    ++work.fragments;
    work.whole += fragment.whole;
    index_ = fragment.pixel;
    pixel_ = &pixels_.pixels[index_];
    positions_read_ = false;
    needs_color_ = false;
    work.bytes_read += kPixelWordBytes;
    if (pixel_->chunks.count > 0) {
      work.bytes_read += pixel_->regions.size() * kRegionBytes + pixel_->chunks.count * pixels_.pool.link_bytes();
      visit(fragment.triangle, false);
    }
    if (pixel_->draw == draw) return;
    add_specks(*pixel_);
    pixel_->draw = draw;
    for (Region& region : pixel_->regions) region.is_touched = false;
  }

  // Positions are taken apart where it matters which region has them.
  void read_positions() { read_positions(pixel_->regions.size()); }
  // Those of so many regions, which the pixel had.
  void read_positions(std::size_t regions) {
    if (positions_read_) return;
    positions_read_ = true;
    const std::uint32_t planes = planes_for(regions);
    ++work.splits[planes];
    work.bytes_read += planes * pixels_.words * 4;
  }

  void visit(std::uint32_t triangle, bool is_write) {
    const ChunkPool::Chunks& chunks = pixel_->chunks;
    if (bin_.lists_requests) result_.visits.push_back({triangle, index_, chunks.count, is_write});
    if (chunks.in_memory > 0)
      count_spills(is_write ? ChunkRequests{.writes = chunks.in_memory} : ChunkRequests{.reads = chunks.in_memory});
  }
  void count_spills(const ChunkRequests& requests) {
    result_.spills += requests;
    maps_.memory_chunks[index_] += static_cast<float>(requests.all());
  }

  // The pixel's regions have changed.
  void store(std::uint32_t triangle) {
    const std::size_t count = pixel_->regions.size();
    const std::uint32_t after = region_chunks(count, pixel_->specks.area > 0, pixels_.words);
    if (after != pixel_->chunks.count) resize(after);
    float& most = maps_.record_bytes[index_];
    most = std::max(most, static_cast<float>(after * (kChunkBytes + pixels_.pool.link_bytes())));
    work.bytes_written += kPixelWordBytes;
    ++work.changing;
    visit(triangle, true);
  }

  // Links of chunks that are taken are read, and the last one's is written. What chunks in memory held that are given
  // back may still be needed: then it moves.
  void resize(std::uint32_t count) {
    ChunkPool::Chunks& chunks = pixel_->chunks;
    const ChunkPool::Chunks before = chunks;
    pixels_.pool.resize(chunks, count);
    if (before.count > 0) work.bytes_written += pixels_.pool.link_bytes();
    if (count > before.count) work.bytes_read += (count - before.count) * pixels_.pool.link_bytes();
    if (chunks.in_memory > before.in_memory) count_spills({.reads = chunks.in_memory - before.in_memory + 0u});
    if (chunks.in_memory >= before.in_memory) return;
    const std::uint32_t moved = std::min<std::uint32_t>(before.in_memory, count) - chunks.in_memory;
    work.bytes_read += moved * kChunkBytes;
    work.bytes_written += moved * kChunkBytes;
    count_spills({.reads = moved, .writes = 1});
  }

  // ---- Tests ----

  void meet(const Fragment& fragment) {
    const bool is_everywhere = fragment.mask == everywhere_;
    if (!is_everywhere && pixel_->regions.size() > 1) read_positions();
    meetings_.clear();
    for (const Region& region : pixel_->regions) {
      Meeting& met = meetings_.emplace_back();
      if (is_everywhere) {
        met.inside = region.positions;
      } else {
        met.inside = region.positions & fragment.mask;
        work.masks_tested += pixel_->regions.size() > 1;
      }
      if (!met.inside.none()) test(region, fragment, met);
    }
  }

  void test(const Region& region, const Fragment& fragment, Meeting& met) {
    met.passed_stencil = met.failed_stencil = region.stencil;
    if (rule_->has_stencil) {
      work.by_state += of_test_;
      if (!stencil_passes(*stencil_, std::uint32_t{region.stencil})) {
        met.failed_stencil = stencil_after_op(stencil_->fail, of_fail_, region.stencil);
        met.changes_failed = met.failed_stencil != region.stencil;
        return;
      }
    }
    test_depth(region, fragment, met);
    if (!met.passed.none()) {
      met.passed_stencil = stencil_after_op(stencil_->pass, of_pass_, region.stencil);
      met.changes_passed = writes_color_ || rule_->writes_depth || met.passed_stencil != region.stencil;
      needs_color_ = needs_color_ || writes_color_;
    }
    if (met.passed != met.inside) {
      met.failed_stencil = stencil_after_op(stencil_->depth_fail, of_depth_fail_, region.stencil);
      met.changes_failed = met.failed_stencil != region.stencil;
    }
  }

  void test_depth(const Region& region, const Fragment& fragment, Meeting& met) {
    if (rule_->depth != Compare::always && rule_->depth != Compare::never) {
      ++work.contests;
      if (region.triangle != kNobodysDepth) {
        ++work.planes;
        if (bin_.lists_requests) result_.fetched.push_back({region.triangle});
      }
    }
    switch (depth_passing(rule_->depth, fragment.plane, region.plane)) {
      case Passing::all:
        met.passed = met.inside;
        break;
      case Passing::none:
        break;
      case Passing::by_position:
        if (pixel_->regions.size() > 1) read_positions();
        met.passed = passed_at_positions(met.inside, fragment.plane, region.plane);
    }
  }

  WideMask passed_at_positions(const WideMask& inside, const DepthPlane<float>& arriving,
                               const DepthPlane<float>& stored_plane) {
    work.positions_compared += 32 * pixels_.words;
    WideMask passed;
    for (std::size_t w = 0; w < pixels_.words; ++w) {
      const SamplePattern& pattern = bin_.positions.patterns[w];
      for (std::uint32_t rest = inside.words[w]; rest != 0; rest &= rest - 1) {
        const auto s = static_cast<std::size_t>(std::countr_zero(rest));
        if (depth_passes_at(rule_->depth, arriving, stored_plane, position_u(pattern, s), position_v(pattern, s)))
          passed.words[w] |= 1u << s;
      }
    }
    return passed;
  }

  // ---- Cuts ----

  // What lies inside the fragment of each region's area.
  void share_area(const Fragment& fragment) {
    const float area = fragment.alpha * kWhole;
    float whole = 0, parts = 0;
    estimates_.assign(meetings_.size(), 0.0f);
    for (std::size_t k = 0; k < meetings_.size(); ++k) {
      const Region& region = pixel_->regions[k];
      Meeting& met = meetings_[k];
      if (met.inside.none()) continue;
      if (met.inside == region.positions) {
        met.area = region.area;
        whole += static_cast<float>(region.area);
        continue;
      }
      work.counts += meetings_.size() > 1 ? 2 : 1;  // all positions are a single region's
      ++work.parts;
      estimates_[k] = part_inside(static_cast<float>(region.area), static_cast<float>(met.inside.count()),
                                  static_cast<float>(region.positions.count()));
      parts += estimates_[k];
    }
    const float scale = parts > 0 ? std::max(area - whole, 0.0f) / parts : 0.0f;
    for (std::size_t k = 0; k < meetings_.size(); ++k)
      if (estimates_[k] > 0)
        meetings_[k].area = static_cast<std::uint16_t>(
            std::min(estimates_[k] * scale + 0.5f, static_cast<float>(pixel_->regions[k].area)));
  }

  // Takes what changes out of the regions, changes it, and puts all together again.
  void cut(const Fragment& fragment, const glm::vec4& color) {
    changed_.clear();
    std::vector<Region>& regions = pixel_->regions;
    const std::size_t before = regions.size();
    std::size_t kept = 0;
    bool cuts = false;
    for (std::size_t k = 0; k < before; ++k) {
      const Meeting& met = meetings_[k];
      Region rest = regions[k];
      const auto inside = static_cast<float>(met.inside.count());
      const auto take = [&](const WideMask& positions) {
        Region part = rest;
        part.positions = positions;
        rest.positions = without(rest.positions, positions);
        if (rest.positions.none()) return part.area = rest.area, part;
        cuts = true;
        const float area =
            positions == met.inside
                ? static_cast<float>(met.area)
                : part_inside(static_cast<float>(met.area), static_cast<float>(positions.count()), inside) + 0.5f;
        part.area = std::min(static_cast<std::uint16_t>(area), rest.area);
        rest.area = static_cast<std::uint16_t>(rest.area - part.area);
        return part;
      };
      if (met.changes_passed) {
        Region part = take(met.passed);
        change(part, fragment, color);
        part.stencil = met.passed_stencil;
        changed_.push_back(part);
      }
      if (met.changes_failed) {
        Region part = take(without(met.inside, met.passed));
        part.stencil = met.failed_stencil;
        changed_.push_back(part);
      }
      if (!rest.positions.none()) regions[kept++] = rest;
    }
    regions.resize(kept);
    for (const Region& part : changed_) put(part);
    if (regions.size() > 1 && (cuts || regions.size() != before)) {
      read_positions(before);
      while (regions.size() > kMostRegions) merge_two();
      ++work.joins[regions.size()];
      work.bytes_written += planes_for(regions.size()) * pixels_.words * 4;
    }
    work.bytes_written += std::min(changed_.size(), kMostRegions) * kRegionBytes;
  }

  void change(Region& part, const Fragment& fragment, const glm::vec4& color) {
    if (rule_->writes_depth) part.triangle = fragment.triangle, part.plane = fragment.plane;
    if (!writes_color_) return;
    work.by_state += of_blend_;
    part.color = stored_color(bin_.rules, *rule_, color, part.color, stored);
    part.drawn = kWhollyDrawn;
    part.is_touched = true;
  }

  bool is_same_state(const Region& a, const Region& b) {
    ++work.comparisons;
    if (a.triangle != b.triangle || a.stencil != b.stencil) return false;
    for (int c = 0; c < 4; ++c) {
      ++work.channels_compared;
      if (std::abs(a.color[c] - b.color[c]) > kSameColor) return false;
    }
    return true;
  }

  // Adds a region to those of its state, if there are any.
  void put(const Region& part) {
    for (Region& region : pixel_->regions) {
      if (!is_same_state(region, part)) continue;
      work.mixes += region.color != part.color;
      return join(region, part);
    }
    pixel_->regions.push_back(part);
  }

  float loss(const Region& a, const Region& b) const {
    float depth = 0;
    for (const Region* const at : {&a, &b}) {
      const std::size_t position = first_position(at->positions);
      const SamplePattern& pattern = bin_.positions.patterns[position / 32];
      const float u = position_u(pattern, position % 32), v = position_v(pattern, position % 32);
      depth = greater(depth, depth_ratio(depth_at(a.plane, u, v), depth_at(b.plane, u, v)));
    }
    return loss_of_merge(&a.color[0], &b.color[0], depth, a.stencil == b.stencil,
                         static_cast<float>(std::min(a.area, b.area)));
  }

  void merge_two() {
    std::vector<Region>& regions = pixel_->regions;
    std::size_t one = 0, other = 1;
    float least = INFINITY;
    for (std::size_t a = 0; a < regions.size(); ++a) {
      for (std::size_t b = a + 1; b < regions.size(); ++b) {
        const float lost = loss(regions[a], regions[b]);
        if (lost < least) least = lost, one = a, other = b;
      }
    }
    work.pairs_compared += regions.size() * (regions.size() - 1) / 2;
    ++work.mixes;
    ++maps_.merges[index_];
    if (regions[one].area < regions[other].area) std::swap(regions[one], regions[other]);
    join(regions[one], regions[other]);
    regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(other));
  }

  // ---- Specks ----

  // Returns whether the speck's colour is needed.
  bool wait(const Fragment& speck, const glm::vec4& color) {
    ++work.specks;
    if (!writes_color_) return false;
    const std::size_t position = bin_.positions.nearest_to(speck.centroid_u, speck.centroid_v)[0];
    if (pixel_->regions.size() > 1) read_positions();
    Meeting met;
    met.inside.set(position);
    test(*std::ranges::find_if(pixel_->regions, [&](const Region& r) { return r.positions.test(position); }), speck,
         met);
    PixelObserver* const observer = observer_at(bin_.observers, index_);
    if (observer) observer->contends(speck.triangle, 32 * (position / 32), 0, 0);
    if (met.passed.none()) return false;
    if (observer) observer->shows_speck(speck.triangle);
    PendingSpecks& specks = pixel_->specks;
    const float area = speck.alpha * kWhole, sum = specks.area + area;
    for (int c = 0; c < 4; ++c) specks.color[c] = stored(mixture(specks.color[c], color[c], area / sum));
    specks.area = sum;
    specks.triangle = speck.triangle;
    ++work.mixes;
    work.bytes_read += kChunkBytes, work.bytes_written += kChunkBytes;
    store(speck.triangle);
    return true;
  }

  static bool is_smaller_target(const Region& a, const Region& b) {
    return std::pair(!a.is_touched, a.area) < std::pair(!b.is_touched, b.area);
  }

  // The draw has left the pixel.
  void add_specks(RegionPixel& pixel) {
    const PendingSpecks specks = pixel.specks;
    if (specks.area <= 0) return;
    pixel.specks = {};
    Region& region = *std::ranges::max_element(pixel.regions, is_smaller_target);
    work.comparisons += pixel.regions.size();
    if (region.is_touched || region.area == 0) return;
    const RopRule& rule = bin_.rules.of(bin_.triangles, specks.triangle);
    work.by_state += stored_color_cost(rule, 4);
    ++work.mixes;
    const float share = std::min(specks.area / static_cast<float>(region.area), 1.0f);
    const glm::vec4 now = stored_color(bin_.rules, rule, specks.color, region.color, stored);
    for (int c = 0; c < 4; ++c) region.color[c] = stored(mixture(region.color[c], now[c], share));
    region.drawn = static_cast<std::uint8_t>(mixture(static_cast<float>(region.drawn), kAllDrawn, share) + 0.5f);
    work.bytes_read += kChunkBytes, work.bytes_written += kRegionBytes;
  }

  // ---- Observers ----

  void tell(const Fragment& fragment, const glm::vec4& color) {
    PixelObserver* const observer = observer_at(bin_.observers, index_);
    if (!observer) return;
    WideMask failed = fragment.mask;
    for (const Meeting& met : meetings_) failed = without(failed, met.passed);
    for (std::size_t w = 0; w < pixels_.words; ++w) observer->contends(fragment.triangle, 32 * w, failed.words[w], 0);
    for (std::size_t k = 0; k < meetings_.size() && writes_color_; ++k) {
      const BlendParts parts =
          rule_->blend ? blend_parts(*rule_->blend, color, pixel_->regions[k].color) : BlendParts{};
      for (std::size_t position = 0; position < 32 * pixels_.words; ++position)
        if (meetings_[k].passed.test(position))
          observer->blends(fragment.triangle, position, parts.added, parts.kept, glm::vec3(color));
    }
  }

  const RegionsBin& bin_;
  RegionPixels& pixels_;
  const RegionsMaps& maps_;
  RegionsResult& result_;
  const WideMask everywhere_;

  const RopRule* rule_ = nullptr;
  const Stencil* stencil_ = nullptr;
  bool writes_color_ = false;
  OperationCounts of_blend_, of_test_, of_pass_, of_depth_fail_, of_fail_;

  std::uint32_t index_ = 0;
  RegionPixel* pixel_ = nullptr;
  bool positions_read_ = false, needs_color_ = false;
  std::vector<Meeting> meetings_;  // of each region
  std::vector<float> estimates_;
  std::vector<Region> changed_;
};

}  // namespace

void charge(const RegionsWork& work, std::size_t words, StageCounters& counters) {
  static const RegionUnitCosts costs[] = {RegionUnitCosts(1), RegionUnitCosts(2), RegionUnitCosts(4),
                                          RegionUnitCosts(8)};
  static const UnitCost of_plane = plane_cost(), of_contest = region_costs::contest(),
                        of_position = region_costs::contest_at_position(), of_part = region_costs::part(),
                        of_pair = region_costs::pair(), of_mix = region_costs::mix(),
                        of_addition = region_costs::addition(), of_speck = speck_votes_cost(0);
  constexpr OperationCounts kOfComparison{.add = 2}, kOfChannel{.add = 2, .bit = 1};  // triangle and stencil value
  const RegionUnitCosts& of_masks = costs[std::bit_width(words) - 1];
  for (std::size_t planes = 0; planes < work.splits.size(); ++planes)
    counters.ops += of_masks.splits[planes] * work.splits[planes];
  for (std::size_t regions = 0; regions < work.joins.size(); ++regions)
    counters.ops += of_masks.joins[regions] * work.joins[regions];
  counters.ops += of_masks.meeting * work.masks_tested;
  counters.ops += of_masks.parting * work.parts;
  counters.ops += of_masks.count * work.counts;
  counters.ops += of_plane * work.planes;
  counters.ops += of_contest * work.contests;
  counters.ops += of_position * work.positions_compared;
  counters.ops += of_part * work.parts;
  counters.ops += kOfComparison * work.comparisons;
  counters.ops += kOfChannel * work.channels_compared;
  counters.ops += of_pair * work.pairs_compared;
  counters.ops += of_mix * work.mixes;
  counters.ops += of_speck * work.specks;
  counters.ops += of_addition * work.finished;
  counters.ops += work.by_state;
  counters.items_in += work.fragments;
  counters.items_out += work.changing;
  counters.bytes_read += (work.fragments - work.whole) * owners_fragment_bytes(words) +
                         work.whole * kOwnersWholeFragmentBytes + work.bytes_read +
                         work.planes * (sizeof(std::uint32_t) + sizeof(ScreenDepth));
  counters.bytes_written += work.bytes_written;
  counters.position_tests += work.positions_compared;
  counters.lanes_used += work.changing;
  counters.lanes_issued += work.fragments;
}

void compose_regions(const RegionsBin& bin, const ColoredBeamFragments& fragments, StageCounters& counters,
                     RegionPixels& pixels, const RegionsMaps& maps, RegionsResult& result) {
  RegionComposer composer(bin, pixels, maps, result);
  for (std::size_t i = 0; i < fragments.list.size(); ++i)
    if (composer.add(fragments.list[i], fragments.colors[i])) result.shaded.push_back(i);
  charge(composer.work, pixels.words, counters);
}

std::vector<glm::vec4> finish_regions(const RegionsBin& bin, const glm::vec3& background, StageCounters& counters,
                                      RegionPixels& pixels, const RegionsMaps& maps, RegionsResult& result) {
  RegionComposer composer(bin, pixels, maps, result);
  composer.finish();
  RegionsWork& work = composer.work;
  std::vector<glm::vec4> picture;
  picture.reserve(pixels.pixels.size());
  for (std::uint32_t index = 0; index < pixels.pixels.size(); ++index) {
    const RegionPixel& pixel = pixels.pixels[index];
    PixelObserver* const observer = observer_at(bin.observers, index);
    glm::vec3 sum(0.0f);
    float drawn = 0;
    for (const Region& region : pixel.regions) {
      const float area = static_cast<float>(region.area) / kWhole;
      sum += area * glm::vec3(region.color);
      drawn += area * (static_cast<float>(region.drawn) / kAllDrawn);
      if (!observer) continue;
      const double share = double{area} / region.positions.count();
      for (std::size_t position = 0; position < 32 * pixels.words; ++position)
        if (region.positions.test(position)) observer->adds_samples(kNobody, position, position + 1, share, background);
    }
    picture.emplace_back(sum, std::min(drawn, 1.0f));
    work.bytes_read += kPixelWordBytes;
    if (pixel.chunks.count == 0) continue;
    work.finished += pixel.regions.size();
    work.bytes_read += pixel.regions.size() * kRegionBytes + pixel.chunks.count * pixels.pool.link_bytes();
    if (bin.lists_requests) result.visits.push_back({0, index, pixel.chunks.count, false});
    if (pixel.chunks.in_memory > 0) result.spills += ChunkRequests{.reads = pixel.chunks.in_memory};
  }
  charge(work, pixels.words, counters);
  return picture;
}

}  // namespace beampipe

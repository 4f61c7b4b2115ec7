#!/usr/bin/env bash
# Breaks the program in one place after the other and tells which test notices.
#   tests/mutation.sh [BUILD FOLDER [FILE...]]   all mutants, or those in the files that are named
#   tests/mutation.sh --check                    only looks whether the code still has what is to be broken
#
# Works on this tree, one mutant at a time, and restores each file: a clone of its own is best, with a compiler cache.
# BUILD FOLDER/mutants.txt gets a line for each mutant. A later run goes on: it leaves out those that were noticed.
# Ends with an error if no test notices a mutant.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mutants=(  # file | text as it is | broken
  'simd/lanes-inl.h|LANES_COMPARISON(<=, Le)|LANES_COMPARISON(<=, Lt)'
  'simd/lanes-inl.h|LANES_BINARY(-, Sub)|LANES_BINARY(-, Add)'
  'simd/lanes-inl.h|yes.raw, no.raw|no.raw, yes.raw'
  'simd/lanes-inl.h|hn::DemoteTo(half, x.part[1].raw)|hn::DemoteTo(half, x.part[0].raw)'
  'simd/soa-inl.h|rows + HWY_MIN(lane, count - 1)|rows'
  'simd/triangle_in_pixel-inl.h|triangle.y[k] - triangle.y[next]|triangle.y[next] - triangle.y[k]'
  'simd/coverage-inl.h|1.0f / 6.0f|1.0f / 6.1f'
  'simd/coverage-inl.h|a * b <= zero|a * b >= zero'
  'simd/coverage-inl.h|half * beyond * (from + to)|half * beyond * (from + from)'
  'simd/coverage-inl.h|b * v_out + c|b * v_in + c'
  'simd/coverage-inl.h|moment / safe_area|moment'
  'simd/depth_range-inl.h|in.dzdv * (v - half)|in.dzdv * v'
  'simd/depth_range-inl.h|corner[from] - corner[to]|corner[to] - corner[from]'
  'simd/depth_range-inl.h|corner[side + 2] < zero|corner[side + 1] < zero'
  'simd/depth_range-inl.h|include(inside_u & inside_v|include(inside_u'
  'simd/depth_plane-inl.h|plane.dzdv * v|plane.dzdv * u'
  'simd/plane_order-inl.h|< depth_at|<= depth_at'
  'simd/depth_span-inl.h|depth < stored|depth <= stored'
  'simd/sample_mask.cpp|kDecided = 1 << 30|kDecided = 1 << 20'
  'simd/sample_mask.cpp|kSmallSlope = 1 << 20|kSmallSlope = 1 << 25'
  'simd/mask_table.cpp|kTableDistances / 2)|kTableDistances / 2 + 1)'
  'simd/mask_table-inl.h|Float(kTableDistances / 2)|Float(kTableDistances / 2 + 1)'
  'simd/mask_table-inl.h|select(is_flipped, ~word, word)|select(is_flipped, word, ~word)'
  'simd/mask_table-inl.h|mask = mask & word|mask = word'
  'simd/merge-inl.h|bits(32.0f)|bits(31.0f)'
  'simd/merge-inl.h|gap.z - half_thickness|gap.z + half_thickness'
  'simd/merge-inl.h|lesser(back, old.z_max)|back'
  'simd/merge-inl.h|select(how.tiny, added, independent)|select(how.tiny, independent, added)'
  'simd/merge-inl.h|slab.a * delta};|slab.a};'
  'simd/merge-inl.h|farthest + farthest|farthest'
  'simd/merge-inl.h|moved + moved|moved'
  'simd/merge-inl.h|rest * fragment.surface.alpha|fragment.surface.alpha'
  'simd/merge-inl.h|(over.i + over.a) / greater|(over.i + slab.a) / greater'
  'simd/merge-inl.h|greater(sums.a, zero)}|sums.a}'
  'simd/merge-inl.h|select(flipped != turns|select(flipped'
  'simd/merge-inl.h|select(how.tiny, region.a, left)|region.a'
  'simd/merge-inl.h|shared.mask & ~fragment.front|shared.mask'
  'stages/beam/casav_merges.h|depth < nearest|depth <= nearest'
  'simd/sample_pattern.cpp|{1, -3}, {-1, 3}|{1, -2}, {-1, 3}'
  'simd/sample_pattern.cpp|pattern.x[static_cast<std::size_t>(i)] = i * 8 + 4|pattern.x[static_cast<std::size_t>(i)] = i * 8 + 3'
  'simd/conserve.h|fraction * fraction * own_error|fraction * own_error'
  'stages/beam/specks.h|kSurfaceReach = 1.0f / 64.0f|kSurfaceReach = 1.0f'
  'stages/beam/specks.h|kSpeckShares = 4.0f|kSpeckShares = 1.0f'
  'stages/beam/compose_beam.cpp|votes / 3.0f|votes / 2.0f'
  'stages/beam/beam_fragment.h|kZeroArea = 5e-7f|kZeroArea = 5e-5f'
  'stages/raster/reference_raster.cpp|return {2 * shift + 1,|return {2 * shift,'
  'simd/vertex_transform-inl.h|Real(double{kSubpixelUnits}) + Real(0.5)|Real(double{kSubpixelUnits}) + Real(0.25)'
  'simd/vertex_transform-inl.h|v.w > Real(0.0)|v.w >= Real(0.0)'
  'simd/vertex_transform-inl.h|magnitude(v.x) <= v.w|magnitude(v.x) < v.w'
  'simd/vertex_transform-inl.h|magnitude(v.z) <= v.w|magnitude(v.z) < v.w'
  'simd/vertex_transform-inl.h|m[8 + r] * z|m[8 + r] * y'
  'simd/vertex_transform-inl.h|one - v.y * inverse_w|one + v.y * inverse_w'
  'stages/geometry/clip.h|kGuardBand = 32768.0|kGuardBand = 65536.0'
  'simd/window_owners.cpp|kFar = std::numeric_limits<float>::infinity()|kFar = -0.25f'
  'simd/position_mask.h|kSmallSlope = 1 << 20|kSmallSlope = 1 << 25'
  'simd/position_mask.h|kDecidedByC = 1 << 30|kDecidedByC = 1 << 20'
  'simd/position_mask.h|in_row[s] - down|in_row[s] + down'
  'simd/position_mask.cpp|lesser(a, zero) + lesser(b, zero)|lesser(a, zero)'
  'simd/cell_rows.cpp|hn::Set(d, edges[k].shallowest)|hn::Set(d, edges[k].deepest)'
  'stages/beam/windows.h|return nearest <= farthest|return nearest < farthest'
  'stages/beam/windows.cpp|(belongs ? 0 : 1)|(belongs ? 1 : 0)'
  'traces/closed_mesh.cpp|side->second ? 1 : -1|1'
  'stages/beam/merge_sort.h|return depth < other|return depth <= other'
  'stages/beam/merge_sort.h|comes_first(depth_of(from[i]), depth_of(from[j]))|!comes_first(depth_of(from[j]), depth_of(from[i]))'
  'stages/data/pixel_depth.h|rounding(0x1p-21)|rounding(0x1p-31)'
  'stages/data/closed_depth.h|nearest > depth_[tile_.index(x, y)]|nearest >= depth_[tile_.index(x, y)]'
  'stages/data/closed_depth.h|nearest > farthest_|nearest >= farthest_'
  'stages/surface/texture_filter.h|std::ceil(longer / shorter)|std::floor(longer / shorter)'
  'stages/surface/texture_filter.h|(i + 0.5f) / plan.probes - 0.5f|i / plan.probes - 0.5f'
  'stages/surface/texture_filter.h|squared_x >= squared_y ? slopes.dx|squared_x < squared_y ? slopes.dx'
  'stages/surface/texture_filter.h|lod - static_cast<float>(plan.level)|lod'
  'stages/surface/texture_filter.h|std::ceil(lod + 0.5f) - 1|std::ceil(lod) - 1'
  'stages/surface/texture_filter.h|upper * upper_share + lower * rows.share|lower * upper_share + upper * rows.share'
  'stages/surface/texture_filter.h|has_next ? 2u : 1u|has_next ? 1u : 1u'
  'stages/surface/texture_filter.h|plan.level + 1 < chain.levels.size()|plan.level + 2 < chain.levels.size()'
  'stages/surface/surface_shader.cpp|batches[current].work != work) {|false) {'
  'stages/surface/surface_shader.cpp|if (!inputs && !is_kept) continue;|if (!inputs) continue;'
  'stages/surface/surface_shader.cpp|[uv, slopes] = points[texture.uv_set];|[uv, slopes] = points[0];'
  'stages/surface/surface_shader.cpp|at = points[texture.uv_set];|at = points[0];'
  'stages/surface/texture_filter.h|for (int i = 0; i < 2; ++i) texel -=|for (int i = 0; i < 1; ++i) texel -='
  'stages/beam/compose_pooled_colors-inl.h|shaded_at_[first_shaded_[pixel] + k]|shaded_at_[first_shaded_[pixel]]'
  'stages/picture/resolve.cpp|run.begin / samples_per_cell|run.begin'
  'stages/surface/mip_chain.cpp|std::max(begin, double(i))|begin'
  'stages/surface/opacity.h|131, 285}|131, 283}'
  'stages/surface/opacity.h|>> 16) * (1.0f / 65536.0f)|>> 16) * (1.0f / 32768.0f)'
  'stages/surface/sheets.cpp|!is_beside(a, b, work) && !is_beside(b, a, work)|!is_beside(a, b, work)'
  'stages/surface/sheets.cpp|!is_beside(a, b, work) && !is_beside(b, a, work)|!is_beside(b, a, work)'
  'stages/surface/sheets.cpp|end != first + 2|end < first + 2'
  'stages/surface/surface_formulas-inl.h|tangent[axis] - along * normal[axis]|tangent[axis]'
  'stages/surface/surface_formulas-inl.h|cross(normal, tangent), point.facing|cross(normal, tangent), Real(1.0f)'
  'stages/surface/surface_formulas-inl.h|grazing2 * grazing2 * grazing|grazing2 * grazing2'
  'stages/surface/surface_formulas-inl.h|(one - reflectance) * diffuse[c]|diffuse[c]'
  'stages/geometry/depth_order.cpp|group.triangles[part] > most|group.triangles[part] >= most'
  'stages/geometry/setup_formulas.h|greater(magnitude(dzdx), magnitude(dzdy)) / magnitude(terms.window_scale)|greater(magnitude(dzdx), magnitude(dzdy))'
  'stages/geometry/setup_formulas.h|lesser(bias, terms.clamp)|bias'
  'stages/geometry/setup_formulas.h|lesser(window_offset, end) - nearest|window_offset - nearest'
  'stages/raster/bin_sort.cpp|plane.z -= kRounding|plane.z += kRounding'
  'stages/raster/bin_sort.cpp|(1u << kDroppedBits) - 1) >> kDroppedBits|(1u << kDroppedBits)) >> kDroppedBits'
  'stages/beam/compose_layers.cpp|z_min <= incoming.surface.z_min|z_min < incoming.surface.z_min'
  'stages/beam/compose_layers.cpp|gap < least|gap > least'
  'stages/beam/compose_layers.cpp|depth_between(all[k].surface, all[k + 1].surface)|depth_between(all[0].surface, all[k + 1].surface)'
  'stages/beam/compose_layers.cpp|std::max(result.thickness, farther.surface.thickness)|result.thickness'
  'stages/beam/owner_rules.h|alpha * votes / Float(3.0f)|alpha * votes / Float(2.0f)'
  'stages/beam/owner_rules.h|lesser(one.visible, other.visible)|one.visible'
  'stages/beam/owner_rules.h|plane.z - reach > watermark|plane.z > watermark'
  'stages/beam/owner_rules.h|plane.z + reach <= watermark|plane.z <= watermark'
  'stages/beam/compose_pooled.cpp|place.fraction <= order_[j - 1].fraction|place.fraction >= order_[j - 1].fraction'
  'stages/beam/owner_rules.h|greater(one, other) - lesser(one, other)|lesser(one, other) - lesser(one, other)'
  'stages/beam/compose_pooled.cpp|one.visible >= other.visible ? one : other|one.visible >= other.visible ? other : one'
  'stages/beam/compose_pooled.cpp|fragment.triangle < bin_.list|fragment.triangle > bin_.list'
  'stages/beam/position_states-inl.h|without(states[state], here)|states[state]'
  'stages/beam/position_states-inl.h|if (state >> p & 1)|if (state >> p)'
  'stages/beam/compose_pooled.cpp|side == Side::nearer && fragment.whole|side == Side::nearer'
  'stages/beam/position_states-inl.h|positions = without(positions, claimed);|'
  'stages/beam/position_states-inl.h|(empty & mask)|empty'
  'stages/beam/position_states-inl.h|(owned & mask)|owned'
  'stages/beam/compose_pooled.cpp|if (at_.shape.has_sums) {|if (false) {'
  'stages/beam/compose_pooled.cpp|if (!at_.has_room(with_sums)) {|if (false) {'
  'stages/beam/compose_pooled.cpp|if (fragment.triangle >= pixels.closes_at) pixels.pool.close();|'
  'stages/data/pooled_pixels.h|std::min<std::size_t>(given, of.in_memory)|std::size_t{0}'
  'stages/data/pooled_pixels.h|4 * taken_since_collection_ > on_chip_|4 * taken_since_collection_ > 0'
  'stages/data/pooled_pixels.h|set(to, slots[from], plane(from)|set(to, slots[to], plane(from)'
  'stages/beam/compose_pooled_pixel-inl.h|if (size <= word_->record_size) return;|return;'
  'stages/beam/compose_pooled_pixel-inl.h|owned(k).store(view.owned(k));|'
  'stages/beam/compose_pooled_pixel-inl.h|view.head->sums = record.head->sums;|'
  'stages/beam/compose_pooled_pixel-inl.h|spare_ = pixels_.records.take(0);|'
  'stages/beam/compose_pooled_pixel-inl.h|if (shape.has_final) final.store(record.head->final);|'
  'stages/beam/compose_pooled.cpp|if (!retire_final(candidates, watermark)) continue;|if (retire_final(candidates, watermark)) continue;'
  'stages/beam/compose_pooled.cpp|at_.shape.owners < before|false'
  'stages/beam/compose_pooled_cost.h|of_take * work.takes|of_take * work.wins'
  'stages/beam/compose_pooled_cost.h|of_votes[planes] * work.specks[planes]|of_votes[0] * work.specks[planes]'
  'stages/beam/compose_pooled_cost.h|of_join[states] * work.joins[states]|of_join[1] * work.joins[states]'
  'stages/beam/beam_fragment_cost.cpp|.narrow * work.edges.narrow|.narrow * work.edges.wide'
  'stages/beam/beam_fragment_cost.cpp|of_pair += of_grid_edges;|'
  'stages/beam/owner_rules.h|Float(kAreaTolerance) / positions|Float(2 * kAreaTolerance) / positions'
  'simd/depth_plane-inl.h|Float(0.5f) * (magnitude|Float(0.25f) * (magnitude'
  'stages/beam/compose_z3.cpp|share * a.color() + rest * b.color()|rest * a.color() + share * b.color()'
  'stages/beam/alpha_mask.cpp|sum += part;|sum += part > 0;'
  'stages/beam/alpha_mask.cpp|2 * places, quarters)|places, quarters)'
  'stages/beam/alpha_mask.cpp|1.0f / std::sqrt|0.5f / std::sqrt'
  'stages/samples/alpha_test.cpp|alpha >= cutoff ? fragment.mask|alpha > cutoff ? fragment.mask'
  'stages/samples/alpha_test.cpp|return alpha_at(place_of(fragment, s)) >= cutoff|return alpha_at(place_of(fragment, s)) > cutoff'
  'stages/samples/dilate.cpp|other.draw == sample.draw|true'
  'stages/samples/dilate.cpp|marked / 8|marked / 16'
  'stages/samples/accumulate.cpp|fragment.mask &= ~taken|fragment.mask &= taken'
  'stages/data/accumulator.h|255.0f + 0.5f|255.0f'
  'stages/samples/accumulate.cpp|accumulator.background[pixel] += bit_count|accumulator.background[pixel] -= bit_count'
  'stages/samples/blend.cpp|glm::vec3(color) * color.a, color.a|glm::vec3(color), color.a'
  'stages/samples/blend.cpp|accumulator.background[pixel] *= 1 - color.a|accumulator.background[pixel] *= 1'
  'stages/samples/test_depth_cost.h|4 * (launched - left)|4 * launched'
  'stages/samples/material_sort.cpp|8 * digit)|4 * digit)'
  'stages/samples/sample_select.cpp|std::uint32_t{i != j && masks[i] != 0|std::uint32_t{masks[i] != 0'
  'stages/temporal/temporal_formulas.h|lesser(box.high, old)|old'
  'stages/temporal/temporal_formulas.h|x - half - left|x - left'
  'stages/temporal/temporal_formulas.h|lesser(depth, farthest)|depth'
  'stages/temporal/motion.cpp|glm::inverse(pose.transform) * to_world|to_world'
  'stages/picture/picture_formulas.h|background[c] * rest|background[c]'
  'pipeline/memory/block_cache.cpp|request.written_bytes[sector] >= whole|request.written_bytes[sector] > whole'
  'pipeline/memory/block_cache.h|(write & ~overwritten)|write'
  'pipeline/memory/block_cache.h|if (line.newer != kNone) use(line)|'
  'pipeline/memory/linear_memory.cpp|lines <= l1_.ways() ? times : 1|times'
  'pipeline/memory/texture_memory.cpp|way->used < found->used|way->used > found->used'
  'pipeline/memory/texture_memory.cpp|found->used = ++now_;|found->used = now_;'
  'stages/surface/surface_formulas-inl.h|squared * squared + variance + variance|squared * squared + variance'
  'stages/geometry/depth_order.cpp|  function == Compare::always;|  function == Compare::never;'
  'stages/beam/alpha_mask.cpp|fragment.alpha *= part|fragment.alpha += part - 1'
  'stages/beam/compose_pooled_cost.h|of_contest * work.contests|of_contest * work.claims'
  'stages/beam/compose_pooled_pixel-inl.h|new_slots += has_cover;|'
  'stages/beam/compose_pooled_pixel-inl.h|(count - before.count) * pixels_.pool.link_bytes()|0'
  'stages/data/pooled_pixels.h|beyond_guaranteed_ + beyond(count)|beyond_guaranteed_ + count'
  'pipeline/units/frame_pool.h|a.chunks > b.chunks|a.chunks < b.chunks'
  'pipeline/memory/record_memory.cpp|record.push_back(free_.back());|record.push_back(never_taken_++);'
  'stages/samples/blend_cost.h|samples.tested * kSampleDepthBytes|samples.passed * kSampleDepthBytes'
  'stages/beam/alpha_mask_cost.h|rank_cost() * work.ranked|rank_cost() * work.tests'
  'stages/beam/alpha_mask_cost.h|work.masks * kSheetBytes|work.fragments * kSheetBytes'
  'stages/beam/compose_layers_cost.h|if (layers > 1) counters.ops|counters.ops'
  'stages/beam/compose_z3_cost.h|arrival_cost() * work.fragments|arrival_cost() * work.taken'
  'stages/beam/compose_z3_cost.h|layers * (layers - 1) / 2|layers * layers / 2'
  'stages/cost/closed_depth_cost.h|work.changes + 2 * work.refreshed_pixels|work.changes + work.refreshed_pixels'
  'stages/geometry/depth_order.cpp|left > done ? Part::behind|left >= done ? Part::behind'
  'stages/geometry/depth_order.cpp|group.is_reversed = greater > less|group.is_reversed = greater >= less'
  'stages/geometry/draw_plan.cpp|1 - 2 * y / height - h / height|1 - 2 * y / height + h / height'
  'stages/geometry/draw_plan.cpp|if (depth.cleared_before) drawn_again.clear();|'
  'stages/geometry/draw_plan.cpp|translucent && replaces(*state.blend)|translucent'
  'stages/geometry/draw_plan.cpp|is(blend, BlendFactor::source_alpha, BlendFactor::zero)|false'
  'stages/geometry/draw_plan.cpp|top = std::min(y, y + h)|top = y'
  'stages/geometry/draw_plan.cpp|left = std::max(left, x)|left = x'
  'stages/rop/rop_rules.cpp|stencil.depth_fail != kKeep|false'
  'stages/geometry/draw_plan.cpp|sides[1] >= sides[3]|sides[1] > sides[3]'
  'stages/samples/accumulate.cpp|sum.a - accumulator.background[i]|sum.a'
  'stages/samples/accumulate_cost.h|counters.bytes_written += passed * kStencilBytes|counters.bytes_written += tested * kStencilBytes'
  'stages/samples/dilate_cost.h|channel < 3 * 4|channel < 3 * 3'
  'stages/samples/dilate_cost.h|neighbors * kSampleBytes|pixels * kSampleBytes'
  'stages/samples/material_sort_cost.h|kSortSum * (kSortDigits * passes)|kSortSum * kSortDigits'
  'stages/samples/materials.cpp|digits < 4|digits < 3'
  'stages/samples/materials.cpp|8 * digits != 0|8 * digits > 1'
  'stages/samples/materials.cpp|static_cast<float>(triangles.draws[i]), kd.r|0.0f, kd.r'
  'stages/samples/materials.cpp|kd.r, kd.g, kd.b}|kd.r, kd.g, 0}'
  'stages/surface/mip_chain.cpp|std::max(width / 2, 1u)|std::max((width + 1) / 2, 1u)'
  'stages/surface/mip_chain.cpp|space == ColorSpace::srgb && c < 3|space == ColorSpace::srgb'
  'stages/surface/sheets_cost.h|edge_test_cost() * work.edge_tests|edge_test_cost() * work.pairs'
  'stages/surface/sheets_cost.h|std::bit_width(sides)|1'
  'stages/temporal/motion.cpp|fastest = greater(fastest|fastest = lesser(fastest'
  'stages/temporal/motion.cpp|1 - (1 + 2 * placement.depth_offset)|1 + (1 + 2 * placement.depth_offset)'
  'stages/temporal/motion.cpp|depth_offset < -1 ? -1.0 : 1.0|depth_offset < -1 ? 1.0 : -1.0'
  'stages/temporal/motion_cost.h|draw_cost() * draws|draw_cost() * pixels'
  'tools/evaluate/hardware_units.cpp|4 * rates.at("quads_per_clk")|rates.at("quads_per_clk")'
  'pipeline/memory/parameters.h|std::min(room, static_cast<double>(most_bins(pixels)))|room'
  'tools/evaluate/modelled_time.cpp|free_at.top() + work|work'
  'tools/evaluate/modelled_time.cpp|(info_of_unit(unit).is_of_cores ? of_cores : shared)[unit]|of_cores[unit]'
  'tools/evaluate/modelled_time.cpp|busiest_of(before).second + of_bins.ms|of_bins.ms'
  'tools/evaluate/sensitivity.cpp|(values.size() + 19) / 20 - 1|values.size() / 20'
  'tools/evaluate/sensitivity.cpp|std::pow(range.high / range.low, uniform(random))|(1 + uniform(random) * (range.high / range.low - 1))'
  'tools/evaluate/remodel.cpp|report.hardware.memory = report.memory;|'
  'pipeline/bins/render_bins.cpp|held += spilled_[bin].peak_bytes|held = spilled_[bin].peak_bytes'
  'pipeline/bins/render_bins.cpp|static_cast<double>(held - room)|static_cast<double>(held)'
  'pipeline/memory/framebuffer.cpp|!has_room_for(memory.bins_per_core)|!has_room_for(1)'
  'pipeline/memory/framebuffer.cpp|return has_room_for(1) ? side : largest|return side'
  'tools/evaluate/modelled_time.cpp|stage.stage.id == StageId::shade && !has_light|stage.stage.id == StageId::shade'
  'tools/evaluate/modelled_time.cpp|if (registers > 0) of_core = std::min|if (registers > 0) of_core = std::max'
  'tools/evaluate/hardware_units.cpp|s.logical_bytes() - s.texture_bytes|s.logical_bytes()'
  'tools/evaluate/hardware_units.cpp|s.pixels_on_chip ? rates|!s.pixels_on_chip ? rates'
  'tools/evaluate/hardware_units.cpp|over(mul_add, rates.of_cores("core_mul_add_per_clk"))|0'
  'tools/evaluate/hardware_units.cpp|over(total + wide,|over(total,'
  'tools/evaluate/hardware_units.cpp|std::max(1 - wide / (mul_add + add), 0.0)|1.0'
  'tools/evaluate/hardware_units.cpp|over(s.lanes_used, rates|over(s.items_out, rates'
  'pipeline/bins/bands.cpp|edge.b > 0 ? bottom : top|edge.b > 0 ? top : bottom'
  'pipeline/bins/bands.cpp|floor_of(-at_zero - 1,|floor_of(-at_zero,'
)

stale=0
for mutant in "${mutants[@]}"; do
  IFS='|' read -r file whole broken <<<"$mutant"
  [[ -f $file ]] && WHOLE=$whole perl -0ne '$found = () = /\Q$ENV{WHOLE}\E/g; exit($found != 1)' "$file" && continue
  echo "$file does not have exactly one \"$whole\"" >&2
  stale=1
done
[[ $stale == 0 && ${1:-} != --check ]] || exit $stale

build=${1:-build/release}
only=" ${*:2} "
results=$build/mutants.txt
touch "$results"
unnoticed=0
for mutant in "${mutants[@]}"; do
  IFS='|' read -r file whole broken <<<"$mutant"
  [[ $only == "  " || $only == *" $file "* ]] || continue
  ! grep -F -- "$mutant: " "$results" | grep -qv ": NOBODY$" || continue
  original=$(mktemp)
  cp "$file" "$original"
  trap 'cp "$original" "$file"' EXIT
  WHOLE=$whole BROKEN=$broken perl -0pi -e 's/\Q$ENV{WHOLE}\E/$ENV{BROKEN}/' "$file"
  noticed=
  case $file in
    simd/*) folders=(simd stages pipeline) ;;
    stages/spirv/*) folders=(spirv programs) ;;
    stages/surface/*) folders=(stages programs pipeline) ;;
    stages/*) folders=(stages pipeline) ;;
    pipeline/*) folders=(pipeline tools) ;;
    *) folders=("${file%%/*}") ;;
  esac
  for folder in "${folders[@]}"; do
    if ! cmake --build "$build" --target "${folder}_tests" >/dev/null 2>&1; then
      noticed="the compiler"  # of a build with warnings as errors
      break
    fi
    log=$(timeout 20m "$build/tests/${folder}_tests" --gtest_fail_fast --gtest_brief=1 2>&1) && continue
    noticed=$(sed -n 's/^\[  FAILED  \] \([^ ,]*\).*/\1/p' <<<"$log" | head -1)
    noticed=${noticed:-${folder}_tests, which crashed or did not end}
    break
  done
  cp "$original" "$file"
  trap - EXIT
  rm "$original"
  echo "$mutant: ${noticed:-NOBODY}" | tee -a "$results"
  [[ $noticed ]] || unnoticed=1
done
exit $unnoticed

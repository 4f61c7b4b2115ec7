#include "stages/surface/lit_colors.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/surface/lit_colors.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "stages/surface/surface_formulas-inl.h"

// Sets results[i] to formula(row i of the block).
template <class Columns, class Block, class Result, class Formula>
HWY_INLINE void map_columns(const Block& block, std::size_t count, Result* results, const Formula& formula) {
  constexpr std::size_t kLanes = sizeof(Floats) / sizeof(float);
  for (std::size_t first = 0; first < count; first += kLanes)
    store_rows(formula(load_columns<Columns>(block, first)), HWY_MIN(kLanes, count - first), results + first);
}

void lit_colors_kernel(const ShaderInputs& shader, const Lighting& lighting, const PointInputs<PointColumn>& points,
                       std::size_t count, glm::vec4* colors) {
  map_columns<PointInputs<Floats>>(points, count, colors, [&](const PointInputs<Floats>& point) HWY_ATTR {
    const SurfaceMaterial<Floats> material = material_of(shader, point);
    const Triple<Floats> color = lit_color(shader.material, material, lighting);
    return std::array<Floats, 4>{color[0], color[1], color[2], material.alpha};
  });
}

void light_ranges_kernel(const ShaderInputs& shader, const Lighting& lighting, const AreaInputs<PointColumn>& areas,
                         std::size_t count, float* ranges) {
  map_columns<AreaInputs<Floats>>(areas, count, ranges, [&](const AreaInputs<Floats>& area) HWY_ATTR {
    return light_range(shader, area, lighting);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(lit_colors_kernel);
HWY_EXPORT(light_ranges_kernel);

void lit_colors(const ShaderInputs& shader, const Lighting& lighting, const PointInputs<PointColumn>& points,
                std::size_t count, glm::vec4* colors) {
  HWY_DYNAMIC_DISPATCH(lit_colors_kernel)(shader, lighting, points, count, colors);
}

void light_ranges(const ShaderInputs& shader, const Lighting& lighting, const AreaInputs<PointColumn>& areas,
                  std::size_t count, float* ranges) {
  HWY_DYNAMIC_DISPATCH(light_ranges_kernel)(shader, lighting, areas, count, ranges);
}
}  // namespace beampipe
#endif

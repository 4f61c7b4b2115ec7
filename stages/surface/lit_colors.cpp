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

void lit_colors_kernel(const ShaderInputs& shader, const Lighting& lighting, const PointInputs<float>* points,
                       std::size_t count, glm::vec3* colors) {
  map_rows<PointInputs<Floats>>(points, count, colors, [&](const PointInputs<Floats>& point) HWY_ATTR {
    return lit_color(shader.material, material_of(shader, point), lighting);
  });
}

void light_ranges_kernel(const ShaderInputs& shader, const Lighting& lighting, const AreaInputs<float>* areas,
                         std::size_t count, float* ranges) {
  map_rows<AreaInputs<Floats>>(areas, count, ranges, [&](const AreaInputs<Floats>& area) HWY_ATTR {
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

void lit_colors(const ShaderInputs& shader, const Lighting& lighting, const PointInputs<float>* points,
                std::size_t count, glm::vec3* colors) {
  HWY_DYNAMIC_DISPATCH(lit_colors_kernel)(shader, lighting, points, count, colors);
}

void light_ranges(const ShaderInputs& shader, const Lighting& lighting, const AreaInputs<float>* areas,
                  std::size_t count, float* ranges) {
  HWY_DYNAMIC_DISPATCH(light_ranges_kernel)(shader, lighting, areas, count, ranges);
}
}  // namespace beampipe
#endif

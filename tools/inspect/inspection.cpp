#include "tools/inspect/inspection.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "pipeline/spec.h"
#include "pipeline/stored_colors.h"
#include "pipeline/technique_table.h"
#include "stages/geometry/vertex_setup.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/metrics.h"

namespace beampipe {
namespace {

glm::vec4 color_at(const Image& image, PixelAddress at) {
  const float* rgba = image.rgba.data() + 4 * (std::size_t{at.y} * image.width + at.x);
  return {rgba[0], rgba[1], rgba[2], rgba[3]};
}

glm::dvec3 mean_color(const PixelHistory& history, std::uint32_t fragment, const glm::dvec3& otherwise) {
  glm::dvec3 sum(0.0);
  double weight = 0;
  for (const HistoryTerm& term : history.terms)
    if (term.fragment == fragment) sum += term.weight * term.color, weight += term.weight;
  return weight != 0 ? sum / weight : otherwise;
}

// The surfaces that matter, and the transfers between them.
void add_explanation(const ExplainedPixel& explained, PixelInspection& inspection) {
  const PixelHistory& history = inspection.history;
  std::vector<std::size_t> place(explained.surfaces.size());
  for (std::size_t i = 0; i < explained.surfaces.size(); ++i) {
    const ExplainedSurface& surface = explained.surfaces[i];
    std::uint32_t fragment = kNobody;
    for (std::uint32_t k = 0; k < history.fragments.size(); ++k)
      if (history.fragments[k].triangle == surface.triangle) fragment = k;
    place[i] = inspection.surfaces.size();
    const bool is_background = surface.triangle == kNoTriangle;
    if (surface.weight == 0 && surface.truth == 0 && !is_background) continue;
    inspection.surfaces.push_back(
        {fragment, surface.weight, surface.truth, mean_color(history, fragment, surface.color)});
  }
  for (const AreaTransfer& each : explained.transfers)
    inspection.transfers.push_back({place[each.from], place[each.to], each.area, each.cause});
  const auto effect = [&](const AreaTransfer& each) {
    return each.area * glm::length(inspection.surfaces[each.to].color - inspection.surfaces[each.from].color);
  };
  std::stable_sort(inspection.transfers.begin(), inspection.transfers.end(),
                   [&](const AreaTransfer& a, const AreaTransfer& b) { return effect(a) > effect(b); });
  inspection.causes.assign(explained.causes.begin(), explained.causes.end());
  if (!explained.surfaces.empty()) return;
  // Draws keep the API's order: there is what each fragment has put into the pixel in the end, and nothing to compare
  // it with.
  std::map<std::uint32_t, double> weights;  // by fragment; the background's number is the greatest
  for (const HistoryTerm& term : history.terms) weights[term.fragment] += term.weight;
  for (const auto& [fragment, weight] : weights)
    if (weight != 0 || fragment == kNobody)
      inspection.surfaces.push_back({fragment, weight, std::nullopt, mean_color(history, fragment, glm::dvec3(0.0))});
}

std::vector<PixelHistory> observed(const Technique& technique, const Trace& trace, std::size_t frame,
                                   const FrameInput& run) {
  std::vector<PixelHistory> histories;
  technique.render(trace, frame, run, {.histories = &histories});
  return histories;
}

}  // namespace

bool has_owners(const PixelHistory& history) {
  return std::ranges::any_of(history.owners, [](std::uint32_t owner) { return owner != kNobody; });
}

std::vector<std::string> inspectable_names() {
  std::vector<std::string> names;
  for (const TechniqueKind& kind : technique_kinds())
    if (parse_technique(kind.examples.front()).is_observable && (names.empty() || names.back() != kind.name))
      names.push_back(kind.name);
  return names;
}

void require_inspectable(const Technique& technique) {
  if (technique.is_observable) return;
  const std::string why = technique.keeps_history        ? "its pixels depend on earlier frames and on their neighbours"
                          : is_reference(technique.spec) ? "it is what the others are compared with"
                                                         : "it does not record what it decides";
  throw SpecError("technique '" + technique.spec + "' cannot be inspected: expected " + list_of(inspectable_names()) +
                  "; " + why);
}

std::vector<PixelInspection> inspect(const Trace& trace, std::size_t frame, const Technique& technique,
                                     const std::vector<PixelAddress>& pixels, const FrameInput& run) {
  FrameInput only = run;
  only.memory.modelled = false;
  only.pixels = &pixels;
  const Technique reference = parse_technique(kReferenceSpec);
  const Frame& of_trace = trace.frames.at(frame);
  const Image truth = reference.render(trace, frame, only).image;
  std::vector<PixelHistory> histories = observed(technique, trace, frame, only);

  // If surfaces vary, causes are those of the error in visibility.
  const bool varies = has_varying_surfaces(trace, of_trace);
  FrameInput by_pixel = only;
  by_pixel.colors = SurfaceColors::by_pixel;
  std::vector<PixelHistory> visible;
  Image visible_truth = truth;
  if (varies) {
    visible = observed(technique, trace, frame, by_pixel);
    visible_truth = reference.render(trace, frame, by_pixel).image;
  }
  std::vector<PixelInspection> inspections;
  std::vector<PixelColors> colors;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    PixelInspection& inspection = inspections.emplace_back();
    inspection.technique = technique.spec;
    inspection.frame = frame;
    inspection.history = std::move(histories[i]);
    const PixelHistory& history = inspection.history;
    for (const HistoryFragment& each : history.fragments)
      inspection.draw_names.push_back(std::to_string(each.draw) + " '" +
                                      trace.meshes[of_trace.draws[each.draw].mesh].name + "'");
    inspection.target = of_trace.target;
    inspection.picture = shown(of_trace.target, glm::vec3(history.pixel));
    inspection.reference = glm::vec3(color_at(truth, pixels[i]));
    inspection.error = root_mean_square(glm::dvec3(inspection.picture) - glm::dvec3(inspection.reference));
    const PixelHistory& seen = varies ? visible[i] : history;
    colors.push_back({pixels[i], seen.weights(), shown(of_trace.target, glm::vec3(seen.pixel)),
                      glm::vec3(color_at(visible_truth, pixels[i]))});
    if (varies) inspection.visibility_error = root_mean_square(colors.back().color - colors.back().reference);
  }
  const std::vector<ExplainedPixel> explained = explain_pixels(trace, of_trace, colors, varies ? by_pixel : only);
  for (std::size_t i = 0; i < pixels.size(); ++i) add_explanation(explained[i], inspections[i]);
  return inspections;
}

std::vector<PixelAddress> worst_pixels(const Image& image, const Image& reference, std::size_t count) {
  const std::vector<float> errors = pixel_errors(image, reference);
  std::vector<std::size_t> pixels(errors.size());
  std::iota(pixels.begin(), pixels.end(), 0);
  count = std::min(count, pixels.size());
  std::partial_sort(
      pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(count), pixels.end(),
      [&](std::size_t a, std::size_t b) { return errors[a] > errors[b] || (errors[a] == errors[b] && a < b); });
  std::vector<PixelAddress> worst;
  for (std::size_t i = 0; i < count; ++i)
    worst.push_back(
        {static_cast<std::uint32_t>(pixels[i] % image.width), static_cast<std::uint32_t>(pixels[i] / image.width)});
  return worst;
}

}  // namespace beampipe

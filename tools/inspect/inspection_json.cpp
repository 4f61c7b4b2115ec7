#include "tools/inspect/inspection_json.h"

#include <algorithm>
#include <span>

#include "tools/inspect/inspection_text.h"

namespace beampipe {
namespace {

constexpr const char* kSteps[] = {"merged", "settled", "dropped", "composed", "pass"};  // of HistoryStep::Kind

// A fragment by its index in "fragments", or null for the background.
Form<std::uint32_t> fragment_form() {
  return {{{"type", Json::array({"integer", "null"})}, {"minimum", 0}}, {}, [](const std::uint32_t& fragment) {
            return fragment == kNobody ? Json() : Json(fragment);
          }};
}

Form<std::vector<PositionMove>> moves_form() {
  return form::list(
      Form<PositionMove>(ObjectForm<PositionMove>()
                             .written("fragment", &PositionMove::fragment, fragment_form(),
                                      "The other fragment: its index in \"fragments\". Null: the background.")
                             .written("positions", &PositionMove::positions, form::count(), "So many.")));
}

Form<HeldSurface> held_form() {
  return ObjectForm<HeldSurface>()
      .written("fragments", &HeldSurface::fragments, form::list(fragment_form()), "The fragments in it, by index.")
      .written("positions", &HeldSurface::positions, form::count(), "That it owns.")
      .written("area", &HeldSurface::area, form::number(), "Part of the pixel.")
      .written("color", &HeldSurface::color, form::vector<glm::vec3>(), "Linear RGB.");
}

Form<HistoryStep> step_form() {
  return ObjectForm<HistoryStep>()
      .written(
          "step", [](const HistoryStep& step) { return kSteps[static_cast<std::size_t>(step.kind)]; },
          form::one_of({std::begin(kSteps), std::end(kSteps)}), "What it did.")
      .written("after_fragment", &HistoryStep::after_fragment, fragment_form(),
               "The fragment that made it do so: its index in \"fragments\". Null: the background.")
      .written("before", &HistoryStep::before, form::list(held_form()), "The surfaces before it.")
      .written("after", &HistoryStep::after, held_form(), "The surface after it.");
}

// A fragment of the history, with the name of its draw.
struct NamedFragment {
  HistoryFragment fragment;
  std::string draw_name;
};

std::string mask_text(const NamedFragment& named) {
  std::string mask;
  for (const bool covered : named.fragment.mask) mask += covered ? '1' : '0';
  return mask;
}

Form<NamedFragment> named_form() {
  const auto of = [](auto HistoryFragment::*member) {
    return [member](const NamedFragment& named) { return named.fragment.*member; };
  };
  using Fragment = HistoryFragment;
  const auto corners = [](const NamedFragment& named) {
    return std::vector<glm::dvec2>(std::begin(named.fragment.corners), std::end(named.fragment.corners));
  };
  const auto depth = [](const NamedFragment& named) {
    return glm::vec2(named.fragment.nearest, named.fragment.farthest);
  };
  return ObjectForm<NamedFragment>()
      .written("triangle", of(&Fragment::triangle), form::count(), "Its number, as `beampipe export-soup` writes it.")
      .written("draw", of(&Fragment::draw), form::count(), "Index of its draw.")
      .written("draw_name", &NamedFragment::draw_name, form::text(), "The draw with its mesh.")
      .written("corners", corners, form::list(form::vector<glm::dvec2>()),
               "Of the part of the triangle in the picture, in pixels.")
      .written("area", of(&Fragment::area), form::number(0, 1), "Exact part of the pixel that it covers.")
      .written("depth", depth, form::vector<glm::vec2>(), "The bounds of its depth in the pixel, the nearest first.")
      .written("front", of(&Fragment::is_front), form::boolean(), "It shows its front.")
      .written("mask", mask_text, form::text(),
               "The positions that it covers: 1 for each covered one, in the order of \"positions\".")
      .written(
          "fate", [](const NamedFragment& named) { return fate_text(named.fragment.fate); }, form::text(),
          "What became of it.")
      .written("taken", of(&Fragment::taken), moves_form(), "Positions that it took, and from whom.")
      .written("lost", of(&Fragment::lost), moves_form(), "Positions that it covers and lost, and to whom.");
}

std::vector<NamedFragment> named_fragments(const PixelInspection& inspection) {
  std::vector<NamedFragment> named;
  for (std::size_t i = 0; i < inspection.history.fragments.size(); ++i)
    named.push_back({inspection.history.fragments[i], inspection.draw_names[i]});
  return named;
}

Form<PixelEstimates> estimates_form() {
  return ObjectForm<PixelEstimates>()
      .written("analytic", &PixelEstimates::analytic, form::vector<glm::dvec4>(), "From areas.")
      .written("counted", &PixelEstimates::counted, form::vector<glm::dvec4>(), "From positions.")
      .written("result", &PixelEstimates::result, form::vector<glm::dvec4>(), "What was taken.");
}

Form<HistoryTerm> term_form() {
  return ObjectForm<HistoryTerm>()
      .written("fragment", &HistoryTerm::fragment, fragment_form(), "Whose it is. Null: the background's.")
      .written("weight", &HistoryTerm::weight, form::number(), "Part of the pixel.")
      .written("color", &HistoryTerm::color, form::vector<glm::dvec3>(), "Its colour, as stored.");
}

Form<InspectedSurface> surface_form() {
  return ObjectForm<InspectedSurface>()
      .written("fragment", &InspectedSurface::fragment, fragment_form(), "Which. Null: the background.")
      .written("weight", &InspectedSurface::weight, form::number(), "Part of the pixel by the technique.")
      .written("reference_weight", &InspectedSurface::truth, form::number(),
               "Part of the pixel by the reference; not where draws keep the API's order.")
      .written("color", &InspectedSurface::color, form::vector<glm::dvec3>(), "Its colour, as stored.");
}

Form<AreaTransfer> transfer_form() {
  return ObjectForm<AreaTransfer>()
      .written("from_surface", &AreaTransfer::from, form::count(), "Index in \"surfaces\".")
      .written("to_surface", &AreaTransfer::to, form::count(), "Index in \"surfaces\".")
      .written("area", &AreaTransfer::area, form::number(), "Part of the pixel.")
      .written(
          "cause", [](const AreaTransfer& transfer) { return kErrorCauses[transfer.cause]; },
          form::one_of({std::begin(kErrorCauses), std::end(kErrorCauses)}), "Why.");
}

std::vector<AreaTransfer> first_transfers(const PixelInspection& inspection) {
  constexpr std::size_t kMost = 1000;  // there are as many as losers times gainers
  const auto first = std::span(inspection.transfers).first(std::min(kMost, inspection.transfers.size()));
  return {first.begin(), first.end()};
}

Json causes_of(const PixelInspection& inspection) {
  Json causes = Json::object();
  for (std::size_t cause = 0; cause < inspection.causes.size(); ++cause)
    causes[kErrorCauses[cause]] = inspection.causes[cause];
  return causes;
}

Form<PixelInspection> inspection_form() {
  using Pixel = PixelInspection;
  const auto of = [](auto PixelHistory::*member) {
    return [member](const Pixel& pixel) { return pixel.history.*member; };
  };
  return ObjectForm<Pixel>()
      .written("technique", &Pixel::technique, form::text("a spec"), "The spec.")
      .written("frame", &Pixel::frame, form::count(), "Index in the trace.")
      .written(
          "x", [](const Pixel& pixel) { return pixel.history.at.x; }, form::count(), "Column, from the left.")
      .written(
          "y", [](const Pixel& pixel) { return pixel.history.at.y; }, form::count(), "Row, from the top.")
      .written("order", of(&PixelHistory::order), form::text(), "In which the technique takes the fragments.")
      .written("has_samples", of(&PixelHistory::has_samples), form::boolean(),
               "Positions are samples with values of their own, and not bits of a mask.")
      .written(
          "color", [](const Pixel& pixel) { return glm::vec4(pixel.picture, pixel.history.pixel.a); },
          form::vector<glm::vec4>(), "Of the technique: linear RGB, and the part of the pixel that geometry covers.")
      .written(
          "stored", [](const Pixel& pixel) { return glm::vec3(pixel.history.pixel); }, form::vector<glm::vec3>(),
          "The same colour as the frame's target stores it. Colours of steps, estimates, terms and surfaces are of "
          "this kind.")
      .written("reference", &Pixel::reference, form::vector<glm::vec3>(), "Of the reference, linear RGB.")
      .written("error", &Pixel::error, form::amount(), "Root mean square over R, G and B.")
      .written("visibility_error", &Pixel::visibility_error, form::amount(),
               "The part in visibility, where surfaces vary.")
      .written("positions", of(&PixelHistory::positions), form::list(form::vector<glm::vec2>()),
               "Places of the mask positions or samples in the pixel, 0..1 from its upper left corner.")
      .written("owners", of(&PixelHistory::owners), form::list(fragment_form()),
               "Who owns each position in the end; empty: the technique has no owners.")
      .written("fragments", named_fragments, form::list(named_form()),
               "Every triangle that touches the pixel, in the technique's order.")
      .written("steps", of(&PixelHistory::steps), form::list(step_form()), "What the technique did.")
      .written("estimates", of(&PixelHistory::estimates), estimates_form(),
               "beam: the estimates of the pixel's colour.")
      .written("terms", of(&PixelHistory::terms), form::list(term_form()),
               "Weights and colours whose sum of products, plus \"rest\", is the stored colour.")
      .written(
          "rest", [](const Pixel& pixel) { return pixel.history.rest(); }, form::vector<glm::dvec3>(),
          "What formats and limits have changed.")
      .written("surfaces", &Pixel::surfaces, form::list(surface_form()), "Weights beside those of the reference.")
      .written("transfers", first_transfers, form::list(transfer_form()),
               "Area that went to a wrong surface; the 1000 with the most effect.")
      .written(
          "all_transfers", [](const Pixel& pixel) { return pixel.transfers.size(); }, form::count(),
          "Their number, with those that are left out.")
      .written("causes", causes_of, form::as_it_is(form::by_name(form::number()).schema),
               "The error, or where surfaces vary its part in visibility, by cause.")
      .added("cause_shares", form::text().schema, "The causes in words. Only in files that `compare` writes.")
      .added("svg", form::text().schema, "The pixel as a picture. Only in files that `compare` writes.")
      .added("text", form::text().schema, "The history as text. Only in files that `compare` writes.");
}

}  // namespace

Json to_json(const PixelInspection& inspection) { return inspection_form().write(inspection); }

Json inspections_schema() {
  const Json text = form::text().schema;
  const Form<Json> file =
      ObjectForm<Json>()
          .add({"beampipe_inspect", "The version of this format.", true, form::version(1).schema})
          .added("version", text, "Of the program. Only in what `inspect` prints.")
          .add({"trace", "The trace's file.", true, text})
          .added("frame", form::count().schema, "Index in the trace. Only in what `inspect` prints.")
          .add({"pixels", "The pixels.", true, {{"type", "array"}, {"items", inspection_form().schema}}});
  return schema_file(file.schema, "beampipe inspections, version 1");
}

}  // namespace beampipe

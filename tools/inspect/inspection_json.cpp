#include "tools/inspect/inspection_json.h"

#include <algorithm>
#include <span>

#include "tools/inspect/inspection_text.h"

namespace beampipe {
namespace {

Json fragment_index(std::uint32_t fragment) { return fragment == kNobody ? Json() : Json(fragment); }

template <class Vector>
Json numbers(const Vector& vector) {
  Json json = Json::array();
  for (int i = 0; i < vector.length(); ++i) json.push_back(vector[i]);
  return json;
}

Json to_json(const std::vector<PositionMove>& moves) {
  Json json = Json::array();
  for (const PositionMove& move : moves)
    json.push_back({{"fragment", fragment_index(move.fragment)}, {"positions", move.positions}});
  return json;
}

Json to_json(const HeldSurface& surface) {
  return {{"fragments", surface.fragments},
          {"positions", surface.positions},
          {"area", surface.area},
          {"color", numbers(surface.color)}};
}

const char* name_of(HistoryStep::Kind kind) {
  using enum HistoryStep::Kind;
  switch (kind) {
    case merged:
      return "merged";
    case settled:
      return "settled";
    case composed:
      break;
  }
  return "composed";
}

Json to_json(const HistoryStep& step) {
  Json json = {{"step", name_of(step.kind)}, {"after_fragment", fragment_index(step.after_fragment)}};
  json["before"] = Json::array();
  for (const HeldSurface& surface : step.before) json["before"].push_back(to_json(surface));
  if (step.after) json["after"] = to_json(*step.after);
  return json;
}

Json to_json(const HistoryFragment& fragment, const std::string& draw) {
  std::string mask;
  for (const bool covered : fragment.mask) mask += covered ? '1' : '0';
  Json json = {{"triangle", fragment.triangle}, {"draw", fragment.draw}, {"draw_name", draw}};
  json["corners"] = Json::array();
  for (const glm::dvec2& corner : fragment.corners) json["corners"].push_back(numbers(corner));
  json["area"] = fragment.area;
  json["depth"] = Json::array({fragment.nearest, fragment.farthest});
  json["front"] = fragment.is_front;
  json["mask"] = mask;
  json["fate"] = fate_text(fragment.fate);
  json["taken"] = to_json(fragment.taken);
  json["lost"] = to_json(fragment.lost);
  return json;
}

}  // namespace

Json to_json(const PixelInspection& inspection) {
  const PixelHistory& history = inspection.history;
  Json json = {{"technique", inspection.technique},
               {"frame", inspection.frame},
               {"x", history.at.x},
               {"y", history.at.y},
               {"order", history.order},
               {"has_samples", history.has_samples},
               {"color", numbers(history.pixel)},
               {"reference", numbers(inspection.reference)},
               {"error", inspection.error}};
  if (inspection.visibility_error) json["visibility_error"] = *inspection.visibility_error;
  json["positions"] = Json::array();
  for (const glm::vec2& position : history.positions) json["positions"].push_back(numbers(position));
  json["owners"] = Json::array();
  for (const std::uint32_t owner : history.owners) json["owners"].push_back(fragment_index(owner));
  json["fragments"] = Json::array();
  for (std::size_t i = 0; i < history.fragments.size(); ++i)
    json["fragments"].push_back(to_json(history.fragments[i], inspection.draw_names[i]));
  json["steps"] = Json::array();
  for (const HistoryStep& step : history.steps) json["steps"].push_back(to_json(step));
  if (history.estimates)
    json["estimates"] = {{"analytic", numbers(history.estimates->analytic)},
                         {"counted", numbers(history.estimates->counted)},
                         {"result", numbers(history.estimates->result)}};
  json["terms"] = Json::array();
  for (const HistoryTerm& term : history.terms)
    json["terms"].push_back(
        {{"fragment", fragment_index(term.fragment)}, {"weight", term.weight}, {"color", numbers(term.color)}});
  json["rest"] = numbers(history.rest());
  json["surfaces"] = Json::array();
  for (const InspectedSurface& surface : inspection.surfaces)
    json["surfaces"].push_back({{"fragment", fragment_index(surface.fragment)},
                                {"weight", surface.weight},
                                {"reference_weight", surface.truth},
                                {"color", numbers(surface.color)}});
  constexpr std::size_t kMost = 1000;  // there are as many as losers times gainers
  json["transfers"] = Json::array();
  for (const AreaTransfer& each : std::span(inspection.transfers).first(std::min(kMost, inspection.transfers.size())))
    json["transfers"].push_back({{"from_surface", each.from},
                                 {"to_surface", each.to},
                                 {"area", each.area},
                                 {"cause", kErrorCauses[each.cause]}});
  json["all_transfers"] = inspection.transfers.size();
  json["causes"] = Json::object();
  for (std::size_t cause = 0; cause < inspection.causes.size(); ++cause)
    json["causes"][kErrorCauses[cause]] = inspection.causes[cause];
  return json;
}

}  // namespace beampipe

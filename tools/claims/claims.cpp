#include "tools/claims/claims.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tools/claims/our_figures.h"
#include "tools/claims/published_figures.h"

namespace beampipe {
namespace {

constexpr std::string_view kImplementation = "{implementation}";

// The name of "some/where/fence.json" is "fence".
std::string scene_of(const Report& report) { return std::filesystem::path(report.trace).stem().string(); }

Claim make_claim(const PublishedFigure& figure, std::optional<double> ours, const std::string& implementation) {
  std::string name = figure.name;
  if (const auto at = name.find(kImplementation); at != name.npos)
    name.replace(at, kImplementation.size(), implementation);
  return {name, figure.unit, figure.low, figure.high, ours, figure.source, figure.command, figure.remark};
}

std::string number(double value, int digits = 4) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace

std::optional<double> Claim::difference() const {
  if (!ours) return {};
  return *ours - std::clamp(*ours, published_low, published_high);
}

std::vector<Claim> all_claims(const Report& report) {
  const std::vector<PublishedFigure> figures = published_figures();
  const std::vector<Formula> formulas = our_formulas();
  expect_formulas_match(figures, formulas);
  const auto ours = [&](const PublishedFigure& figure, const Implementation& implementation) -> std::optional<double> {
    if (figure.formula.empty() || (!figure.scene.empty() && figure.scene != scene_of(report))) return {};
    const auto formula =
        std::find_if(formulas.begin(), formulas.end(), [&](const Formula& each) { return each.id == figure.formula; });
    return formula->ours({report, implementation});
  };
  const std::vector<Implementation> implementations =
      report.hardware.implementations.empty() ? titan_v().implementations : report.hardware.implementations;
  std::vector<Claim> claims;
  for (const PublishedFigure& figure : figures) {
    const bool for_each = figure.name.find(kImplementation) != figure.name.npos;
    for (std::size_t i = 0; i < (for_each ? implementations.size() : 1); ++i)
      claims.push_back(make_claim(figure, ours(figure, implementations[i]), implementations[i].name));
  }
  return claims;
}

std::vector<Claim> answered_claims(const Report& report) {
  std::vector<Claim> claims = all_claims(report);
  std::erase_if(claims, [](const Claim& claim) { return !claim.ours; });
  return claims;
}

Json to_json(const Claim& claim) {
  Json json = {{"name", claim.name}, {"unit", claim.unit}, {"published_low", claim.published_low}};
  const auto or_null = [](std::optional<double> value) {
    return value && std::isfinite(*value) ? Json(*value) : Json();
  };
  json["published_high"] = or_null(claim.published_high);  // null: or more
  json["ours"] = or_null(claim.ours);
  json["difference"] = or_null(claim.difference());
  json["source"] = claim.source;
  json["command"] = claim.command;
  json["beside"] = claim.beside;
  return json;
}

std::string claims_text(const std::vector<Claim>& claims) {
  std::string text =
      "| claim | unit | published | ours | difference | what ours is | source | command "
      "|\n|---|---|---|---|---|---|---|---|\n";
  for (const Claim& claim : claims) {
    std::string published = number(claim.published_low, 6);
    if (!std::isfinite(claim.published_high))
      published += " or more";
    else if (claim.published_high != claim.published_low)
      published += " to " + number(claim.published_high, 6);
    text += "| " + claim.name + " | " + claim.unit + " | " + published + " | " +
            (claim.ours ? number(*claim.ours) : "") + " | " + (claim.ours ? number(*claim.difference()) : "") + " | " +
            claim.beside + " | " + claim.source + " | `" + claim.command + "` |\n";
  }
  return text;
}

}  // namespace beampipe

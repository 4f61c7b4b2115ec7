#include "tools/claims/claims.h"

#include <algorithm>
#include <cmath>

#include "tools/claims/our_figures.h"
#include "tools/claims/published_figures.h"

namespace beampipe {
namespace {

// Kinds of claims in report.json.
constexpr const char *kRendered = "rendered", *kByDefinition = "true by definition";

constexpr std::string_view kImplementation = "{implementation}";

// The digest of the trace's content; empty if the report does not have it.
std::string trace_of(const Report& report) {
  return report.made_by.is_object() ? report.made_by.value("trace", std::string()) : std::string();
}

Claim make_claim(const PublishedFigure& figure, std::optional<double> ours, const std::string& implementation) {
  std::string name = figure.name;
  if (const auto at = name.find(kImplementation); at != name.npos)
    name.replace(at, kImplementation.size(), implementation);
  return {.name = name,
          .unit = figure.unit,
          .published_low = figure.low,
          .published_high = figure.high,
          .ours = ours,
          .source = figure.source,
          .command = figure.command,
          .beside = figure.remark,
          .by_definition = figure.by_definition,
          .reason = figure.reason,
          .numerator = figure.numerator,
          .denominator = figure.denominator};
}

}  // namespace

std::optional<double> Claim::per_cent() const {
  if (!ours) return {};
  const double nearest = std::clamp(*ours, published_low, published_high), difference = *ours - nearest;
  return difference == 0 ? 0 : 100 * difference / std::abs(nearest);
}

std::optional<bool> Claim::holds() const {
  return ours ? std::optional<bool>(std::abs(*per_cent()) <= kHoldsWithin) : std::nullopt;
}

std::vector<Claim> all_claims(const Report& report) {
  const std::vector<PublishedFigure> figures = published_figures();
  const std::vector<Formula> formulas = our_formulas();
  expect_formulas_match(figures, formulas);
  const auto ours = [&](const PublishedFigure& figure, const Implementation& implementation) -> std::optional<double> {
    if (figure.formula.empty() || (!figure.by_definition && figure.trace != trace_of(report))) return {};
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
  find_quotients(claims);
  return claims;
}

// A quotient may be made of others, which come before it.
void find_quotients(std::vector<Claim>& claims) {
  const auto ours = [&](const std::string& name) -> std::optional<double> {
    for (const Claim& claim : claims)
      if (claim.name == name) return claim.ours;
    return {};
  };
  for (Claim& claim : claims) {
    if (claim.ours || claim.numerator.empty()) continue;
    const std::optional<double> numerator = ours(claim.numerator), denominator = ours(claim.denominator);
    if (numerator && denominator && *denominator != 0) claim.ours = *numerator / *denominator;
  }
}

std::vector<Claim> answered_claims(const Report& report) {
  std::vector<Claim> claims = all_claims(report);
  std::erase_if(claims, [](const Claim& claim) { return !claim.ours; });
  return claims;
}

Form<Claim> claim_form() {
  const Form<double> or_null = {{{"type", Json::array({"number", "null"})}}, {}, [](const double& value) {
                                  return std::isfinite(value) ? Json(value) : Json();
                                }};
  const Form<std::optional<bool>> true_or_null = {
      {{"type", Json::array({"boolean", "null"})}}, {}, [](const std::optional<bool>& value) {
        return value ? Json(*value) : Json();
      }};
  const auto number = [](const std::optional<double>& value) { return value.value_or(NAN); };
  return ObjectForm<Claim>()
      .written("name", &Claim::name, form::text(), "What a publication says.")
      .written("unit", &Claim::unit, form::text(), "Of the numbers; empty: a ratio or a count.")
      .written("published_low", &Claim::published_low, form::number(),
               "The published number, or the lower end of the range.")
      .written("published_high", &Claim::published_high, or_null, "The upper end; null: or more.")
      .written(
          "ours", [number](const Claim& claim) { return number(claim.ours); }, or_null, "Our number.")
      .written(
          "per_cent", [number](const Claim& claim) { return number(claim.per_cent()); }, or_null,
          "How far ours lies from the nearer end of the published range, of which this is a percentage; 0 within it.")
      .written("holds", &Claim::holds, true_or_null, "Is that at most 10 per cent either way?")
      .written(
          "kind", [](const Claim& claim) { return claim.by_definition ? kByDefinition : kRendered; },
          form::one_of({kRendered, kByDefinition}), "How our number was found.")
      .written("source", &Claim::source, form::text(), "The place in the publication.")
      .written("command", &Claim::command, form::text(), "What finds our number.")
      .written("beside", &Claim::beside, form::text(), "What our number is, if it is not the same quantity.")
      .written("reason", &Claim::reason, form::text(), "Why our number differs; empty: it does not, or nobody knows.");
}

}  // namespace beampipe

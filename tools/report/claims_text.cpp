#include "tools/report/claims_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "pipeline/wrapped_text.h"
#include "tools/report/report_text.h"

namespace beampipe {
namespace {

std::string number(double value, int digits = 4) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string published_text(const Claim& claim) {
  const std::string low = number(claim.published_low, 6);
  if (!std::isfinite(claim.published_high)) return low + " or more";
  return claim.published_high == claim.published_low ? low : low + " to " + number(claim.published_high, 6);
}

// Adds a note, unless there is none or it is there already. Returns its mark: "(1)".
std::string mark_of(const std::string& note, std::vector<std::string>& notes) {
  if (note.empty()) return "";
  const auto at = std::find(notes.begin(), notes.end(), note);
  const auto index = at - notes.begin();
  if (at == notes.end()) notes.push_back(note);
  return "(" + std::to_string(index + 1) + ")";
}

std::string table_of(const std::vector<Claim>& claims) {
  std::vector<std::vector<std::string>> rows = {
      {"  claim", "published", "ours", "per cent", "holds", "unit", "notes", "source"}};
  std::vector<std::string> notes;
  for (const Claim& claim : claims) {
    std::string marks = mark_of(claim.beside, notes);
    if (claim.ours && *claim.per_cent() != 0)
      if (const std::string mark = mark_of(claim.reason.empty() ? "" : "why: " + claim.reason, notes); !mark.empty())
        marks += (marks.empty() ? "" : " ") + mark;
    rows.push_back({"  " + claim.name, published_text(claim), claim.ours ? number(*claim.ours) : "",
                    claim.ours ? number(*claim.per_cent(), 3) : "", claim.ours ? (*claim.holds() ? "yes" : "no") : "",
                    claim.unit, marks, claim.source});
  }
  std::string text = align_columns(rows, {0, 4, 5, 6, 7});
  for (std::size_t i = 0; i < notes.size(); ++i) text += "  (" + std::to_string(i + 1) + ") " + notes[i] + "\n";
  return text;
}

}  // namespace

std::string claims_text(const std::vector<Claim>& claims) {
  std::vector<Claim> rendered, by_definition;
  for (const Claim& claim : claims) (claim.by_definition ? by_definition : rendered).push_back(claim);
  const auto numbers = std::ranges::count_if(claims, [](const Claim& each) { return each.ours.has_value(); });
  const auto holding = std::ranges::count_if(claims, [](const Claim& each) { return each.holds().value_or(false); });
  std::ostringstream text;
  while (!rendered.empty()) {
    const std::string command = rendered.front().command;
    const auto rest = std::stable_partition(rendered.begin(), rendered.end(),
                                            [&](const Claim& claim) { return claim.command == command; });
    text << command << '\n' << table_of({rendered.begin(), rest}) << '\n';
    rendered.erase(rendered.begin(), rest);
  }
  text << "True by definition: formats and constants, read from the program\n"
       << table_of(by_definition) << '\n'
       << "Of " << numbers << " claims with a number of ours, " << holding << " hold within " << kHoldsWithin
       << " per cent.\n";
  return text.str();
}

std::string statements_text(const std::vector<Statement>& statements) {
  std::string text, publication;
  for (const Statement& statement : statements) {
    if (statement.publication != publication)
      text += (publication.empty() ? "" : "\n") + wrapped(statement.publication, 100) + "\n";
    publication = statement.publication;
    text += wrapped("  " + statement.source + ": " + statement.text, 100, 4) + "\n" +
            wrapped("    " + statement.answer, 100, 6) + "\n";
  }
  return text;
}

}  // namespace beampipe

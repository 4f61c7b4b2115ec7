#include "tools/claims/published_figures.h"

#include <algorithm>
#include <limits>

#include "tools/claims/published_text.h"
#include "traces/files/json_cursor.h"

namespace beampipe {
namespace {

// The text of a field of the claim or, if the claim does not have it, of its group; empty if neither has it.
std::string text_of(const JsonCursor& claim, const JsonCursor& group, std::string_view key) {
  if (const auto own = claim.find(key)) return own->string();
  if (const auto shared = group.find(key)) return shared->string();
  return "";
}

void read_numbers(const JsonCursor& claim, PublishedFigure& figure) {
  if (const auto one = claim.find("published")) {
    figure.low = figure.high = one->number();
    return;
  }
  figure.low = claim["published_low"].number();
  const auto high = claim.find("published_high");
  figure.high = high ? high->number() : std::numeric_limits<double>::infinity();
}

PublishedFigure read_claim(const JsonCursor& claim, const JsonCursor& group) {
  claim.expect_keys({"name", "published", "published_low", "published_high", "derived_from", "unit", "source", "remark",
                     "reason", "formula", "quotient_of", "no_number"});
  PublishedFigure figure;
  figure.name = claim["name"].string();
  read_numbers(claim, figure);
  figure.unit = text_of(claim, group, "unit");
  figure.source = text_of(claim, group, "source");
  figure.remark = text_of(claim, group, "remark");
  figure.reason = text_of(claim, group, "reason");
  figure.command = group["command"].string();
  if (const auto reason = claim.find("no_number")) {
    figure.remark = "none: " + reason->string();
    figure.reason = "";
  } else if (const auto quotient = claim.find("quotient_of")) {
    const auto names = quotient->elements();
    if (names.size() != 2) quotient->fail("the names of two claims", std::to_string(names.size()));
    figure.numerator = names[0].string(), figure.denominator = names[1].string();
  } else {
    figure.formula = claim["formula"].string();
  }
  if (claim.has("formula") + claim.has("quotient_of") + claim.has("no_number") > 1)
    claim.fail("one of \"formula\", \"quotient_of\" and \"no_number\"", "several");
  return figure;
}

// Calls read(publication) with what the file's text says.
template <class Read>
void read_publication(const std::string& text, const std::string& file, Read&& read) {
  const Json json = parse_json_text(text, file);
  const JsonCursor publication(json, file);
  publication.expect_keys({"beampipe_claims", "publication", "groups", "statements"});
  publication["beampipe_claims"].integer(1, 1);
  read(publication);
}

// What all files have that are built in, in their order.
template <class Item>
std::vector<Item> of_all_files(std::vector<Item> (*parse)(const std::string& text, const std::string& file)) {
  std::vector<Item> all;
  for (const PublishedText& publication : kPublishedTexts)
    for (Item& item : parse(publication.text, publication.file)) all.push_back(std::move(item));
  return all;
}

}  // namespace

std::vector<PublishedFigure> parse_published_figures(const std::string& text, const std::string& file) {
  std::vector<PublishedFigure> figures;
  read_publication(text, file, [&](const JsonCursor& publication) {
    for (const JsonCursor& group : publication["groups"].elements()) {
      group.expect_keys({"topic", "source", "trace", "unit", "command", "remark", "reason", "claims"});
      for (const JsonCursor& claim : group["claims"].elements()) {
        figures.push_back(read_claim(claim, group));
        figures.back().topic = group["topic"].choice({"design", "traffic", "time", "quality", "passes"});
        figures.back().by_definition = figures.back().topic == 0;
        if (!figures.back().by_definition) figures.back().trace = group["trace"].string();
      }
    }
  });
  return figures;
}

std::vector<Statement> parse_published_statements(const std::string& text, const std::string& file) {
  std::vector<Statement> statements;
  read_publication(text, file, [&](const JsonCursor& publication) {
    for (const JsonCursor& statement : publication["statements"].elements()) {
      statement.expect_keys({"source", "text", "answer"});
      const std::string answer = statement["answer"].string();
      if (!answer.starts_with("works: ") && !answer.starts_with("partly: ") && !answer.starts_with("not here: "))
        statement["answer"].fail("works: ..., partly: ... or not here: ...", answer);
      statements.push_back(
          {publication["publication"].string(), statement["source"].string(), statement["text"].string(), answer});
    }
  });
  return statements;
}

std::vector<Statement> published_statements() { return of_all_files(parse_published_statements); }

std::vector<PublishedFigure> published_figures() {
  std::vector<PublishedFigure> all = of_all_files(parse_published_figures);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.topic < b.topic; });
  return all;
}

}  // namespace beampipe

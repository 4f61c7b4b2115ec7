// What publications state, in numbers and in words. These are data: tools/claims/published/*.json, one file per
// publication, built into the program.
//
// A file holds groups of claims with the same topic and command. A group also has the unit, the source, the remark and
// the reason of those of its claims that do not have their own. A claim names the formula of our number
// (tools/claims/our_figures.h), or two other claims whose numbers are divided ("quotient_of"), or, as "no_number", the
// reason why there is none. Claims of the topic "design" are about formats and constants: our numbers are read from the
// program and need no rendering. A group of any other topic has the digest of its "trace", the one that its command
// makes. A test makes these traces and compares the digests. "statements" are what the publication says in words.
#pragma once

#include <string>
#include <vector>

namespace beampipe {

struct PublishedFigure {
  std::string name;          // with "{implementation}" in it: one claim for each implementation of the hardware
  std::string unit;          // empty: a ratio or a count
  double low = 0, high = 0;  // the same if one number is published; high is infinity for "or more"
  std::string source;        // the place in the publication
  std::string command;       // what to run to get our number
  std::string remark;        // what our number is if it is not the same quantity, or why there is none
  std::string reason;        // why our number differs; empty: it does not, or nobody knows
  std::string trace;         // the digest of the trace that the command makes, which alone has our number; empty: none
  std::string formula;       // of our number; empty: it is a quotient, or there is none
  std::string numerator, denominator;  // the names of the claims whose quotient is our number; empty: it is not one
  bool by_definition = false;          // our number is a format or a constant of the program
  std::size_t topic = 0;               // claims are listed topic by topic, and within a topic in the order of the files
};

// All that are built in, in the order in which they are listed.
std::vector<PublishedFigure> published_figures();

// What a publication says in words, and whether it can be had here.
struct Statement {
  std::string publication, source;  // the place in the publication
  std::string text;
  std::string answer;  // begins with "works: ", "partly: " or "not here: ", and says with what, or why not
};

std::vector<Statement> published_statements();

// Those of one file. Throws TraceError, one line that names the file and the place in it.
std::vector<PublishedFigure> parse_published_figures(const std::string& text, const std::string& file);
std::vector<Statement> parse_published_statements(const std::string& text, const std::string& file);

}  // namespace beampipe

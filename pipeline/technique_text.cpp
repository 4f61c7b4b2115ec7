// What --help and docs/techniques.md say of the techniques.
#include <algorithm>
#include <sstream>

#include "pipeline/technique_table.h"
#include "pipeline/wrapped_text.h"

namespace beampipe {
namespace {

using Form = SpecOption::Form;

// Sample count used where a table has one column.
constexpr const char* kExampleSamples = "8";

constexpr std::size_t kHelpWidth = 100;  // characters of a line

SpecOptions options_of(const TechniqueKind& kind) {
  SpecOptions options;
  kind.make([&](const SpecOptions& all) { options = all; });
  for (SpecOption& option : options) option.set = nullptr;  // they point to locals that no longer exist
  return options;
}

bool has_samples(const SpecOptions& options) { return !options.empty() && options.front().form == Form::samples; }

// Returns the framebuffer's bytes per pixel with options[i] set to `word` and all other options at their defaults.
std::uint32_t bytes_with(const TechniqueKind& kind, std::size_t i, const std::string& word) {
  const auto set = [&](const SpecOptions& options) {
    if (has_samples(options)) options.front().set(kExampleSamples);
    options[i].set(word);
  };
  return kind.make(set).framebuffer_bytes_per_pixel();
}

// Returns the bytes for each word of options[i], or nothing if all are equal: "14, 18, 26, 42".
std::string bytes_by_word(const TechniqueKind& kind, std::size_t i, const std::vector<std::string>& words) {
  std::vector<std::uint32_t> bytes;
  for (const std::string& word : words) bytes.push_back(bytes_with(kind, i, word));
  if (std::all_of(bytes.begin(), bytes.end(), [&](std::uint32_t each) { return each == bytes.front(); })) return "";
  std::string text;
  for (const std::uint32_t each : bytes) text += (text.empty() ? "" : ", ") + std::to_string(each);
  return text;
}

std::string bytes_of(const TechniqueKind& kind) {
  if (has_samples(options_of(kind)))
    return std::to_string(bytes_with(kind, 0, kExampleSamples)) + " for N = " + kExampleSamples;
  return std::to_string(kind.make([](const SpecOptions&) {}).framebuffer_bytes_per_pixel());
}

std::string help_of(const SpecOption& option) {
  if (option.form == Form::samples) return option.help + ": " + option.expected;
  return option.help + (option.fallback.empty() ? "" : " (" + option.fallback + ")");
}

// A "|" would end the cell of a Markdown table.
std::string as_code(const std::string& text) {
  std::string code = "`";
  for (const char c : text) {
    if (c == '|') code += '\\';
    code += c;
  }
  code += '`';
  return code;
}

}  // namespace

std::string title_of(const TechniqueKind& kind) {
  const std::vector<TechniqueKind>& kinds = technique_kinds();
  const auto first = std::ranges::find(kinds, kind.name, &TechniqueKind::name);
  if (first->variant.word != kind.variant.word) return kind.name + ':' + kind.variant.key + '=' + kind.variant.word;
  return kind.name + (has_samples(options_of(kind)) ? ":N" : "");
}

std::string technique_help() {
  std::ostringstream help;
  help << "  NAME, or NAME:OPTION,OPTION,... with options in any order, but N first; defaults in parentheses\n";
  for (const TechniqueKind& kind : technique_kinds()) {
    help << "\n  " << title_of(kind) << '\n'
         << wrapped("    " + kind.description + " (" + kind.source + ")", kHelpWidth, 4) << '\n';
    const SpecOptions options = options_of(kind);
    std::size_t width = 0;
    for (const SpecOption& option : options) width = std::max(width, option.usage.size());
    for (const SpecOption& option : options) {
      const std::string usage = "      " + option.usage + std::string(width - option.usage.size() + 2, ' ');
      help << wrapped(usage + help_of(option), kHelpWidth, usage.size()) << '\n';
    }
  }
  int taps = 0;
  const SpecOption filter = filter_option(taps);
  const std::string usage = "      " + filter.usage + "  ";
  help << "\n  all techniques\n" << wrapped(usage + help_of(filter), kHelpWidth, usage.size()) << '\n';
  return help.str();
}

std::string technique_tables() {
  std::ostringstream tables, options;
  tables << "| spec | technique | source | bytes per pixel |\n|---|---|---|---|\n";
  options << "| technique | option | what it is | default | bytes per pixel, by value |\n|---|---|---|---|---|\n";
  for (const TechniqueKind& kind : technique_kinds()) {
    const std::string title = as_code(title_of(kind));
    tables << "| " << title << " | " << kind.description << " | " << kind.source << " | " << bytes_of(kind) << " |\n";
    const SpecOptions all = options_of(kind);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const SpecOption& option = all[i];
      options << "| " << title << " | " << as_code(option.usage) << " | " << option.help
              << (option.form == Form::samples ? ": " + option.expected : "") << " | "
              << (option.fallback.empty() ? "" : as_code(option.fallback)) << " | "
              << (option.words.empty() ? "" : bytes_by_word(kind, i, option.words)) << " |\n";
    }
  }
  int taps = 0;
  const SpecOption filter = filter_option(taps);
  options << "| all | " << as_code(filter.usage) << " | " << filter.help << " | " << as_code(filter.fallback)
          << " |  |\n";
  return tables.str() + '\n' + options.str();
}

}  // namespace beampipe

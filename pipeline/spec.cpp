#include "pipeline/spec.h"

#include <algorithm>
#include <charconv>

#include "pipeline/technique.h"
#include "traces/closest_name.h"

namespace beampipe {
namespace {

std::string text_of(float number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
  std::string text;
  for (const std::string& word : words) text.append(text.empty() ? "" : separator).append(word);
  return text;
}

const SpecOption* find_option(const SpecOptions& options, std::string_view key) {
  const auto found = std::find_if(options.begin(), options.end(), [&](const SpecOption& option) {
    return option.form != SpecOption::Form::samples && option.key == key;
  });
  return found == options.end() ? nullptr : &*found;
}

void set_item(const Spec& spec, const Spec::Item& item, const std::string& title, const SpecOptions& options) {
  const SpecOption* const option = find_option(options, item.key);
  if (!option) {
    std::vector<std::string> keys;
    for (const SpecOption& each : options)
      if (each.form != SpecOption::Form::samples) keys.push_back(each.key);
    spec.fail(title + " has no option '" + std::string(item.key) + "'" + did_you_mean(item.key, keys) + "; it has " +
              list_of(keys, "and"));
  }
  const bool is_flag = option->form == SpecOption::Form::flag;
  if (is_flag && item.has_value) spec.fail(option->key + " must be without a value");
  if (!option->set(item.value)) spec.fail(option->key + " must be " + option->expected);
}

}  // namespace

Spec::Spec(std::string_view text) : text_(text), name_(text.substr(0, text.find(':'))) {
  if (name_.size() == text.size()) return;
  std::string_view rest = text.substr(name_.size() + 1);
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    Item item{.text = rest.substr(0, comma), .key = {}, .value = {}};
    const std::size_t equals = item.text.find('=');
    item.key = item.text.substr(0, equals);
    item.has_value = equals != item.text.npos;
    if (item.has_value) item.value = item.text.substr(equals + 1);
    for (const Item& other : items_)
      if (other.key == item.key) fail(std::string("'").append(item.key).append("' is there twice"));
    items_.push_back(item);
    more = comma != rest.npos;
    if (more) rest.remove_prefix(comma + 1);
  }
}

bool Spec::has(std::string_view key, std::string_view value) const {
  return std::any_of(items_.begin(), items_.end(),
                     [&](const Item& item) { return item.has_value && item.key == key && item.value == value; });
}

void Spec::fail(const std::string& what) const {
  std::string message = "technique '" + std::string(text_) + "': " + what;
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < 0x20; }, '?');
  throw SpecError(message);
}

SpecOption choice_of_words(std::string key, std::vector<std::string> words, std::string fallback, std::string help,
                           std::function<void(std::size_t)> set_word) {
  SpecOption option{.form = SpecOption::Form::value,
                    .key = key,
                    .usage = key + '=' + joined(words, "|"),
                    .words = words,
                    .expected = list_of(words),
                    .fallback = std::move(fallback),
                    .help = std::move(help),
                    .set = {}};
  option.set = [words = std::move(words), set_word = std::move(set_word)](std::string_view value) {
    const auto found = std::find(words.begin(), words.end(), value);
    if (found == words.end()) return false;
    set_word(static_cast<std::size_t>(found - words.begin()));
    return true;
  };
  return option;
}

SpecOption samples(int& variable, int most, std::string help) {
  std::vector<std::pair<std::string, int>> words;
  for (int count = 1; count <= most; count *= 2) words.emplace_back(std::to_string(count), count);
  SpecOption option = choice("N", variable, words, std::move(help));
  option.form = SpecOption::Form::samples;
  option.usage = option.key;
  option.fallback.clear();
  return option;
}

SpecOption optional_samples(int& variable, int most, std::string help) {
  SpecOption option = samples(variable, most, std::move(help));
  option.fallback = std::to_string(variable);
  return option;
}

SpecOption flag(std::string key, bool& variable, std::string help) {
  const auto set = [&variable](std::string_view) { return variable = true; };
  return {.form = SpecOption::Form::flag,
          .key = key,
          .usage = key,
          .words = {},
          .expected = "",
          .fallback = "",
          .help = std::move(help),
          .set = set};
}

SpecOption number(std::string key, float& variable, float low, float high, std::string help) {
  const auto in_range = [low, high](float value) { return low <= value && value <= high; };
  return {.form = SpecOption::Form::value,
          .key = key,
          .usage = key + '=' + text_of(low) + ".." + text_of(high),
          .words = {},
          .expected = "a number from " + text_of(low) + " to " + text_of(high),
          .fallback = in_range(variable) ? text_of(variable) : "",
          .help = std::move(help),
          .set = [&variable, in_range](std::string_view text) {
            float value{};
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error != std::errc{} || end != text.data() + text.size() || !in_range(value)) return false;
            variable = value;
            return true;
          }};
}

SpecOption beside(std::string needs, std::function<bool()> applies, SpecOption option) {
  option.needs = std::move(needs);
  option.applies = std::move(applies);
  return option;
}

void set_options(const Spec& spec, const std::string& title, const SpecOptions& options) {
  auto item = spec.items().begin();
  const auto end = spec.items().end();
  if (!options.empty() && options.front().form == SpecOption::Form::samples) {
    const SpecOption& count = options.front();
    const bool is_set = item != end && count.set(item->text);
    const bool may_be_left_out = !count.fallback.empty() && (item == end || find_option(options, item->key));
    if (!is_set && !may_be_left_out) spec.fail("N of " + title + " must be " + count.expected);
    if (is_set) ++item;
  }
  for (; item != end; ++item) set_item(spec, *item, title, options);
  for (const Spec::Item& each : spec.items()) {
    const SpecOption* const option = find_option(options, each.key);
    if (option && option->applies && !option->applies()) spec.fail(option->key + " needs " + option->needs);
  }
}

std::string list_of(const std::vector<std::string>& words, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0 && i + 1 < words.size()) text += ", ";
    if (i > 0 && i + 1 == words.size()) text.append(" ").append(last).append(" ");
    text += words[i];
  }
  return text;
}

}  // namespace beampipe

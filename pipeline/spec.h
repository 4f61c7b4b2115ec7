// The grammar of specs, "name[:item[,item...]]", and the options that their items set. An item is "N" (the number of
// samples, which comes first), "flag" or "key=value".
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace beampipe {

// A spec, split into its parts. They are views of the text, which must live as long.
class Spec {
 public:
  struct Item {
    std::string_view text, key, value;  // without "=" the key is the whole text
    bool has_value = false;
  };

  // Throws SpecError where a key occurs twice.
  explicit Spec(std::string_view text);

  std::string_view name() const { return name_; }
  const std::vector<Item>& items() const { return items_; }
  bool has(std::string_view key, std::string_view value) const;

  // Throws SpecError "technique 'TEXT': WHAT".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string_view text_, name_;
  std::vector<Item> items_;
};

// One option of a technique, made by the functions below. It is bound to a variable, whose value at that time is the
// option's default.
struct SpecOption {
  enum class Form { samples, flag, value } form;
  std::string key;                 // "bits"; of the number of samples "N"
  std::string usage;               // "bits=32|64|128|256", "prepass", "blend=0.001..1", "N"
  std::vector<std::string> words;  // all values; none for a number in a range and for a flag
  std::string expected;            // "32, 64, 128 or 256", "a number from 0.001 to 1"; empty for a flag
  std::string fallback;            // the default, as a value; empty where there is none
  std::string help;
  std::function<bool(std::string_view)> set;  // sets the variable, or returns false if the value is not a valid one
  // Where the option means something only beside certain values of another one: the items that it may stand beside,
  // "order=near-first or order=stream", and whether it does, once all items are set.
  std::string needs = {};
  std::function<bool()> applies = {};
};
using SpecOptions = std::vector<SpecOption>;

// The number of samples: 1, 2, 4, ... `most`, a power of two. A spec must have it.
SpecOption samples(int& variable, int most, std::string help);

// The same, where a spec may leave it out. Then the variable keeps its value.
SpecOption optional_samples(int& variable, int most, std::string help);

// "key" alone sets the variable to true.
SpecOption flag(std::string key, bool& variable, std::string help);

// "key=number" with low <= number <= high. A variable that is out of this range says that the option has no default.
SpecOption number(std::string key, float& variable, float low, float high, std::string help);

// What `choice` makes of its words; `set_word` sets the variable to the value of words[i].
SpecOption choice_of_words(std::string key, std::vector<std::string> words, std::string fallback, std::string help,
                           std::function<void(std::size_t)> set_word);

// "key=word", with the value that each word stands for. One of them must be the variable's.
template <class Value>
SpecOption choice(std::string key, Value& variable, const std::vector<std::pair<std::string, Value>>& words,
                  std::string help) {
  std::vector<std::string> names;
  std::string fallback;
  for (const auto& [name, value] : words) {
    names.push_back(name);
    if (value == variable) fallback = name;
  }
  return choice_of_words(std::move(key), std::move(names), std::move(fallback), std::move(help),
                         [&variable, words](std::size_t i) { variable = words[i].second; });
}

// The option, with SpecOption::needs and applies.
SpecOption beside(std::string needs, std::function<bool()> applies, SpecOption option);

// Sets the options from the spec's items. Throws SpecError, which names the first item that is wrong and says what
// would have been right. `title` is the technique's name in messages.
void set_options(const Spec& spec, const std::string& title, const SpecOptions& options);

// "a", "a or b", "a, b or c"; with `last` in place of "or".
std::string list_of(const std::vector<std::string>& words, std::string_view last = "or");

}  // namespace beampipe

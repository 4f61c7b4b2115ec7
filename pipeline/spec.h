// Reading a technique's spec: "name[:item[,item...]]", an item being "value" or "key=value".
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace beampipe {

// Each function takes an item, if it is there; finish() complains about those that nothing took. All throw SpecError,
// which names the spec and says what was expected: `usage`.
class Spec {
 public:
  Spec(std::string_view text, std::string usage);

  const std::string& text() const { return text_; }

  // The first item: a power of two, 1..most. `fallback` when there are no items; 0: there must be one.
  int samples(int most, int fallback = 0);

  // "key" alone.
  bool flag(std::string_view key);

  // "key=number" with low <= number <= high; int and std::uint32_t: a whole one; float.
  template <class Number>
  Number number(std::string_view key, Number fallback, Number low, Number high);

  // "key=word", with what each word stands for; the first is the default.
  template <class Value>
  Value choice(std::string_view key, const std::vector<std::pair<std::string_view, Value>>& words) {
    const std::string* const word = take(key);
    if (!word) return words.front().second;
    for (const auto& [name, value] : words)
      if (*word == name) return value;
    fail();
  }

  void finish() const;
  [[noreturn]] void fail() const;

 private:
  const std::string* take(std::string_view key);  // what stands behind "key="

  struct Item {
    std::string key, value;
    bool has_value = false, taken = false;
  };
  std::string text_, usage_;
  std::vector<Item> items_;
};

// What stands before the colon.
std::string_view spec_name(std::string_view text);

}  // namespace beampipe

#include "pipeline/spec.h"

#include <bit>
#include <charconv>
#include <cstdint>

#include "pipeline/technique.h"

namespace beampipe {
namespace {

template <class Number>
bool parse(const std::string& text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::string_view spec_name(std::string_view text) { return text.substr(0, text.find(':')); }

Spec::Spec(std::string_view text, std::string usage) : text_(text), usage_(std::move(usage)) {
  const std::size_t name = spec_name(text).size();
  if (name == text.size()) return;
  std::string_view rest = text.substr(name + 1);
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(','), length = std::min(comma, rest.size());
    const std::string_view item = rest.substr(0, length);
    const std::size_t equals = item.find('=');
    Item& added = items_.emplace_back();
    added.key = item.substr(0, equals);
    added.has_value = equals != item.npos;
    if (added.has_value) added.value = item.substr(equals + 1);
    more = comma != rest.npos;
    if (more) rest.remove_prefix(comma + 1);
  }
}

int Spec::samples(int most, int fallback) {
  if (fallback > 0 && (items_.empty() || items_.front().has_value)) return fallback;
  int samples = 0;
  if (items_.empty() || items_.front().has_value || !parse(items_.front().key, samples)) fail();
  if (items_.front().key.starts_with('0')) fail();
  if (samples < 1 || samples > most || !std::has_single_bit(static_cast<unsigned>(samples))) fail();
  items_.front().taken = true;
  return samples;
}

bool Spec::flag(std::string_view key) {
  for (Item& item : items_) {
    if (item.taken || item.has_value || item.key != key) continue;
    return item.taken = true;
  }
  return false;
}

template <class Number>
Number Spec::number(std::string_view key, Number fallback, Number low, Number high) {
  const std::string* const text = take(key);
  if (!text) return fallback;
  Number value{};
  if (!parse(*text, value) || !(low <= value && value <= high)) fail();
  return value;
}

template int Spec::number(std::string_view, int, int, int);
template std::uint32_t Spec::number(std::string_view, std::uint32_t, std::uint32_t, std::uint32_t);
template float Spec::number(std::string_view, float, float, float);

const std::string* Spec::take(std::string_view key) {
  for (Item& item : items_) {
    if (item.taken || !item.has_value || item.key != key) continue;
    item.taken = true;
    return &item.value;
  }
  return nullptr;
}

void Spec::finish() const {
  for (const Item& item : items_)
    if (!item.taken) fail();
}

void Spec::fail() const { throw SpecError("technique '" + text_ + "': expected " + usage_); }

}  // namespace beampipe

// Numbers that count: a scalar formula that runs on them shows how many operations it takes per item.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "stages/cost/counters.h"

namespace beampipe {

// A value and the place where operations on it are counted. Constants have no tally; an operation is counted if one of
// its operands has one.
template <class Value>
struct Counted {
  Value value{};
  OperationCounts* tally = nullptr;

  Counted() = default;
  explicit Counted(Value v) : value(v) {}
  Counted(Value v, OperationCounts& counts) : value(v), tally(&counts) {}
};

template <class Value>
OperationCounts* tally_of(const Counted<Value>& x, const Counted<Value>& y) {
  return x.tally ? x.tally : y.tally;
}

template <class Value>
void count(OperationCounts* tally, std::uint64_t OperationCounts::*kind) {
  if (!tally) return;
  tally->*kind += 1;
  if constexpr (std::is_integral_v<Value> && sizeof(Value) == sizeof(std::uint64_t)) tally->wide += 1;
}

template <class Value>
Counted<Value> counted(OperationCounts* tally, std::uint64_t OperationCounts::*kind, Value value) {
  count<Value>(tally, kind);
  Counted<Value> result(value);
  result.tally = tally;
  return result;
}

#define BEAMPIPE_COUNTED_BINARY(op, kind)                                              \
  template <class Value>                                                               \
  Counted<Value> operator op(const Counted<Value>& x, const Counted<Value>& y) {       \
    return counted(tally_of(x, y), &OperationCounts::kind, Value(x.value op y.value)); \
  }
BEAMPIPE_COUNTED_BINARY(+, add)
BEAMPIPE_COUNTED_BINARY(-, add)
BEAMPIPE_COUNTED_BINARY(*, mul_add)
BEAMPIPE_COUNTED_BINARY(/, special)
BEAMPIPE_COUNTED_BINARY(&, bit)
BEAMPIPE_COUNTED_BINARY(|, bit)
BEAMPIPE_COUNTED_BINARY(^, bit)
BEAMPIPE_COUNTED_BINARY(%, special)
#undef BEAMPIPE_COUNTED_BINARY

template <class Value>
Counted<Value> operator>>(const Counted<Value>& x, int places) {
  return counted(x.tally, &OperationCounts::bit, Value(x.value >> places));
}

template <class Value>
Counted<Value> operator<<(const Counted<Value>& x, int places) {
  return counted(x.tally, &OperationCounts::bit, Value(x.value << places));
}

template <class Value>
Counted<Value> operator~(const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::bit, Value(~x.value));
}

#define BEAMPIPE_COUNTED_COMPARISON(op)                                \
  template <class Value>                                               \
  bool operator op(const Counted<Value>& x, const Counted<Value>& y) { \
    count<Value>(tally_of(x, y), &OperationCounts::add);               \
    return x.value op y.value;                                         \
  }
BEAMPIPE_COUNTED_COMPARISON(<)
BEAMPIPE_COUNTED_COMPARISON(<=)
BEAMPIPE_COUNTED_COMPARISON(>)
BEAMPIPE_COUNTED_COMPARISON(>=)
BEAMPIPE_COUNTED_COMPARISON(==)
BEAMPIPE_COUNTED_COMPARISON(!=)
#undef BEAMPIPE_COUNTED_COMPARISON

template <class Value>
Counted<Value> select(bool condition, const Counted<Value>& yes, const Counted<Value>& no) {
  return counted(tally_of(yes, no), &OperationCounts::add, condition ? yes.value : no.value);
}
template <class Value>
Counted<Value> lesser(const Counted<Value>& x, const Counted<Value>& y) {
  return counted(tally_of(x, y), &OperationCounts::add, x.value < y.value ? x.value : y.value);
}
template <class Value>
Counted<Value> greater(const Counted<Value>& x, const Counted<Value>& y) {
  return counted(tally_of(x, y), &OperationCounts::add, x.value > y.value ? x.value : y.value);
}
template <class Value>
Counted<Value> magnitude(const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::bit, x.value < 0 ? -x.value : x.value);
}
template <class Value>
Counted<Value> square_root(const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::special, static_cast<Value>(std::sqrt(x.value)));
}
inline Counted<std::int32_t> to_integer(const Counted<float>& x) {
  return counted(x.tally, &OperationCounts::convert, static_cast<std::int32_t>(x.value));
}
inline Counted<std::uint32_t> to_bits(const Counted<float>& x) {
  return counted(x.tally, &OperationCounts::convert, static_cast<std::uint32_t>(x.value));
}
// The same bits under another type, which costs nothing.
inline Counted<std::uint32_t> bits_of(const Counted<float>& x) {
  Counted<std::uint32_t> bits(std::bit_cast<std::uint32_t>(x.value));
  bits.tally = x.tally;
  return bits;
}
inline Counted<std::uint32_t> bits_of(const Counted<std::int32_t>& x) {
  Counted<std::uint32_t> bits(static_cast<std::uint32_t>(x.value));
  bits.tally = x.tally;
  return bits;
}
inline Counted<float> float_of(const Counted<std::uint32_t>& bits) {
  Counted<float> x(std::bit_cast<float>(bits.value));
  x.tally = bits.tally;
  return x;
}
template <class Value>
Value plain(const Counted<Value>& x) {
  return x.value;
}
template <class Value>
Counted<float> to_float(const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::convert, static_cast<float>(x.value));
}
template <class Value>
Counted<double> to_double(const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::convert, static_cast<double>(x.value));
}
template <class Value>
Counted<Value> converted(const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::convert, x.value);
}
inline Counted<std::uint32_t> fetch(const std::uint32_t* table, const Counted<std::int32_t>& index) {
  return counted(index.tally, &OperationCounts::fetch, table[index.value]);
}
// A register of a pair, which costs nothing.
inline Counted<std::int32_t> low_word(const Counted<std::int64_t>& x) {
  Counted<std::int32_t> low(static_cast<std::int32_t>(x.value));
  low.tally = x.tally;
  return low;
}
template <class Value>
Counted<std::uint32_t> sign_bit(const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::bit, std::uint32_t{x.value < 0});
}
// A funnel shift of two registers.
template <class Value>
Counted<std::uint32_t> shift_in_sign(const Counted<std::uint32_t>& word, const Counted<Value>& x) {
  return counted(x.tally, &OperationCounts::bit, word.value << 1 | std::uint32_t{x.value < 0});
}
// A population count and the conversion of its result.
inline Counted<float> bit_count(const Counted<std::uint32_t>& mask) {
  if (mask.tally) ++mask.tally->convert;
  return counted(mask.tally, &OperationCounts::bit, static_cast<float>(std::popcount(mask.value)));
}

// A loop over the bits of a mask, which is control flow.
inline bool has_bit(const Counted<std::uint32_t>& mask, int bit) { return (mask.value >> bit & 1u) != 0; }

// Calls formula(counts), which runs a scalar formula on numbers that count there, and returns the counts.
template <class Formula>
OperationCounts count_operations(Formula&& formula) {
  OperationCounts counts;
  formula(counts);
  return counts;
}

// The cost of one item, for static constants. It copies the counts because g++ 12.2 loses counts that a function makes
// in place in a static object (it keeps them with -fno-ipa-reference).
struct UnitCost : OperationCounts {
  UnitCost(const OperationCounts& counts) : OperationCounts(counts) {}
};

}  // namespace beampipe

// Arithmetic, comparisons, composites, linear algebra and conversions.
#include <array>
#include <optional>

#include "stages/spirv/decoder.h"

namespace beampipe {
namespace {

using Code = LaneCode;

// Instructions that do the same with each part of their operands.
struct Elementwise {
  Code code;
  bool swaps = false;    // its operands
  bool inverts = false;  // its result, a boolean
};
std::optional<Elementwise> elementwise(spv::Op op) {
  switch (op) {
    case spv::OpFAdd:
      return {{Code::f_add}};
    case spv::OpFSub:
      return {{Code::f_sub}};
    case spv::OpFMul:
      return {{Code::f_mul}};
    case spv::OpFDiv:
      return {{Code::f_div}};
    case spv::OpFMod:
      return {{Code::f_mod}};
    case spv::OpFRem:
      return {{Code::f_rem}};
    case spv::OpFNegate:
      return {{Code::f_negate}};
    case spv::OpIAdd:
      return {{Code::i_add}};
    case spv::OpISub:
      return {{Code::i_sub}};
    case spv::OpIMul:
      return {{Code::i_mul}};
    case spv::OpSNegate:
      return {{Code::i_negate}};
    case spv::OpUDiv:
      return {{Code::u_div}};
    case spv::OpSDiv:
      return {{Code::s_div}};
    case spv::OpUMod:
      return {{Code::u_mod}};
    case spv::OpSMod:
      return {{Code::s_mod}};
    case spv::OpSRem:
      return {{Code::s_rem}};
    case spv::OpBitwiseAnd:
      return {{Code::bit_and}};
    case spv::OpBitwiseOr:
      return {{Code::bit_or}};
    case spv::OpBitwiseXor:
      return {{Code::bit_xor}};
    case spv::OpNot:
      return {{Code::bit_not}};
    case spv::OpBitReverse:
      return {{Code::bit_reverse}};
    case spv::OpBitCount:
      return {{Code::bit_count}};
    case spv::OpLogicalAnd:
      return {{Code::bit_and}};
    case spv::OpLogicalOr:
      return {{Code::bit_or}};
    case spv::OpLogicalNot:
      return {{Code::bit_not}};
    case spv::OpLogicalEqual:
      return {{Code::i_equal}};
    case spv::OpLogicalNotEqual:
      return {{Code::bit_xor}};
    case spv::OpIEqual:
      return {{Code::i_equal}};
    case spv::OpINotEqual:
      return {{Code::i_not_equal}};
    case spv::OpULessThan:
      return {{Code::u_less}};
    case spv::OpULessThanEqual:
      return {{Code::u_less_equal}};
    case spv::OpUGreaterThan:
      return {{Code::u_less, true}};
    case spv::OpUGreaterThanEqual:
      return {{Code::u_less_equal, true}};
    case spv::OpSLessThan:
      return {{Code::s_less}};
    case spv::OpSLessThanEqual:
      return {{Code::s_less_equal}};
    case spv::OpSGreaterThan:
      return {{Code::s_less, true}};
    case spv::OpSGreaterThanEqual:
      return {{Code::s_less_equal, true}};
    case spv::OpFOrdEqual:
      return {{Code::f_equal}};
    case spv::OpFOrdNotEqual:
      return {{Code::f_ordered_not_equal}};
    case spv::OpFOrdLessThan:
      return {{Code::f_less}};
    case spv::OpFOrdLessThanEqual:
      return {{Code::f_less_equal}};
    case spv::OpFOrdGreaterThan:
      return {{Code::f_less, true}};
    case spv::OpFOrdGreaterThanEqual:
      return {{Code::f_less_equal, true}};
    case spv::OpFUnordEqual:
      return {{Code::f_ordered_not_equal, false, true}};
    case spv::OpFUnordNotEqual:
      return {{Code::f_not_equal}};
    case spv::OpFUnordLessThan:
      return {{Code::f_less_equal, true, true}};
    case spv::OpFUnordLessThanEqual:
      return {{Code::f_less, true, true}};
    case spv::OpFUnordGreaterThan:
      return {{Code::f_less_equal, false, true}};
    case spv::OpFUnordGreaterThanEqual:
      return {{Code::f_less, false, true}};
    case spv::OpIsNan:
      return {{Code::is_nan}};
    case spv::OpIsInf:
      return {{Code::is_infinite}};
    case spv::OpDPdx:
      return {{Code::dx}};
    case spv::OpDPdxFine:
      return {{Code::dx}};
    case spv::OpDPdxCoarse:
      return {{Code::dx_coarse}};
    case spv::OpDPdy:
      return {{Code::dy}};
    case spv::OpDPdyFine:
      return {{Code::dy}};
    case spv::OpDPdyCoarse:
      return {{Code::dy_coarse}};
    case spv::OpQuantizeToF16:
      return {{Code::to_half}};
    default:
      return std::nullopt;
  }
}

bool is_difference(Code code) { return code >= Code::dx && code <= Code::dy_coarse; }

}  // namespace

bool Decoder::decode_arithmetic(const Instruction& instruction) {
  const std::span<const std::uint32_t> operands = instruction.operands;
  if (const auto found = elementwise(instruction.op)) {
    const Parts a = parts(operands[0]), b = operands.size() > 1 ? parts(operands[1]) : Parts();
    const ShaderType& type = scalar_of(module_.definition(operands[0]).type);
    if (is_difference(found->code)) draft_.program.takes_differences = true;
    Parts results;
    for (std::size_t i = 0; i < a.size(); ++i) {
      Row first = a[i], second = operands.size() > 1 ? b[i] : kNoRow;
      if (found->swaps) std::swap(first, second);
      const bool is_float = type.kind == Kind::number && scalar_of(instruction.type).kind == Kind::number;
      Row result = is_float                     ? float_op(type.width, found->code, first, second)
                   : type.kind == Kind::integer ? integer_op(type.width, found->code, first, second)
                                                : emit(found->code, first, second);
      if (found->inverts) result = emit_free(Code::bit_not, result);
      results.push_back(result);
    }
    define(instruction, std::move(results));
    return true;
  }
  switch (instruction.op) {
    case spv::OpFwidth:
    case spv::OpFwidthFine:
    case spv::OpFwidthCoarse: {  // |dx| + |dy|
      draft_.program.takes_differences = true;
      const Parts a = parts(operands[0]);
      const bool is_coarse = instruction.op == spv::OpFwidthCoarse;
      const std::uint32_t width = scalar_of(instruction.type).width;
      const auto size = [&](Code code, Row row) { return float_op(width, Code::f_abs, float_op(width, code, row)); };
      Parts results;
      for (const Row row : a)
        results.push_back(float_op(width, Code::f_add, size(is_coarse ? Code::dx_coarse : Code::dx, row),
                                   size(is_coarse ? Code::dy_coarse : Code::dy, row)));
      define(instruction, std::move(results));
      return true;
    }
    case spv::OpShiftLeftLogical:
    case spv::OpShiftRightLogical:
    case spv::OpShiftRightArithmetic: {
      const Parts a = parts(operands[0]), places = parts(operands[1]);
      const std::uint32_t width = scalar_of(instruction.type).width;
      const Code code = instruction.op == spv::OpShiftLeftLogical    ? Code::shift_left
                        : instruction.op == spv::OpShiftRightLogical ? Code::shift_right
                                                                     : Code::shift_right_signed;
      Parts results;
      for (std::size_t i = 0; i < a.size(); ++i) results.push_back(integer_op(width, code, a[i], places[i]));
      define(instruction, std::move(results));
      return true;
    }
    case spv::OpSelect: {
      const Parts condition = parts(operands[0]), yes = parts(operands[1]), no = parts(operands[2]);
      Parts results;
      for (std::size_t i = 0; i < yes.size(); ++i)
        results.push_back(emit(Code::select, condition[condition.size() == 1 ? 0 : i], yes[i], no[i]));
      define(instruction, std::move(results));
      return true;
    }
    case spv::OpAny:
    case spv::OpAll: {
      const Parts a = parts(operands[0]);
      Row result = a[0];
      for (std::size_t i = 1; i < a.size(); ++i)
        result = emit(instruction.op == spv::OpAny ? Code::bit_or : Code::bit_and, result, a[i]);
      define(instruction, {result});
      return true;
    }
    case spv::OpIAddCarry:
    case spv::OpISubBorrow: {
      const Parts a = parts(operands[0]), b = parts(operands[1]);
      if (scalar_of(module_.definition(operands[0]).type).width != 32) return false;
      const bool adds = instruction.op == spv::OpIAddCarry;
      Parts low, carry;
      for (std::size_t i = 0; i < a.size(); ++i) {
        low.push_back(emit(adds ? Code::i_add : Code::i_sub, a[i], b[i]));
        const Row wraps = adds ? emit(Code::u_less, low[i], a[i]) : emit(Code::u_less, a[i], b[i]);
        carry.push_back(emit_free(Code::bit_and, wraps, constant(1)));
      }
      low.append(carry);
      define(instruction, std::move(low));
      return true;
    }
    case spv::OpUMulExtended:
    case spv::OpSMulExtended: {
      const Parts a = parts(operands[0]), b = parts(operands[1]);
      if (scalar_of(module_.definition(operands[0]).type).width != 32) return false;
      Parts low, high;
      for (std::size_t i = 0; i < a.size(); ++i) {
        low.push_back(emit(Code::i_mul, a[i], b[i]));
        high.push_back(emit(instruction.op == spv::OpUMulExtended ? Code::u_mul_high : Code::s_mul_high, a[i], b[i]));
      }
      low.append(high);
      define(instruction, std::move(low));
      return true;
    }
    case spv::OpBitFieldInsert:
    case spv::OpBitFieldUExtract:
    case spv::OpBitFieldSExtract: {
      if (scalar_of(instruction.type).width != 32) return false;
      const bool inserts = instruction.op == spv::OpBitFieldInsert;
      const Parts base = parts(operands[0]);
      const Row offset = part(operands[inserts ? 2 : 1]), count = part(operands[inserts ? 3 : 2]);
      Parts results;
      for (std::size_t i = 0; i < base.size(); ++i) {
        if (inserts) {
          const Row mask = emit(Code::bit_field_mask, offset, count);
          const Row field = emit(Code::bit_and, emit(Code::shift_left, parts(operands[1])[i], offset), mask);
          results.push_back(emit(Code::bit_or, emit(Code::bit_and, base[i], emit(Code::bit_not, mask)), field));
          continue;
        }
        const Row field = emit(Code::bit_and, emit(Code::shift_right, base[i], offset),
                               emit(Code::bit_field_mask, constant(0), count));
        if (instruction.op == spv::OpBitFieldUExtract) {
          results.push_back(field);
          continue;
        }
        // The field's own sign bit, of value s: (field ^ s) - s.
        const Row sign = emit(Code::bit_xor, emit(Code::bit_field_mask, constant(0), count),
                              emit(Code::shift_right, emit(Code::bit_field_mask, constant(0), count), constant(1)));
        results.push_back(emit(Code::i_sub, emit(Code::bit_xor, field, sign), sign));
      }
      define(instruction, std::move(results));
      return true;
    }
    default:
      return decode_composite(instruction) || decode_linear_algebra(instruction) || decode_conversion(instruction);
  }
}

bool Decoder::decode_composite(const Instruction& instruction) {
  const std::span<const std::uint32_t> operands = instruction.operands;
  // Where the part with these indices begins, and its type.
  const auto place_of = [&](std::uint32_t type_id, std::span<const std::uint32_t> indices) {
    std::uint32_t place = 0;
    for (const std::uint32_t index : indices) {
      const ShaderType& type = module_.type(type_id);
      if (type.kind == Kind::structure) {
        if (index >= type.members.size()) throw ShaderError("a composite has no such member");
        for (std::uint32_t i = 0; i < index; ++i) place += module_.type(type.members[i]).parts;
        type_id = type.members[index];
      } else {
        if (index >= type.count) throw ShaderError("a composite has no such element");
        place += index * module_.type(type.element).parts;
        type_id = type.element;
      }
    }
    return std::pair(place, type_id);
  };
  switch (instruction.op) {
    case spv::OpCopyObject:
    case spv::OpCopyLogical:
      values_[instruction.result] = values_[operands[0]];
      if (!values_[operands[0]].pointer && !values_[operands[0]].handle) define(instruction, Parts(parts(operands[0])));
      return true;
    case spv::OpCompositeConstruct: {
      Parts all;
      for (const std::uint32_t operand : operands) all.append(Parts(parts(operand)));
      define(instruction, std::move(all));
      return true;
    }
    case spv::OpCompositeExtract: {
      const auto [place, type] = place_of(module_.definition(operands[0]).type, operands.subspan(1));
      define(instruction, parts(operands[0]).slice(place, parts_of(type)));
      return true;
    }
    case spv::OpCompositeInsert: {
      const Parts object = parts(operands[0]);
      Parts composite = parts(operands[1]);
      const auto [place, type] = place_of(instruction.type, operands.subspan(2));
      for (std::size_t i = 0; i < object.size(); ++i) composite.set(place + i, object[i]);
      define(instruction, std::move(composite));
      return true;
    }
    case spv::OpVectorShuffle: {
      Parts both = parts(operands[0]);
      both.append(Parts(parts(operands[1])));
      Parts results;
      for (const std::uint32_t i : operands.subspan(2)) results.push_back(i == ~0u ? constant(0) : both[i]);
      define(instruction, std::move(results));
      return true;
    }
    case spv::OpVectorExtractDynamic: {
      const Parts vector = parts(operands[0]);
      const Row index = part(operands[1]);
      Row result = vector[0];
      for (std::uint32_t i = 1; i < vector.size(); ++i)
        result = emit(Code::select, emit(Code::i_equal, index, constant(i)), vector[i], result);
      define(instruction, {result});
      return true;
    }
    case spv::OpVectorInsertDynamic: {
      const Parts vector = parts(operands[0]);
      const Row component = part(operands[1]), index = part(operands[2]);
      Parts results;
      for (std::uint32_t i = 0; i < vector.size(); ++i)
        results.push_back(emit(Code::select, emit(Code::i_equal, index, constant(i)), component, vector[i]));
      define(instruction, std::move(results));
      return true;
    }
    default:
      return false;
  }
}

// From the first product on, one after the other.
Row Decoder::dot(std::uint32_t width, const Parts& a, const Parts& b) {
  Row sum = float_op(width, Code::f_mul, a[0], b[0]);
  for (std::size_t i = 1; i < a.size(); ++i)
    sum = float_op(width, Code::f_add, sum, float_op(width, Code::f_mul, a[i], b[i]));
  return sum;
}

bool Decoder::decode_linear_algebra(const Instruction& instruction) {
  const std::span<const std::uint32_t> operands = instruction.operands;
  const auto type_of = [&](std::size_t i) -> const ShaderType& {
    return module_.type(module_.definition(operands[i]).type);
  };
  // A matrix's parts are its columns, one after the other.
  const auto row_of = [](const Parts& matrix, std::uint32_t row, std::uint32_t rows, std::uint32_t columns) {
    Parts found;
    for (std::uint32_t i = 0; i < columns; ++i) found.push_back(matrix[i * rows + row]);
    return found;
  };
  const auto width = [&] { return scalar_of(instruction.type).width; };
  Parts results;
  switch (instruction.op) {
    case spv::OpDot:
      results.push_back(dot(width(), Parts(parts(operands[0])), Parts(parts(operands[1]))));
      break;
    case spv::OpVectorTimesScalar:
    case spv::OpMatrixTimesScalar: {
      const Parts a = parts(operands[0]);
      const Row scalar = part(operands[1]);
      for (const Row row : a) results.push_back(float_op(width(), Code::f_mul, row, scalar));
      break;
    }
    case spv::OpMatrixTimesVector: {
      const Parts matrix = parts(operands[0]), vector = parts(operands[1]);
      const std::uint32_t columns = type_of(0).count, rows = module_.type(type_of(0).element).count;
      for (std::uint32_t i = 0; i < rows; ++i)
        results.push_back(dot(width(), row_of(matrix, i, rows, columns), vector));
      break;
    }
    case spv::OpVectorTimesMatrix: {
      const Parts vector = parts(operands[0]), matrix = parts(operands[1]);
      const std::uint32_t columns = type_of(1).count, rows = module_.type(type_of(1).element).count;
      for (std::uint32_t i = 0; i < columns; ++i)
        results.push_back(dot(width(), vector, matrix.slice(std::size_t{i} * rows, rows)));
      break;
    }
    case spv::OpMatrixTimesMatrix: {
      const Parts left = parts(operands[0]), right = parts(operands[1]);
      const std::uint32_t inner = type_of(0).count, rows = module_.type(type_of(0).element).count;
      for (std::uint32_t column = 0; column < type_of(1).count; ++column)
        for (std::uint32_t i = 0; i < rows; ++i)
          results.push_back(
              dot(width(), row_of(left, i, rows, inner), right.slice(std::size_t{column} * inner, inner)));
      break;
    }
    case spv::OpOuterProduct: {
      const Parts column = parts(operands[0]), row = parts(operands[1]);
      for (const Row factor : row)
        for (const Row element : column) results.push_back(float_op(width(), Code::f_mul, element, factor));
      break;
    }
    case spv::OpTranspose: {
      const Parts matrix = parts(operands[0]);
      const std::uint32_t columns = type_of(0).count, rows = module_.type(type_of(0).element).count;
      for (std::uint32_t i = 0; i < rows; ++i) results.append(row_of(matrix, i, rows, columns));
      break;
    }
    default:
      return false;
  }
  define(instruction, std::move(results));
  return true;
}

bool Decoder::decode_conversion(const Instruction& instruction) {
  const std::span<const std::uint32_t> operands = instruction.operands;
  switch (instruction.op) {
    case spv::OpBitcast:
    case spv::OpConvertFToU:
    case spv::OpConvertFToS:
    case spv::OpConvertSToF:
    case spv::OpConvertUToF:
    case spv::OpUConvert:
    case spv::OpSConvert:
    case spv::OpFConvert:
      break;
    default:
      return false;
  }
  const Parts from = parts(operands[0]);
  const std::uint32_t from_type = module_.definition(operands[0]).type;
  if (instruction.op == spv::OpBitcast) {
    define(instruction, cast_bits(instruction.type, from_type, from));
    return true;
  }
  const std::uint32_t width = scalar_of(instruction.type).width, from_width = scalar_of(from_type).width;
  Parts results;
  for (const Row row : from) {
    switch (instruction.op) {
      case spv::OpConvertFToU:
        results.push_back(narrowed(width, emit(Code::f_to_u, row)));
        break;
      case spv::OpConvertFToS:
        results.push_back(narrowed(width, emit(Code::f_to_s, row)));
        break;
      case spv::OpConvertSToF:
        results.push_back(float_op(width, Code::s_to_f, widened(from_width, row)));
        break;
      case spv::OpConvertUToF:
        results.push_back(float_op(width, Code::u_to_f, row));
        break;
      case spv::OpUConvert:
        results.push_back(width < from_width ? narrowed(width, row) : row);
        break;
      case spv::OpSConvert:
        results.push_back(width < from_width ? narrowed(width, row) : narrowed(width, widened(from_width, row)));
        break;
      default:  // a 16-bit float is kept as one of 32 bits; SPIR-V leaves open how it is rounded, and Mesa rounds
                // texels so
        results.push_back(width == from_width || width == 32 ? row
                          : texels_.contains(row)            ? emit(Code::to_half_towards_zero, row)
                                                             : emit(Code::to_half, row));
    }
  }
  define(instruction, std::move(results));
  return true;
}

}  // namespace beampipe

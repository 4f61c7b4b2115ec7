// The extended instructions of GLSL.std.450.
#include <spirv/unified1/GLSL.std.450.h>

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "stages/spirv/decoder.h"

namespace beampipe {
namespace {

using Code = LaneCode;

// Instructions that do the same with each part of their operands.
std::optional<Code> elementwise(std::uint32_t number) {
  switch (number) {
    case GLSLstd450Round:
    case GLSLstd450RoundEven:
      return Code::round_even;
    case GLSLstd450Trunc:
      return Code::trunc;
    case GLSLstd450FAbs:
      return Code::f_abs;
    case GLSLstd450SAbs:
      return Code::s_abs;
    case GLSLstd450FSign:
      return Code::f_sign;
    case GLSLstd450SSign:
      return Code::s_sign;
    case GLSLstd450Floor:
      return Code::floor;
    case GLSLstd450Ceil:
      return Code::ceil;
    case GLSLstd450Sin:
      return Code::sin;
    case GLSLstd450Cos:
      return Code::cos;
    case GLSLstd450Tan:
      return Code::tan;
    case GLSLstd450Asin:
      return Code::asin;
    case GLSLstd450Acos:
      return Code::acos;
    case GLSLstd450Atan:
      return Code::atan;
    case GLSLstd450Sinh:
      return Code::sinh;
    case GLSLstd450Cosh:
      return Code::cosh;
    case GLSLstd450Tanh:
      return Code::tanh;
    case GLSLstd450Asinh:
      return Code::asinh;
    case GLSLstd450Acosh:
      return Code::acosh;
    case GLSLstd450Atanh:
      return Code::atanh;
    case GLSLstd450Atan2:
      return Code::atan2;
    case GLSLstd450Pow:
      return Code::pow;
    case GLSLstd450Exp:
      return Code::exp;
    case GLSLstd450Log:
      return Code::log;
    case GLSLstd450Exp2:
      return Code::exp2;
    case GLSLstd450Log2:
      return Code::log2;
    case GLSLstd450Sqrt:
      return Code::sqrt;
    case GLSLstd450InverseSqrt:
      return Code::inverse_sqrt;
    case GLSLstd450FMin:
    case GLSLstd450NMin:
      return Code::f_min;
    case GLSLstd450UMin:
      return Code::u_min;
    case GLSLstd450SMin:
      return Code::s_min;
    case GLSLstd450FMax:
    case GLSLstd450NMax:
      return Code::f_max;
    case GLSLstd450UMax:
      return Code::u_max;
    case GLSLstd450SMax:
      return Code::s_max;
    case GLSLstd450Ldexp:
      return Code::ldexp;
    case GLSLstd450FindILsb:
      return Code::find_lowest;
    case GLSLstd450FindSMsb:
      return Code::find_highest_signed;
    case GLSLstd450FindUMsb:
      return Code::find_highest;
    default:
      return std::nullopt;
  }
}

}  // namespace

void Decoder::decode_glsl(const Instruction& instruction) {
  const std::uint32_t number = instruction.operands[1];
  const std::span<const std::uint32_t> operands = instruction.operands.subspan(2);
  if (const auto code = elementwise(number)) {
    const Parts a = parts(operands[0]), b = operands.size() > 1 ? parts(operands[1]) : Parts();
    const ShaderType& type = scalar_of(instruction.type);
    Parts results;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Row second = operands.size() > 1 ? b[i] : kNoRow;
      results.push_back(type.kind == Kind::number ? float_op(type.width, *code, a[i], second)
                                                  : integer_op(type.width, *code, a[i], second));
    }
    return define(instruction, std::move(results));
  }
  define(instruction, glsl_of_vectors(instruction));
}

// Instructions that several operations make up.
Parts Decoder::glsl_of_vectors(const Instruction& instruction) {
  const std::uint32_t opcode = instruction.operands[1];
  const std::span<const std::uint32_t> ids = instruction.operands.subspan(2);
  const std::uint32_t width = [&] {  // of the floats that it computes with
    const ShaderType& first = scalar_of(module_.definition(ids[0]).type);
    return first.kind == Kind::number ? first.width : 32u;
  }();
  const auto op = [&](Code code, Row a, Row b = kNoRow) { return float_op(width, code, a, b); };
  const auto add = [&](Row a, Row b) { return op(Code::f_add, a, b); };
  const auto sub = [&](Row a, Row b) { return op(Code::f_sub, a, b); };
  const auto mul = [&](Row a, Row b) { return op(Code::f_mul, a, b); };
  const auto divide = [&](Row a, Row b) { return op(Code::f_div, a, b); };
  const auto clamp = [&](Row x, Row least, Row most) { return op(Code::f_min, op(Code::f_max, x, least), most); };
  const auto dot_of = [&](const Parts& a, const Parts& b) { return dot(width, a, b); };
  const auto length = [&](const Parts& a) {
    return a.size() == 1 ? op(Code::f_abs, a[0]) : op(Code::sqrt, dot_of(a, a));
  };
  const auto times = [&](const Parts& a, Row factor) {
    Parts results;
    for (const Row row : a) results.push_back(mul(row, factor));
    return results;
  };
  // formula(i) of each part.
  const auto each = [&](std::size_t count, const std::function<Row(std::size_t)>& formula) {
    Parts results;
    for (std::size_t i = 0; i < count; ++i) results.push_back(formula(i));
    return results;
  };
  // The determinant of rows and columns of a matrix that are left, by its first column that is.
  const auto minor = [&](const Parts& matrix, std::uint32_t size, std::uint32_t left_out_row,
                         std::uint32_t left_out_column) {
    const std::function<Row(std::vector<std::uint32_t>, std::vector<std::uint32_t>)> determinant =
        [&](std::vector<std::uint32_t> rows, std::vector<std::uint32_t> columns) -> Row {
      const auto at = [&](std::size_t row, std::size_t column) { return matrix[columns[column] * size + rows[row]]; };
      if (rows.empty()) return this->number(1);
      if (rows.size() == 1) return at(0, 0);
      if (rows.size() == 2) return sub(mul(at(0, 0), at(1, 1)), mul(at(0, 1), at(1, 0)));
      Row sum = kNoRow;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        std::vector<std::uint32_t> others = rows;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        const Row term = mul(at(i, 0), determinant(others, {columns.begin() + 1, columns.end()}));
        sum = sum == kNoRow ? term : i % 2 ? sub(sum, term) : add(sum, term);
      }
      return sum;
    };
    std::vector<std::uint32_t> rows, columns;
    for (std::uint32_t i = 0; i < size; ++i) {
      if (i != left_out_row) rows.push_back(i);
      if (i != left_out_column) columns.push_back(i);
    }
    return determinant(rows, columns);
  };

  const Parts x = parts(ids[0]);
  const auto operand = [&](std::size_t i) { return i < ids.size() ? Parts(parts(ids[i])) : Parts(); };
  switch (opcode) {
    case GLSLstd450Fract:
      return each(x.size(), [&](std::size_t i) { return sub(x[i], op(Code::floor, x[i])); });
    case GLSLstd450Radians:
      return times(x, this->number(0.017453292519943295f));
    case GLSLstd450Degrees:
      return times(x, this->number(57.29577951308232f));
    case GLSLstd450Determinant: {
      const std::uint32_t size = module_.type(module_.definition(ids[0]).type).count;
      return {minor(x, size, size, size)};
    }
    case GLSLstd450MatrixInverse: {  // the adjugate, over the determinant along the first column
      const std::uint32_t size = module_.type(instruction.type).count;
      const auto cofactor = [&](std::uint32_t row, std::uint32_t column) {
        const Row found = minor(x, size, row, column);
        return (row + column) % 2 ? op(Code::f_negate, found) : found;
      };
      std::vector<Row> cofactors;
      for (std::uint32_t i = 0; i < size * size; ++i) cofactors.push_back(cofactor(i % size, i / size));
      Row determinant = mul(x[0], cofactors[0]);
      for (std::uint32_t i = 1; i < size; ++i) determinant = add(determinant, mul(x[i], cofactors[i]));
      return each(x.size(), [&](std::size_t i) { return divide(cofactors[i % size * size + i / size], determinant); });
    }
    case GLSLstd450Modf:
    case GLSLstd450ModfStruct: {
      Parts whole = each(x.size(), [&](std::size_t i) { return op(Code::trunc, x[i]); });
      Parts rest = each(x.size(), [&](std::size_t i) { return sub(x[i], whole[i]); });
      if (opcode == GLSLstd450Modf)
        store(pointer(ids[1]), whole);
      else
        rest.append(whole);
      return rest;
    }
    case GLSLstd450Frexp:
    case GLSLstd450FrexpStruct: {
      Parts fraction = each(x.size(), [&](std::size_t i) { return op(Code::fraction, x[i]); });
      const Parts exponent = each(x.size(), [&](std::size_t i) { return emit(Code::exponent, x[i]); });
      if (opcode == GLSLstd450Frexp)
        store(pointer(ids[1]), exponent);
      else
        fraction.append(exponent);
      return fraction;
    }
    case GLSLstd450FClamp:
    case GLSLstd450NClamp: {
      const Parts least = operand(1), most = operand(2);
      return each(x.size(), [&](std::size_t i) { return clamp(x[i], least[i], most[i]); });
    }
    case GLSLstd450UClamp:
    case GLSLstd450SClamp: {
      const Parts least = operand(1), most = operand(2);
      const std::uint32_t bits = scalar_of(instruction.type).width;
      const bool is_signed = opcode == GLSLstd450SClamp;
      return each(x.size(), [&](std::size_t i) {
        return integer_op(bits, is_signed ? Code::s_min : Code::u_min,
                          integer_op(bits, is_signed ? Code::s_max : Code::u_max, x[i], least[i]), most[i]);
      });
    }
    case GLSLstd450FMix: {  // x (1 - a) + y a
      const Parts y = operand(1), a = operand(2);
      return each(x.size(), [&](std::size_t i) { return add(mul(x[i], sub(this->number(1), a[i])), mul(y[i], a[i])); });
    }
    case GLSLstd450Step: {  // of an edge and x
      const Parts at = operand(1);
      return each(x.size(), [&](std::size_t i) {
        return emit(Code::select, emit(Code::f_less, at[i], x[i]), this->number(0), this->number(1));
      });
    }
    case GLSLstd450SmoothStep: {  // of two edges and x
      const Parts upper = operand(1), at = operand(2);
      return each(x.size(), [&](std::size_t i) {
        const Row t = clamp(divide(sub(at[i], x[i]), sub(upper[i], x[i])), this->number(0), this->number(1));
        return mul(mul(t, t), sub(this->number(3), mul(this->number(2), t)));
      });
    }
    case GLSLstd450Fma: {
      const Parts y = operand(1), z = operand(2);
      return each(x.size(), [&](std::size_t i) { return add(mul(x[i], y[i]), z[i]); });
    }
    case GLSLstd450Length:
      return {length(x)};
    case GLSLstd450Distance: {
      const Parts y = operand(1);
      return {length(each(x.size(), [&](std::size_t i) { return sub(x[i], y[i]); }))};
    }
    case GLSLstd450Normalize:
      if (x.size() == 1) return {op(Code::f_sign, x[0])};
      return times(x, op(Code::inverse_sqrt, dot_of(x, x)));
    case GLSLstd450Cross: {
      const Parts y = operand(1);
      return each(3, [&](std::size_t i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        return sub(mul(x[j], y[k]), mul(y[j], x[k]));
      });
    }
    case GLSLstd450FaceForward: {  // of N, I and Nref
      const Row is_towards = emit(Code::f_less, dot_of(operand(2), operand(1)), this->number(0));
      return each(x.size(),
                  [&](std::size_t i) { return emit(Code::select, is_towards, x[i], op(Code::f_negate, x[i])); });
    }
    case GLSLstd450Reflect: {  // I - 2 dot(N, I) N
      const Parts normal = operand(1);
      const Row twice = mul(this->number(2), dot_of(normal, x));
      return each(x.size(), [&](std::size_t i) { return sub(x[i], mul(twice, normal[i])); });
    }
    case GLSLstd450Refract: {  // eta I - (eta dot(N, I) + sqrt(k)) N, where k = 1 - eta^2 (1 - dot(N, I)^2) >= 0, else
                               // 0
      const Parts normal = operand(1);
      const Row eta = operand(2)[0], cosine = dot_of(normal, x), one = this->number(1);
      const Row k = sub(one, mul(mul(eta, eta), sub(one, mul(cosine, cosine))));
      const Row factor = add(mul(eta, cosine), op(Code::sqrt, k)),
                is_refracted = emit(Code::f_less_equal, this->number(0), k);
      return each(x.size(), [&](std::size_t i) {
        return emit(Code::select, is_refracted, sub(mul(eta, x[i]), mul(factor, normal[i])), this->number(0));
      });
    }
    case GLSLstd450PackSnorm4x8:
    case GLSLstd450PackUnorm4x8:
    case GLSLstd450PackSnorm2x16:
    case GLSLstd450PackUnorm2x16: {
      const bool is_signed = opcode == GLSLstd450PackSnorm4x8 || opcode == GLSLstd450PackSnorm2x16;
      const std::uint32_t bits = x.size() == 4 ? 8 : 16;
      const float scale = static_cast<float>((1u << (is_signed ? bits - 1 : bits)) - 1);
      Row word = kNoRow;
      for (std::uint32_t i = 0; i < x.size(); ++i) {
        const Row bounded = clamp(x[i], this->number(is_signed ? -1 : 0), this->number(1));
        const Row whole = emit(Code::f_to_s, emit(Code::round_even, mul(bounded, this->number(scale))));
        const Row field =
            emit(Code::shift_left, emit(Code::bit_and, whole, constant((1u << bits) - 1)), constant(bits * i));
        word = word == kNoRow ? field : emit(Code::bit_or, word, field);
      }
      return {word};
    }
    case GLSLstd450UnpackSnorm4x8:
    case GLSLstd450UnpackUnorm4x8:
    case GLSLstd450UnpackSnorm2x16:
    case GLSLstd450UnpackUnorm2x16: {
      const bool is_signed = opcode == GLSLstd450UnpackSnorm4x8 || opcode == GLSLstd450UnpackSnorm2x16;
      const std::uint32_t count = parts_of(instruction.type), bits = 32 / count;
      const float scale = static_cast<float>((1u << (is_signed ? bits - 1 : bits)) - 1);
      return each(count, [&](std::size_t i) {
        const Row field = emit(Code::bit_and, emit(Code::shift_right, x[0], constant(bits * static_cast<Row>(i))),
                               constant((1u << bits) - 1));
        if (!is_signed) return divide(emit(Code::u_to_f, field), this->number(scale));
        return clamp(divide(emit(Code::s_to_f, widened(bits, field)), this->number(scale)), this->number(-1),
                     this->number(1));
      });
    }
    case GLSLstd450PackHalf2x16: {
      const auto bits_of = [&](std::size_t i) { return half_bits(emit(Code::to_half, x[i])); };
      return {emit(Code::bit_or, bits_of(0), emit(Code::shift_left, bits_of(1), constant(16)))};
    }
    case GLSLstd450UnpackHalf2x16: {
      const Row low = emit(Code::bit_and, x[0], constant(0xffff)), high = emit(Code::shift_right, x[0], constant(16));
      return {half_value(low), half_value(high)};
    }
    default:
      throw ShaderError("number " + std::to_string(opcode) + " of GLSL.std.450 is not supported");
  }
}

}  // namespace beampipe

// The extended instructions of GLSL.std.450.
#include <spirv/unified1/GLSL.std.450.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

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

// Instructions that several operations make up. Each function has the instructions of a family, and gives nothing for
// others.
class Decoder::GlslFormulas {
 public:
  GlslFormulas(Decoder& decoder, const Instruction& instruction)
      : decoder_(decoder),
        instruction_(instruction),
        opcode_(instruction.operands[1]),
        ids_(instruction.operands.subspan(2)),
        width_(width_of(decoder.scalar_of(decoder.module_.definition(ids_[0]).type))),
        x_(decoder.parts(ids_[0])) {}

  std::optional<Parts> part_by_part();
  std::optional<Parts> split();
  std::optional<Parts> of_vectors();
  std::optional<Parts> of_matrix();
  std::optional<Parts> packed();
  std::optional<Parts> unpacked();

 private:
  static std::uint32_t width_of(const ShaderType& type) { return type.kind == Kind::number ? type.width : 32u; }

  Row op(Code code, Row a, Row b = kNoRow) { return decoder_.float_op(width_, code, a, b); }
  Row emit(Code code, Row a, Row b = kNoRow, Row c = kNoRow) { return decoder_.emit(code, a, b, c); }
  Row number(float value) { return decoder_.number(value); }
  Row constant(std::uint32_t bits) { return decoder_.constant(bits); }
  Row add(Row a, Row b) { return op(Code::f_add, a, b); }
  Row sub(Row a, Row b) { return op(Code::f_sub, a, b); }
  Row mul(Row a, Row b) { return op(Code::f_mul, a, b); }
  Row divide(Row a, Row b) { return op(Code::f_div, a, b); }
  Row clamp(Row x, Row least, Row most) { return op(Code::f_min, op(Code::f_max, x, least), most); }
  Row dot(const Parts& a, const Parts& b) { return decoder_.dot(width_, a, b); }
  Row length(const Parts& a) { return a.size() == 1 ? op(Code::f_abs, a[0]) : op(Code::sqrt, dot(a, a)); }
  Parts times(const Parts& a, Row factor) {
    return each(a.size(), [&](std::size_t i) { return mul(a[i], factor); });
  }
  // formula(i) of each part.
  template <class Formula>
  static Parts each(std::size_t count, const Formula& formula) {
    Parts results;
    for (std::size_t i = 0; i < count; ++i) results.push_back(formula(i));
    return results;
  }
  Parts operand(std::size_t i) { return i < ids_.size() ? Parts(decoder_.parts(ids_[i])) : Parts(); }

  using Lines = std::vector<std::uint32_t>;  // numbers of rows or columns
  Row determinant(std::uint32_t size, const Lines& rows, const Lines& columns);
  Row minor(std::uint32_t size, std::uint32_t left_out_row, std::uint32_t left_out_column);

  Decoder& decoder_;
  const Instruction& instruction_;
  const std::uint32_t opcode_;
  const std::span<const std::uint32_t> ids_;
  const std::uint32_t width_;  // of the floats that it computes with
  const Parts x_;              // the first operand
};

std::optional<Parts> Decoder::GlslFormulas::part_by_part() {
  switch (opcode_) {
    case GLSLstd450Fract:
      return each(x_.size(), [&](std::size_t i) { return sub(x_[i], op(Code::floor, x_[i])); });
    case GLSLstd450Radians:
      return times(x_, number(0.017453292519943295f));
    case GLSLstd450Degrees:
      return times(x_, number(57.29577951308232f));
    case GLSLstd450FClamp:
    case GLSLstd450NClamp: {
      const Parts least = operand(1), most = operand(2);
      return each(x_.size(), [&](std::size_t i) { return clamp(x_[i], least[i], most[i]); });
    }
    case GLSLstd450UClamp:
    case GLSLstd450SClamp: {
      const Parts least = operand(1), most = operand(2);
      const std::uint32_t bits = decoder_.scalar_of(instruction_.type).width;
      const bool is_signed = opcode_ == GLSLstd450SClamp;
      return each(x_.size(), [&](std::size_t i) {
        return decoder_.integer_op(bits, is_signed ? Code::s_min : Code::u_min,
                                   decoder_.integer_op(bits, is_signed ? Code::s_max : Code::u_max, x_[i], least[i]),
                                   most[i]);
      });
    }
    case GLSLstd450FMix: {  // x (1 - a) + y a
      const Parts y = operand(1), a = operand(2);
      return each(x_.size(), [&](std::size_t i) { return add(mul(x_[i], sub(number(1), a[i])), mul(y[i], a[i])); });
    }
    case GLSLstd450Step: {  // of an edge and x
      const Parts at = operand(1);
      return each(x_.size(), [&](std::size_t i) {
        return emit(Code::select, emit(Code::f_less, at[i], x_[i]), number(0), number(1));
      });
    }
    case GLSLstd450SmoothStep: {  // of two edges and x
      const Parts upper = operand(1), at = operand(2);
      return each(x_.size(), [&](std::size_t i) {
        const Row t = clamp(divide(sub(at[i], x_[i]), sub(upper[i], x_[i])), number(0), number(1));
        return mul(mul(t, t), sub(number(3), mul(number(2), t)));
      });
    }
    case GLSLstd450Fma: {
      const Parts y = operand(1), z = operand(2);
      return each(x_.size(), [&](std::size_t i) { return add(mul(x_[i], y[i]), z[i]); });
    }
    default:
      return std::nullopt;
  }
}

std::optional<Parts> Decoder::GlslFormulas::split() {
  switch (opcode_) {
    case GLSLstd450Modf:
    case GLSLstd450ModfStruct: {
      Parts whole = each(x_.size(), [&](std::size_t i) { return op(Code::trunc, x_[i]); });
      Parts rest = each(x_.size(), [&](std::size_t i) { return sub(x_[i], whole[i]); });
      if (opcode_ == GLSLstd450Modf)
        decoder_.store(decoder_.pointer(ids_[1]), whole);
      else
        rest.append(whole);
      return rest;
    }
    case GLSLstd450Frexp:
    case GLSLstd450FrexpStruct: {
      Parts fraction = each(x_.size(), [&](std::size_t i) { return op(Code::fraction, x_[i]); });
      const Parts exponent = each(x_.size(), [&](std::size_t i) { return emit(Code::exponent, x_[i]); });
      if (opcode_ == GLSLstd450Frexp)
        decoder_.store(decoder_.pointer(ids_[1]), exponent);
      else
        fraction.append(exponent);
      return fraction;
    }
    default:
      return std::nullopt;
  }
}

std::optional<Parts> Decoder::GlslFormulas::of_vectors() {
  switch (opcode_) {
    case GLSLstd450Length:
      return Parts{length(x_)};
    case GLSLstd450Distance: {
      const Parts y = operand(1);
      return Parts{length(each(x_.size(), [&](std::size_t i) { return sub(x_[i], y[i]); }))};
    }
    case GLSLstd450Normalize:
      if (x_.size() == 1) return Parts{op(Code::f_sign, x_[0])};
      return times(x_, op(Code::inverse_sqrt, dot(x_, x_)));
    case GLSLstd450Cross: {
      const Parts y = operand(1);
      return each(3, [&](std::size_t i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        return sub(mul(x_[j], y[k]), mul(y[j], x_[k]));
      });
    }
    case GLSLstd450FaceForward: {  // of N, I and Nref
      const Row is_towards = emit(Code::f_less, dot(operand(2), operand(1)), number(0));
      return each(x_.size(),
                  [&](std::size_t i) { return emit(Code::select, is_towards, x_[i], op(Code::f_negate, x_[i])); });
    }
    case GLSLstd450Reflect: {  // I - 2 dot(N, I) N
      const Parts normal = operand(1);
      const Row twice = mul(number(2), dot(normal, x_));
      return each(x_.size(), [&](std::size_t i) { return sub(x_[i], mul(twice, normal[i])); });
    }
    case GLSLstd450Refract: {  // eta I - (eta dot(N, I) + sqrt(k)) N, where k = 1 - eta^2 (1 - dot(N, I)^2) >= 0, else
                               // 0
      const Parts normal = operand(1);
      const Row eta = operand(2)[0], cosine = dot(normal, x_), one = number(1);
      const Row k = sub(one, mul(mul(eta, eta), sub(one, mul(cosine, cosine))));
      const Row factor = add(mul(eta, cosine), op(Code::sqrt, k)),
                is_refracted = emit(Code::f_less_equal, number(0), k);
      return each(x_.size(), [&](std::size_t i) {
        return emit(Code::select, is_refracted, sub(mul(eta, x_[i]), mul(factor, normal[i])), number(0));
      });
    }
    default:
      return std::nullopt;
  }
}

// The determinant of the rows and columns of a matrix that are listed, by the first of these columns.
Row Decoder::GlslFormulas::determinant(std::uint32_t size, const Lines& rows, const Lines& columns) {
  const auto at = [&](std::size_t row, std::size_t column) { return x_[columns[column] * size + rows[row]]; };
  if (rows.empty()) return number(1);
  if (rows.size() == 1) return at(0, 0);
  if (rows.size() == 2) return sub(mul(at(0, 0), at(1, 1)), mul(at(0, 1), at(1, 0)));
  Row sum = kNoRow;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Lines others = rows;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Row term = mul(at(i, 0), determinant(size, others, {columns.begin() + 1, columns.end()}));
    sum = sum == kNoRow ? term : i % 2 ? sub(sum, term) : add(sum, term);
  }
  return sum;
}

// The determinant of all rows and columns but these.
Row Decoder::GlslFormulas::minor(std::uint32_t size, std::uint32_t left_out_row, std::uint32_t left_out_column) {
  Lines rows, columns;
  for (std::uint32_t i = 0; i < size; ++i) {
    if (i != left_out_row) rows.push_back(i);
    if (i != left_out_column) columns.push_back(i);
  }
  return determinant(size, rows, columns);
}

std::optional<Parts> Decoder::GlslFormulas::of_matrix() {
  switch (opcode_) {
    case GLSLstd450Determinant: {
      const std::uint32_t size = decoder_.module_.type(decoder_.module_.definition(ids_[0]).type).count;
      return Parts{minor(size, size, size)};
    }
    case GLSLstd450MatrixInverse: {  // the adjugate, over the determinant along the first column
      const std::uint32_t size = decoder_.module_.type(instruction_.type).count;
      const auto cofactor = [&](std::uint32_t row, std::uint32_t column) {
        const Row found = minor(size, row, column);
        return (row + column) % 2 ? op(Code::f_negate, found) : found;
      };
      std::vector<Row> cofactors;
      for (std::uint32_t i = 0; i < size * size; ++i) cofactors.push_back(cofactor(i % size, i / size));
      Row whole = mul(x_[0], cofactors[0]);
      for (std::uint32_t i = 1; i < size; ++i) whole = add(whole, mul(x_[i], cofactors[i]));
      return each(x_.size(), [&](std::size_t i) { return divide(cofactors[i % size * size + i / size], whole); });
    }
    default:
      return std::nullopt;
  }
}

std::optional<Parts> Decoder::GlslFormulas::packed() {
  switch (opcode_) {
    case GLSLstd450PackSnorm4x8:
    case GLSLstd450PackUnorm4x8:
    case GLSLstd450PackSnorm2x16:
    case GLSLstd450PackUnorm2x16: {
      const bool is_signed = opcode_ == GLSLstd450PackSnorm4x8 || opcode_ == GLSLstd450PackSnorm2x16;
      const std::uint32_t bits = x_.size() == 4 ? 8 : 16;
      const float scale = static_cast<float>((1u << (is_signed ? bits - 1 : bits)) - 1);
      Row word = kNoRow;
      for (std::uint32_t i = 0; i < x_.size(); ++i) {
        const Row bounded = clamp(x_[i], number(is_signed ? -1 : 0), number(1));
        const Row whole = emit(Code::f_to_s, emit(Code::round_even, mul(bounded, number(scale))));
        const Row field =
            emit(Code::shift_left, emit(Code::bit_and, whole, constant((1u << bits) - 1)), constant(bits * i));
        word = word == kNoRow ? field : emit(Code::bit_or, word, field);
      }
      return Parts{word};
    }
    case GLSLstd450PackHalf2x16: {
      const auto bits_of = [&](std::size_t i) { return decoder_.half_bits(emit(Code::to_half, x_[i])); };
      return Parts{emit(Code::bit_or, bits_of(0), emit(Code::shift_left, bits_of(1), constant(16)))};
    }
    default:
      return std::nullopt;
  }
}

std::optional<Parts> Decoder::GlslFormulas::unpacked() {
  switch (opcode_) {
    case GLSLstd450UnpackSnorm4x8:
    case GLSLstd450UnpackUnorm4x8:
    case GLSLstd450UnpackSnorm2x16:
    case GLSLstd450UnpackUnorm2x16: {
      const bool is_signed = opcode_ == GLSLstd450UnpackSnorm4x8 || opcode_ == GLSLstd450UnpackSnorm2x16;
      const std::uint32_t count = decoder_.parts_of(instruction_.type), bits = 32 / count;
      const float scale = static_cast<float>((1u << (is_signed ? bits - 1 : bits)) - 1);
      return each(count, [&](std::size_t i) {
        const Row field = emit(Code::bit_and, emit(Code::shift_right, x_[0], constant(bits * static_cast<Row>(i))),
                               constant((1u << bits) - 1));
        if (!is_signed) return divide(emit(Code::u_to_f, field), number(scale));
        return clamp(divide(emit(Code::s_to_f, decoder_.widened(bits, field)), number(scale)), number(-1), number(1));
      });
    }
    case GLSLstd450UnpackHalf2x16: {
      const Row low = emit(Code::bit_and, x_[0], constant(0xffff)), high = emit(Code::shift_right, x_[0], constant(16));
      return Parts{decoder_.half_value(low), decoder_.half_value(high)};
    }
    default:
      return std::nullopt;
  }
}

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
  GlslFormulas formulas(*this, instruction);
  for (const auto family : {&GlslFormulas::part_by_part, &GlslFormulas::split, &GlslFormulas::of_vectors,
                            &GlslFormulas::of_matrix, &GlslFormulas::packed, &GlslFormulas::unpacked})
    if (std::optional<Parts> parts = (formulas.*family)()) return define(instruction, std::move(*parts));
  throw ShaderError("number " + std::to_string(number) + " of GLSL.std.450 is not supported");
}

}  // namespace beampipe

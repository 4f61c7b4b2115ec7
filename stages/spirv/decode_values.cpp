#include <bit>
#include <string>

#include "stages/data/half_bits.h"
#include "stages/spirv/decode.h"
#include "stages/spirv/decoder.h"

namespace beampipe {

Row Decoder::constant(std::uint32_t bits) {
  const auto [found, is_new] = constants_.try_emplace(bits, 0);
  if (is_new) found->second = draft_.add_row(DraftRow::Kind::constant, bits);
  return found->second;
}

Row Decoder::number(float value) { return constant(std::bit_cast<std::uint32_t>(value)); }

// The same operation again, in the same block, is the row that it has made.
Row Decoder::emit(const LaneOp& op) {
  const std::array<std::uint32_t, 6> key{static_cast<std::uint32_t>(op.code), op.width, op.a, op.b, op.c, op.d};
  const auto [found, is_new] = made_.try_emplace(key, block_->ops.size());
  if (!is_new) {
    LaneOp& made = block_->ops[found->second];
    made.is_free = made.is_free && op.is_free;
    return made.result;
  }
  const Row result = draft_.add_row(DraftRow::Kind::value);
  add(op);
  block_->ops.back().result = result;
  return result;
}

void Decoder::add(const LaneOp& op) {
  count_op();
  block_->ops.push_back(op);
}

void Decoder::count_op() {
  if (++ops_ > kMostLaneOps)
    throw ShaderError("the shader has more than " + std::to_string(kMostLaneOps) + " lane operations");
}

void Decoder::emit_copy(Row to, Row from) { add({.code = LaneCode::copy, .keeps = true, .result = to, .a = from}); }

const ShaderType& Decoder::scalar_of(std::uint32_t type) const {
  const ShaderType* scalar = &module_.type(type);
  while (scalar->kind == Kind::vector || scalar->kind == Kind::matrix) scalar = &module_.type(scalar->element);
  if (!scalar->is_scalar()) throw ShaderError("expected numbers or booleans, found another type");
  if (scalar->width > 32 || (scalar->kind == Kind::number && scalar->width < 16))
    throw ShaderError("numbers of " + std::to_string(scalar->width) + " bits are not supported");
  return *scalar;
}

Row Decoder::float_op(std::uint32_t width, LaneCode code, Row a, Row b) {
  if (width == 16 && code == LaneCode::inverse_sqrt)  // rounded twice, as Mesa does; SPIR-V allows two units
    return float_op(width, LaneCode::f_div, this->number(1), float_op(width, LaneCode::sqrt, a, kNoRow));
  const Row result = emit(code, a, b);
  if (width == 32) return result;
  switch (code) {  // of 16-bit floats, these are 16-bit floats
    case LaneCode::f_negate:
    case LaneCode::f_abs:
    case LaneCode::f_sign:
    case LaneCode::f_min:
    case LaneCode::f_max:
    case LaneCode::floor:
    case LaneCode::ceil:
    case LaneCode::trunc:
    case LaneCode::round_even:
      return result;
    default:
      return emit_free(LaneCode::to_half, result);
  }
}

Row Decoder::widened(std::uint32_t width, Row row) {
  if (width == 32) return row;
  return emit_free(width == 8 ? LaneCode::sign_extend_8 : LaneCode::sign_extend_16, row);
}

Row Decoder::narrowed(std::uint32_t width, Row row) {
  if (width == 32) return row;
  return emit_free(LaneCode::bit_and, row, constant((1u << width) - 1));
}

Row Decoder::integer_op(std::uint32_t width, LaneCode code, Row a, Row b) {
  switch (code) {
    case LaneCode::s_div:
    case LaneCode::s_mod:
    case LaneCode::s_rem:
    case LaneCode::s_abs:
    case LaneCode::s_sign:
    case LaneCode::s_min:
    case LaneCode::s_max:
    case LaneCode::s_less:
    case LaneCode::s_less_equal:
      a = widened(width, a);
      b = b == kNoRow ? b : widened(width, b);
      break;
    case LaneCode::shift_right_signed:
      a = widened(width, a);
      break;
    default:
      break;
  }
  const Row result = emit(code, a, b);
  const bool is_condition = code >= LaneCode::i_equal && code <= LaneCode::s_less_equal;
  return is_condition ? result : narrowed(width, result);
}

// A cast and the cast back are the row that was there at first.
Row Decoder::half_bits(Row row) {
  if (draft_.rows[row].kind == DraftRow::Kind::constant)
    return constant(half_of(std::bit_cast<float>(draft_.rows[row].bits)));
  if (const auto found = uncast_.find(row); found != uncast_.end()) return found->second;
  const Row bits = emit({.code = LaneCode::half_bits, .a = row});
  uncast_[bits] = row;
  return bits;
}

Row Decoder::half_value(Row row) {
  if (draft_.rows[row].kind == DraftRow::Kind::constant)
    return number(beampipe::half_value(static_cast<std::uint16_t>(draft_.rows[row].bits)));
  if (const auto found = uncast_.find(row); found != uncast_.end()) return found->second;
  const Row value = emit({.code = LaneCode::half_value, .a = row});
  uncast_[value] = row;
  return value;
}

std::uint32_t Decoder::parts_of(std::uint32_t type) const {
  const std::uint32_t count = module_.type(type).parts;
  if (count == 0) throw ShaderError("expected numbers or booleans, found another type");
  if (count > kMostMemoryRows)
    throw ShaderError("a value of more than " + std::to_string(kMostMemoryRows) + " numbers is not supported");
  return count;
}

void Decoder::require_room(std::uint32_t type) {
  const std::uint32_t count = module_.type(type).parts;
  if (count > 0) all_parts_ += parts_of(type);  // pointers and images have none
  if (all_parts_ > kMostParts)
    throw ShaderError("the shader's values have more than " + std::to_string(kMostParts) + " parts");
}

Parts Decoder::zeros(std::uint32_t type) { return Parts(std::vector<Row>(parts_of(type), constant(0))); }

const Parts& Decoder::parts(std::uint32_t id) {
  Value& value = values_[id];
  if (!value.parts) define_constant(module_.definition(id));
  if (!value.parts) throw ShaderError("expected a number, found " + name_of(module_.definition(id).op));
  return *value.parts;
}

void Decoder::define_constant(const Instruction& instruction) {
  if (instruction.type != 0) require_room(instruction.type);
  switch (instruction.op) {
    case spv::OpConstantTrue:
      return define(instruction, {constant(~0u)});
    case spv::OpConstantFalse:
      return define(instruction, {constant(0)});
    case spv::OpConstant: {
      const ShaderType& type = scalar_of(instruction.type);
      const std::uint32_t word = instruction.operands[0];
      if (type.kind == Kind::number)
        return define(instruction, {type.width == 16 ? half_value(constant(word & 0xffffu)) : constant(word)});
      return define(instruction, {constant(type.width == 32 ? word : word & ((1u << type.width) - 1))});
    }
    case spv::OpConstantNull:
    case spv::OpUndef:
      return define(instruction, zeros(instruction.type));
    case spv::OpConstantComposite: {
      Parts all;
      for (const std::uint32_t operand : instruction.operands) all.append(Parts(parts(operand)));
      return define(instruction, std::move(all));
    }
    default:
      return;
  }
}

Parts Decoder::cast_bits(std::uint32_t to_type, std::uint32_t from_type, const Parts& from) {
  const ShaderType &to = scalar_of(to_type), &source = scalar_of(from_type);
  Parts bits;
  const auto is_half = [](const ShaderType& type) { return type.kind == Kind::number && type.width == 16; };
  for (const Row row : from) bits.push_back(is_half(source) && !is_half(to) ? half_bits(row) : row);
  Parts result;
  if (to.width == source.width) {
    for (const Row row : bits) result.push_back(is_half(to) && !is_half(source) ? half_value(row) : row);
    return result;
  }
  if (is_half(source) && is_half(to)) throw ShaderError("OpBitcast to another number of 16-bit floats");
  if (to.width > source.width) {  // several become one, the first one lowest
    const std::uint32_t count = to.width / source.width;
    for (std::size_t i = 0; i + count <= bits.size(); i += count) {
      Row word = bits[i];
      for (std::uint32_t j = 1; j < count; ++j)
        word =
            emit_free(LaneCode::bit_or, word, emit_free(LaneCode::shift_left, bits[i + j], constant(j * source.width)));
      result.push_back(is_half(to) ? half_value(word) : word);
    }
    return result;
  }
  for (const Row row : bits)
    for (std::uint32_t j = 0; j < source.width / to.width; ++j) {
      const Row piece = narrowed(to.width, emit_free(LaneCode::shift_right, row, constant(j * to.width)));
      result.push_back(is_half(to) ? half_value(piece) : piece);
    }
  return result;
}

}  // namespace beampipe

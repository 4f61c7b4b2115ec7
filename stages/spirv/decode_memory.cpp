#include <algorithm>
#include <string>

#include "stages/spirv/decode.h"
#include "stages/spirv/decoder.h"

namespace beampipe {
namespace {

using Space = ShaderPointer::Space;

Interpolation interpolation_of(const ShaderModule& module, std::uint32_t id, std::uint32_t member) {
  if (module.decoration(id, spv::DecorationFlat, member)) return Interpolation::flat;
  return module.decoration(id, spv::DecorationNoPerspective, member) ? Interpolation::linear
                                                                     : Interpolation::perspective;
}

}  // namespace

// Rows of one variable, or of one member of one, from next.location and next.component on.
void Decoder::add_interface_rows(std::uint32_t type_id, InterfaceRow& next, std::vector<InterfaceRow>& rows) {
  const ShaderType& type = module_.type(type_id);
  const bool is_built_in = next.built_in != spv::BuiltInMax;
  if (type.is_scalar()) {
    next.is_float = scalar_of(type_id).kind == Kind::number;
    rows.push_back(next);
    ++next.component;
    return;
  }
  const std::uint32_t first = next.component;
  const std::size_t count = type.kind == Kind::structure ? type.members.size() : type.count;
  for (std::size_t i = 0; i < count; ++i) {
    add_interface_rows(type.kind == Kind::structure ? type.members[i] : type.element, next, rows);
    if (type.kind == Kind::vector || is_built_in) continue;
    const ShaderType& element = module_.type(type.kind == Kind::structure ? type.members[i] : type.element);
    if (element.is_scalar() || element.kind == Kind::vector) ++next.location;
    next.component = first;
  }
}

void Decoder::define_interface(const Instruction& instruction, std::uint32_t type_id, bool is_input) {
  const ShaderType& type = module_.type(type_id);
  std::vector<InterfaceRow> rows;
  const auto add = [&](std::uint32_t id, std::uint32_t member, std::uint32_t part_type, std::uint32_t location) {
    InterfaceRow next;
    next.interpolation = interpolation_of(module_, id, member);
    next.at_centroid = module_.decoration(id, spv::DecorationCentroid, member).has_value();
    next.at_sample = module_.decoration(id, spv::DecorationSample, member).has_value();
    next.index = module_.decoration(id, spv::DecorationIndex, member).value_or(0);
    next.component = module_.decoration(id, spv::DecorationComponent, member).value_or(0);
    if (const auto built_in = module_.decoration(id, spv::DecorationBuiltIn, member)) {
      next.built_in = static_cast<spv::BuiltIn>(*built_in);
    } else {
      next.location = module_.decoration(id, spv::DecorationLocation, member).value_or(location);
      if (next.location == kNoRow)
        throw ShaderError("an input or output has neither a location nor a built-in meaning");
    }
    add_interface_rows(part_type, next, rows);
    return next.location;
  };
  parts_of(type_id);
  std::uint32_t location = module_.decoration(instruction.result, spv::DecorationLocation).value_or(kNoRow);
  if (type.kind == Kind::structure) {
    for (std::uint32_t i = 0; i < type.members.size(); ++i) {
      location = add(instruction.type == 0 ? 0 : module_.type(instruction.type).element, i, type.members[i], location);
      const ShaderType& member = module_.type(type.members[i]);
      if (location != kNoRow && (member.is_scalar() || member.kind == Kind::vector)) ++location;
    }
  } else {
    add(instruction.result, ShaderModule::kWhole, type_id, location);
  }

  auto& interface = is_input ? draft_.program.inputs : draft_.program.outputs;
  if (interface.size() + rows.size() > kMostMemoryRows) throw ShaderError("the shader has too many inputs or outputs");
  ShaderPointer pointer{.variable = instruction.result, .type = type_id};
  if (is_input && rows.size() == 1 && rows[0].built_in == spv::BuiltInHelperInvocation) {
    pointer.first_row = kHelperRow, pointer.rows = 1;
  } else {
    pointer.rows = static_cast<std::uint32_t>(rows.size());
    for (InterfaceRow& row : rows) row.row = draft_.add_row(is_input ? DraftRow::Kind::input : DraftRow::Kind::memory);
    pointer.first_row = rows[0].row;
    interface.insert(interface.end(), rows.begin(), rows.end());
  }
  values_[instruction.result].pointer = pointer;
}

void Decoder::define_variable(const Instruction& instruction) {
  const ShaderType& pointer_type = module_.type(instruction.type);
  const std::uint32_t type_id = pointer_type.element;
  switch (pointer_type.storage) {
    case spv::StorageClassInput:
    case spv::StorageClassOutput:
      define_interface(instruction, type_id, pointer_type.storage == spv::StorageClassInput);
      break;
    case spv::StorageClassFunction:
    case spv::StorageClassPrivate: {
      ShaderPointer pointer{.variable = instruction.result, .type = type_id, .rows = parts_of(type_id)};
      pointer.first_row = static_cast<Row>(draft_.rows.size());
      draft_.program.memory_rows += pointer.rows;
      if (draft_.program.memory_rows > kMostMemoryRows) throw ShaderError("the shader has too many local variables");
      for (std::uint32_t i = 0; i < pointer.rows; ++i) draft_.add_row(DraftRow::Kind::memory);
      values_[instruction.result].pointer = pointer;
      break;
    }
    case spv::StorageClassUniform:
    case spv::StorageClassStorageBuffer:
    case spv::StorageClassPushConstant: {
      ShaderPointer pointer{.space = Space::bytes, .variable = instruction.result, .type = type_id};
      if (module_.type(type_id).kind != Kind::array) pointer.element = 0;
      values_[instruction.result].pointer = pointer;
      return;
    }
    case spv::StorageClassUniformConstant:
      return define_image_variable(instruction, type_id);
    default:
      throw ShaderError("variables of storage class " + std::to_string(static_cast<unsigned>(pointer_type.storage)) +
                        " are not supported");
  }
  if (instruction.operands.size() > 1)
    store(*values_[instruction.result].pointer, Parts(parts(instruction.operands[1])));
}

const ShaderPointer& Decoder::pointer(std::uint32_t id) const {
  if (!values_[id].pointer)
    throw ShaderError("expected a variable or an access chain, found " + name_of(module_.definition(id).op));
  return *values_[id].pointer;
}

// Moves the pointer by `stride` for each element. An index of at least `count` (unless that is 0) is an error where it
// is a constant; where it is not, the loads and stores themselves check what they may reach.
void Decoder::add_index(ShaderPointer& pointer, std::uint32_t index_id, std::uint32_t stride, std::uint32_t count) {
  const std::uint32_t width = scalar_of(module_.definition(index_id).type).width;
  const Row index = part(index_id);
  if (const DraftRow row = draft_.rows[index]; row.kind == DraftRow::Kind::constant) {
    const std::uint64_t offset = pointer.offset + std::uint64_t{row.bits} * stride;
    if ((count != 0 && row.bits >= count) || offset > 0x7fffffffu)
      throw ShaderError("an access chain has the index " + std::to_string(row.bits) + ", which is outside its array");
    pointer.offset = static_cast<std::uint32_t>(offset);
    return;
  }
  const Row wide = widened(width, index);
  const Row scaled = stride == 1 ? wide : emit(LaneCode::i_mul, wide, constant(stride));
  pointer.index = pointer.index == kNoRow ? scaled : emit(LaneCode::i_add, pointer.index, scaled);
}

ShaderPointer Decoder::step(ShaderPointer from, std::uint32_t index_id) {
  const std::uint32_t type_id = from.type;
  const ShaderType& type = module_.type(type_id);
  if (from.space == Space::images) {
    if (type.kind != Kind::array || from.image_element != kNoRow)
      throw ShaderError("an access chain goes into an image");
    from.image_element = part(index_id);
    from.type = type.element;
    return from;
  }
  if (from.space == Space::bytes && !from.element) {
    from.element = module_.constant_word(index_id);
    if (type.count != 0 && *from.element >= type.count) throw ShaderError("an array of buffers has no such element");
    from.type = type.element;
    return from;
  }
  if (type.kind == Kind::structure) {
    const std::uint32_t member = module_.constant_word(index_id);
    if (member >= type.members.size()) throw ShaderError("an access chain names a member that its structure lacks");
    from.type = type.members[member];
    if (from.space == Space::rows) {
      for (std::uint32_t i = 0; i < member; ++i) from.offset += module_.type(type.members[i]).parts;
      return from;
    }
    const auto offset = module_.decoration(type_id, spv::DecorationOffset, member);
    if (!offset || *offset > 0x7fffffffu - from.offset) throw ShaderError("a member of a buffer has no usable offset");
    from.offset += *offset;
    from.matrix_stride = module_.decoration(type_id, spv::DecorationMatrixStride, member).value_or(0);
    from.is_row_major = module_.decoration(type_id, spv::DecorationRowMajor, member).has_value();
    return from;
  }
  from.type = type.element;
  if (from.space == Space::rows) {
    add_index(from, index_id, module_.type(type.element).parts, type.count);
    return from;
  }
  const std::uint32_t bytes = type.kind == Kind::array ? 0 : scalar_of(type.element).width / 8;
  switch (type.kind) {
    case Kind::array:
      add_index(from, index_id, module_.decoration(type_id, spv::DecorationArrayStride).value_or(0), type.count);
      break;
    case Kind::matrix:
      add_index(from, index_id, from.is_row_major ? bytes : from.matrix_stride, type.count);
      from.vector_stride = from.is_row_major ? from.matrix_stride : 0;
      break;
    case Kind::vector:
      add_index(from, index_id, from.vector_stride == 0 ? bytes : from.vector_stride, type.count);
      break;
    default:
      throw ShaderError("an access chain goes into a number");
  }
  return from;
}

void Decoder::access_chain(const Instruction& instruction) {
  ShaderPointer found = pointer(instruction.operands[0]);
  for (const std::uint32_t index : instruction.operands.subspan(1)) found = step(std::move(found), index);
  values_[instruction.result].pointer = std::move(found);
}

std::uint32_t Decoder::buffer_of(const ShaderPointer& pointer) {
  if (!pointer.element) throw ShaderError("an array of buffers is read as a whole");
  const auto [found, is_new] = buffers_.try_emplace({pointer.variable, *pointer.element},
                                                    static_cast<std::uint32_t>(draft_.program.buffers.size()));
  if (is_new)
    draft_.program.buffers.push_back(
        {.set = module_.decoration(pointer.variable, spv::DecorationDescriptorSet).value_or(kNoRow),
         .binding = module_.decoration(pointer.variable, spv::DecorationBinding).value_or(kNoRow),
         .element = *pointer.element});
  return found->second;
}

void Decoder::load_bytes(const ShaderPointer& from, std::uint32_t buffer, Parts& parts) {
  const ShaderType& type = module_.type(from.type);
  if (type.is_scalar()) {
    const ShaderType& scalar = scalar_of(from.type);
    if (scalar.kind == Kind::boolean) throw ShaderError("a buffer holds booleans, which have no size");
    const Row bits = emit({.code = LaneCode::load_bytes,
                           .width = static_cast<std::uint8_t>(scalar.width / 8),
                           .a = from.index,
                           .c = buffer,
                           .d = from.offset});
    parts.push_back(scalar.kind == Kind::number && scalar.width == 16 ? half_value(bits) : bits);
    return;
  }
  const bool is_structure = type.kind == Kind::structure;
  const std::size_t count = is_structure ? type.members.size() : type.count;
  for (std::uint32_t i = 0; i < count; ++i) {
    ShaderPointer element = from;
    element.type = is_structure ? type.members[i] : type.element;
    std::uint64_t offset = from.offset;
    if (is_structure) {
      offset += module_.decoration(from.type, spv::DecorationOffset, i).value_or(0);
      element.matrix_stride = module_.decoration(from.type, spv::DecorationMatrixStride, i).value_or(0);
      element.is_row_major = module_.decoration(from.type, spv::DecorationRowMajor, i).has_value();
    } else if (type.kind == Kind::array) {
      offset += std::uint64_t{i} * module_.decoration(from.type, spv::DecorationArrayStride).value_or(0);
    } else if (type.kind == Kind::matrix) {
      const std::uint32_t bytes = scalar_of(type.element).width / 8;
      offset += std::uint64_t{i} * (from.is_row_major ? bytes : from.matrix_stride);
      element.vector_stride = from.is_row_major ? from.matrix_stride : 0;
    } else {
      offset += std::uint64_t{i} * (from.vector_stride == 0 ? scalar_of(type.element).width / 8 : from.vector_stride);
    }
    if (offset > 0x7fffffffu) throw ShaderError("a buffer's offsets are too large");
    element.offset = static_cast<std::uint32_t>(offset);
    load_bytes(element, buffer, parts);
  }
}

Parts Decoder::load(const ShaderPointer& from) {
  Parts loaded;
  const std::uint32_t count = parts_of(from.type);
  if (from.space == Space::images) throw ShaderError("an image is read as a number");
  if (from.space == Space::bytes) {
    load_bytes(from, buffer_of(from), loaded);
    return loaded;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t place = from.offset + i;
    if (place >= from.rows) throw ShaderError("an access chain leaves its variable");
    const Row row = from.first_row + place;
    if (from.index != kNoRow) {
      const Row index = place == 0 ? from.index : emit_free(LaneCode::i_add, from.index, constant(place));
      const Row result = draft_.add_row(DraftRow::Kind::value);
      add({.code = LaneCode::load_local, .result = result, .a = index, .c = from.first_row, .d = from.rows});
      loaded.push_back(result);
    } else if (draft_.rows[row].kind == DraftRow::Kind::input) {
      loaded.push_back(row);
    } else {  // the variable may change afterwards
      const Row result = draft_.add_row(DraftRow::Kind::value);
      add({.code = LaneCode::copy, .result = result, .a = row});
      loaded.push_back(result);
    }
  }
  return loaded;
}

void Decoder::store(const ShaderPointer& to, const Parts& from) {
  if (to.space != Space::rows || to.rows == 0 || draft_.rows[to.first_row].kind != DraftRow::Kind::memory)
    throw ShaderError("OpStore to a buffer is not supported");
  for (std::uint32_t i = 0; i < from.size(); ++i) {
    const std::uint32_t place = to.offset + i;
    if (place >= to.rows) throw ShaderError("an access chain leaves its variable");
    if (to.index == kNoRow) {
      emit_copy(to.first_row + place, from[i]);
      continue;
    }
    const Row index = place == 0 ? to.index : emit_free(LaneCode::i_add, to.index, constant(place));
    add({.code = LaneCode::store_local, .a = index, .b = from[i], .c = to.first_row, .d = to.rows});
  }
}

}  // namespace beampipe

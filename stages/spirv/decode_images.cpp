#include "stages/spirv/decoder.h"

namespace beampipe {
namespace {

using Code = LaneCode;

// How many numbers say where a texel is, without the layer of an array.
std::uint32_t dimensions_of(spv::Dim dim) {
  switch (dim) {
    case spv::Dim1D:
    case spv::DimBuffer:
      return 1;
    case spv::Dim2D:
    case spv::DimRect:
      return 2;
    case spv::Dim3D:
    case spv::DimCube:
      return 3;
    default:
      throw ShaderError("images of dimension " + std::to_string(static_cast<unsigned>(dim)) + " are not supported");
  }
}

}  // namespace

void Decoder::define_image_variable(const Instruction& instruction, std::uint32_t type_id) {
  values_[instruction.result].pointer =
      ShaderPointer{.space = ShaderPointer::Space::images, .variable = instruction.result, .type = type_id};
}

const ImageHandle& Decoder::handle(std::uint32_t id) const {
  if (!values_[id].handle)
    throw ShaderError("expected an image or a sampler, found " + name_of(module_.definition(id).op));
  return *values_[id].handle;
}

ImageHandle Decoder::load_handle(const ShaderPointer& from) {
  const ShaderType* type = &module_.type(from.type);
  const std::uint32_t variable_type = module_.type(module_.definition(from.variable).type).element;
  const ShaderType& variable = module_.type(variable_type);
  const std::uint32_t count = variable.kind == Kind::array ? variable.count : 1;
  const std::uint32_t set = module_.decoration(from.variable, spv::DecorationDescriptorSet).value_or(kNoRow),
                      binding = module_.decoration(from.variable, spv::DecorationBinding).value_or(kNoRow);
  ImageHandle found;
  if (type->kind == Kind::sampler) {
    const auto [slot, is_new] =
        slots_.try_emplace(from.variable, static_cast<std::uint32_t>(draft_.program.samplers.size()));
    if (is_new) draft_.program.samplers.push_back({.set = set, .binding = binding, .count = count});
    found.sampler = slot->second, found.sampler_element = from.image_element;
    return found;
  }
  const bool has_sampler = type->kind == Kind::sampled_image;
  found.type = has_sampler ? type->element : from.type;
  type = &module_.type(found.type);
  if (type->kind != Kind::image) throw ShaderError("expected an image or a sampler, found another type");
  if (type->storage_image) throw ShaderError("storage images are not supported");
  if (type->multisampled) throw ShaderError("images with several samples are not supported");
  const ShaderType& texel = module_.type(type->element);
  const auto [slot, is_new] =
      slots_.try_emplace(from.variable, static_cast<std::uint32_t>(draft_.program.images.size()));
  if (is_new) {
    // OpTypeInt's second operand says whether it is signed.
    const bool is_signed = texel.kind == Kind::integer && module_.definition(type->element).operands[1] == 1;
    draft_.program.images.push_back({.set = set,
                                     .binding = binding,
                                     .count = count,
                                     .dim = type->dim,
                                     .arrayed = type->arrayed,
                                     .depth = type->depth,
                                     .has_sampler = has_sampler,
                                     .texels = texel.kind == Kind::number ? TexelKind::floats
                                               : is_signed                ? TexelKind::signed_integers
                                                                          : TexelKind::unsigned_integers});
  }
  found.image = slot->second, found.image_element = from.image_element;
  return found;
}

void Decoder::read_image_operands(std::span<const std::uint32_t> operands, ImageOp& op, bool& has_slopes) {
  if (operands.empty()) return;
  const std::uint32_t mask = operands[0];
  std::size_t next = 1;
  const auto take = [&] {
    if (next >= operands.size()) throw ShaderError("an image instruction lacks operands");
    return Parts(parts(operands[next++]));
  };
  const auto take_all = [&](std::array<std::uint32_t, 3>& rows) {
    const Parts values = take();
    for (std::size_t i = 0; i < values.size() && i < rows.size(); ++i) rows[i] = values[i];
  };
  if (mask & spv::ImageOperandsBiasMask) op.bias = take()[0];
  if (mask & spv::ImageOperandsLodMask) op.lod = take()[0];
  if (mask & spv::ImageOperandsGradMask) {
    take_all(op.dx), take_all(op.dy);
    has_slopes = true;
  }
  if (mask & spv::ImageOperandsConstOffsetMask) take_all(op.offset);
  if (mask & spv::ImageOperandsOffsetMask) take_all(op.offset);
  if (mask & spv::ImageOperandsConstOffsetsMask) throw ShaderError("OpImageGather with ConstOffsets is not supported");
  if (mask & spv::ImageOperandsMinLodMask) op.least_lod = take()[0];
}

void Decoder::finish_image(const Instruction& instruction, ImageOp op, std::uint32_t results) {
  const ShaderType& type = scalar_of(instruction.type);
  const bool is_half = type.kind == Kind::number && type.width == 16;
  Parts rows;
  for (std::uint32_t i = 0; i < results && i < op.results.size(); ++i) {
    op.results[i] = draft_.add_row(DraftRow::Kind::value);
    rows.push_back(op.results[i]);
    texels_.insert(op.results[i]);
  }
  add({.code = Code::image, .c = static_cast<std::uint32_t>(draft_.image_ops.size())});
  draft_.image_ops.push_back(op);
  if (is_half) {
    Parts rounded;
    for (const Row row : rows) rounded.push_back(emit_free(Code::to_half, row));
    rows = rounded;
  }
  define(instruction, std::move(rows));
}

void Decoder::sample(const Instruction& instruction, ImageAction action, bool is_implicit, bool has_reference,
                     bool is_projected) {
  const std::span<const std::uint32_t> operands = instruction.operands;
  const ImageHandle& image = handle(operands[0]);
  if (image.type == 0) throw ShaderError("a sampler is read without an image");
  const ShaderType& type = module_.type(image.type);
  const Parts coordinates = parts(operands[1]);
  ImageOp op{.action = action,
             .image = image.image,
             .sampler = image.sampler,
             .image_element = image.image_element,
             .sampler_element = image.sampler_element};
  const std::uint32_t dimensions = dimensions_of(type.dim);
  std::size_t next = 2;
  Row scale = kNoRow;  // coordinates are divided by it
  if (is_projected) scale = coordinates[dimensions];
  const auto projected = [&](Row row) { return is_projected ? emit(Code::f_div, row, scale) : row; };
  for (std::uint32_t i = 0; i < dimensions; ++i) op.coordinates[i] = projected(coordinates[i]);
  if (type.arrayed && !is_projected) op.coordinates[dimensions] = coordinates[dimensions];
  if (has_reference) op.reference = projected(part(operands[next++]));
  if (action == ImageAction::gather && !has_reference) {
    const Row component = part(operands[next++]);
    if (draft_.rows[component].kind != DraftRow::Kind::constant)
      throw ShaderError("OpImageGather expects a constant component");
    op.component = draft_.rows[component].bits & 3u;
  }
  bool has_slopes = false;
  read_image_operands(operands.subspan(next), op, has_slopes);
  if (is_implicit && action != ImageAction::gather) {
    draft_.program.takes_differences = true;
    for (std::uint32_t i = 0; i < dimensions; ++i) {  // the texture unit subtracts once for a quad
      op.dx[i] = emit_free(Code::dx_coarse, op.coordinates[i]);
      op.dy[i] = emit_free(Code::dy_coarse, op.coordinates[i]);
    }
  }
  const std::uint32_t results = action == ImageAction::query_lod                 ? 2
                                : has_reference && action == ImageAction::sample ? 1
                                                                                 : 4;
  finish_image(instruction, op, results);
}

void Decoder::query(const Instruction& instruction, ImageAction action) {
  const ImageHandle& image = handle(instruction.operands[0]);
  if (image.type == 0) throw ShaderError("a sampler is read without an image");
  ImageOp op{.action = action, .image = image.image, .image_element = image.image_element};
  if (instruction.op == spv::OpImageQuerySizeLod) op.lod = part(instruction.operands[1]);
  if (action == ImageAction::fetch) {
    const Parts coordinates = parts(instruction.operands[1]);
    for (std::size_t i = 0; i < coordinates.size() && i < op.coordinates.size(); ++i)
      op.coordinates[i] = coordinates[i];
    bool has_slopes = false;
    read_image_operands(instruction.operands.subspan(2), op, has_slopes);
  }
  finish_image(instruction, op, parts_of(instruction.type));
}

bool Decoder::decode_image(const Instruction& instruction) {
  using Action = ImageAction;
  switch (instruction.op) {
    case spv::OpSampledImage: {
      ImageHandle both = handle(instruction.operands[0]);
      const ImageHandle& sampler = handle(instruction.operands[1]);
      both.sampler = sampler.sampler, both.sampler_element = sampler.sampler_element;
      values_[instruction.result].handle = both;
      return true;
    }
    case spv::OpImage:
      values_[instruction.result].handle = handle(instruction.operands[0]);
      return true;
    case spv::OpImageSampleImplicitLod:
      sample(instruction, Action::sample, true, false, false);
      return true;
    case spv::OpImageSampleExplicitLod:
      sample(instruction, Action::sample, false, false, false);
      return true;
    case spv::OpImageSampleDrefImplicitLod:
      sample(instruction, Action::sample, true, true, false);
      return true;
    case spv::OpImageSampleDrefExplicitLod:
      sample(instruction, Action::sample, false, true, false);
      return true;
    case spv::OpImageSampleProjImplicitLod:
      sample(instruction, Action::sample, true, false, true);
      return true;
    case spv::OpImageSampleProjExplicitLod:
      sample(instruction, Action::sample, false, false, true);
      return true;
    case spv::OpImageSampleProjDrefImplicitLod:
      sample(instruction, Action::sample, true, true, true);
      return true;
    case spv::OpImageSampleProjDrefExplicitLod:
      sample(instruction, Action::sample, false, true, true);
      return true;
    case spv::OpImageGather:
      sample(instruction, Action::gather, false, false, false);
      return true;
    case spv::OpImageDrefGather:
      sample(instruction, Action::gather, false, true, false);
      return true;
    case spv::OpImageQueryLod:
      sample(instruction, Action::query_lod, true, false, false);
      return true;
    case spv::OpImageFetch:
      query(instruction, Action::fetch);
      return true;
    case spv::OpImageQuerySizeLod:
    case spv::OpImageQuerySize:
      query(instruction, Action::query_size);
      return true;
    case spv::OpImageQueryLevels:
      query(instruction, Action::query_levels);
      return true;
    default:
      return false;
  }
}

}  // namespace beampipe

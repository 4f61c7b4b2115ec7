// Loads any words as a fragment shader, and runs it on numbers of all kinds and on images of all shapes. They give an
// error of one line, or a shader that ends and gives a lane the same alone as among others.
//
// Nearly every change of a byte makes a module that is refused at once, so most changes are those of an instruction.
#define SPV_ENABLE_UTILITY_CODE
#include <random>
#include <spirv/unified1/spirv.hpp>

#include "stages/spirv/fragment_shader.h"
#include "stages/spirv/shader_executor.h"
#include "stages/surface/program_images.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace beampipe {
namespace {

constexpr std::size_t kHeaderWords = 5, kBoundWord = 3;
constexpr std::size_t kLanes = 16;
constexpr std::uint64_t kActive = 0x013f, kHelpers = 0x0010;  // few, as each may go its own way

std::vector<std::uint32_t> words_of(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint32_t> words(size / sizeof(std::uint32_t));
  std::copy_n(data, words.size() * sizeof(std::uint32_t), reinterpret_cast<std::uint8_t*>(words.data()));
  return words;
}

// Where instructions begin, as far as they can be told apart.
std::vector<std::size_t> instructions_of(const std::vector<std::uint32_t>& words) {
  std::vector<std::size_t> starts;
  for (std::size_t at = kHeaderWords; at < words.size() && words[at] >> 16 != 0; at += words[at] >> 16)
    if (at + (words[at] >> 16) <= words.size()) starts.push_back(at);
  return starts;
}

// Changes one instruction: its opcode, an operand, its place, or how often it is there.
void change_instruction(std::vector<std::uint32_t>& words, std::mt19937& random) {
  const std::vector<std::size_t> starts = instructions_of(words);
  if (starts.empty()) return;
  const auto any = [&random](std::size_t count) { return std::size_t{random()} % count; };
  const auto any_start = [&] { return starts[any(starts.size())]; };
  const std::size_t at = any_start(), other = any_start();
  const std::size_t count = words[at] >> 16, other_count = words[other] >> 16;
  const auto place = [&words](std::size_t i) { return words.begin() + static_cast<std::ptrdiff_t>(i); };
  switch (any(6)) {
    case 0:  // another opcode, for as many operands
      if (count == other_count) words[at] = words[other];
      break;
    case 1:
      if (count > 1) words[at + 1 + any(count - 1)] = static_cast<std::uint32_t>(1 + any(words[kBoundWord] | 1));
      break;
    case 2:
      if (count > 1) words[at + 1 + any(count - 1)] = words[kHeaderWords + any(words.size() - kHeaderWords)];
      break;
    case 3:
      words.erase(place(at), place(at + count));
      break;
    case 4:
      if (at + count < words.size()) std::rotate(place(at), place(at + count), words.end());
      break;
    default: {  // a copy whose result is a new value
      std::vector<std::uint32_t> copy(place(at), place(at + count));
      bool has_result = false, has_type = false;
      spv::HasResultAndType(static_cast<spv::Op>(copy[0] & 0xffffu), &has_result, &has_type);
      const std::size_t result = has_type ? 2 : 1;
      if (has_result && result < copy.size()) copy[result] = words[kBoundWord]++;
      words.insert(place(other), copy.begin(), copy.end());
    }
  }
}

// One image of each shape and kind of texels, with two more levels, and samplers of all kinds.
struct FuzzImages {
  std::vector<ProgramImage> images;
  std::vector<ProgramSampler> samplers{
      {.wrap = {SamplerWrap::mirror, SamplerWrap::repeat, SamplerWrap::clamp_to_edge}, .anisotropy = 4},
      {.mag = Filter::nearest,
       .mip = Filter::nearest,
       .wrap = {SamplerWrap::clamp_to_border, SamplerWrap::mirror_clamp}},
      {.least_lod = 0.5f, .most_lod = 1.5f, .compare = Compare::less}};

  FuzzImages() {
    for (const ImageShape shape : {ImageShape::d1, ImageShape::d2, ImageShape::d3, ImageShape::cube})
      for (const TexelFormat format :
           {TexelFormat::R8G8B8A8_SRGB, TexelFormat::R32G32B32A32_SINT, TexelFormat::R32G32B32A32_UINT}) {
        ProgramImage& image = images.emplace_back();
        image.shape = shape, image.format = format, image.width = 5;
        image.height = shape == ImageShape::d1 ? 1 : shape == ImageShape::cube ? 5 : 3;
        image.depth = shape == ImageShape::d3 ? 4 : 1;
        image.layers = shape == ImageShape::cube ? 6 : shape == ImageShape::d3 ? 1 : 2;
        image.levels = 3;
        for (std::uint64_t i = 0; i < level_start(image, image.levels); ++i)
          image.texels.push_back(static_cast<std::uint8_t>(37 * i));
      }
  }

  BoundImages bind(const LaneProgram& program) const {
    std::vector<BoundImage> bound;
    const auto sampler = [&] { return static_cast<std::uint32_t>(bound.size() % samplers.size()); };
    for (const ImageSlot& slot : program.images) {
      const std::uint32_t shape = slot.dim == spv::Dim1D || slot.dim == spv::DimBuffer ? 0
                                  : slot.dim == spv::Dim3D                             ? 2
                                  : slot.dim == spv::DimCube                           ? 3
                                                                                       : 1;
      bound.push_back({.set = slot.set,
                       .binding = slot.binding,
                       .element = slot.count > 1 ? 1u : 0u,
                       .image = 3 * shape + static_cast<std::uint32_t>(slot.texels),
                       .sampler = sampler()});
    }
    for (const SamplerSlot& slot : program.samplers)
      bound.push_back({.set = slot.set, .binding = slot.binding, .sampler = sampler()});
    return bound_images(program, bound, images, samplers);
  }
};

// Special numbers, everyday ones, and any bits.
std::uint32_t any_bits(std::mt19937& random) {
  constexpr std::uint32_t kSpecial[] = {0,           0x80000000u, 0x3f800000u, 0xbf800000u, 0x7f800000u, 0x7fc00000u,
                                        0xffffffffu, 1,           0x7fffffffu, 0x3f000000u, 0x40490fdbu, 0x4b800000u};
  switch (random() % 3) {
    case 0:
      return kSpecial[random() % std::size(kSpecial)];
    case 1:
      return 0x3e800000u + static_cast<std::uint32_t>(random() % 0x02000000u);  // 0.25..4
    default:
      return static_cast<std::uint32_t>(random());
  }
}

// Outputs of all lanes, row by row; those that nobody keeps are 0.
std::vector<std::uint32_t> outputs_of(const LaneProgram& program, const ShaderExecutor& executor) {
  std::vector<std::uint32_t> bits;
  for (const InterfaceRow& output : program.outputs)
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      bits.push_back(executor.kept() >> lane & 1 ? executor.row(output.row).bits[lane] : 0);
  return bits;
}

void run(const LaneProgram& program) {
  static const FuzzImages fuzz_images;
  const BoundImages bound = fuzz_images.bind(program);
  ProgramImages images(program, bound);
  std::mt19937 random(1);
  std::vector<std::byte> bytes(100);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  ShaderResources resources;
  for (std::size_t i = 0; i < program.buffers.size(); ++i)
    resources.buffers.push_back(std::span(bytes).first(i % 3 == 2 ? 7 : bytes.size()));
  resources.images = &images;

  ShaderExecutor executor(program);
  for (const InterfaceRow& input : program.inputs)
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane) executor.row(input.row).bits[lane] = any_bits(random);
  ShaderCounts counts;
  executor.run(resources, kLanes, kActive, kHelpers, counts);
  if (program.takes_differences) return;
  const std::uint64_t kept = executor.kept();
  const std::vector<std::uint32_t> together = outputs_of(program, executor);
  constexpr std::size_t kAlone = 5;
  executor.run(resources, kLanes, std::uint64_t{1} << kAlone, 0, counts);
  require(executor.kept() == (kept & std::uint64_t{1} << kAlone));
  const std::vector<std::uint32_t> alone = outputs_of(program, executor);
  for (std::size_t i = kAlone; i < alone.size(); i += kLanes) require(alone[i] == together[i]);
}

}  // namespace
}  // namespace beampipe

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  std::mt19937 random(seed);
  if (random() % 8 == 0) return LLVMFuzzerMutate(data, size, max_size);
  std::vector<std::uint32_t> words = beampipe::words_of(data, size);
  if (words.size() <= beampipe::kHeaderWords) return LLVMFuzzerMutate(data, size, max_size);
  for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) beampipe::change_instruction(words, random);
  const std::size_t bytes = words.size() * sizeof(std::uint32_t);
  if (bytes > max_size) return size;
  std::copy_n(reinterpret_cast<const std::uint8_t*>(words.data()), bytes, data);
  return bytes;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  try {
    run(load_fragment_shader(words_of(data, size)));
  } catch (const ShaderError& error) {
    require_one_line(error.what());
  }
  return 0;
}

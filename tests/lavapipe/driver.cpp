#include "tests/lavapipe/driver.h"

#include <vulkan/vulkan.h>

#include <spirv-tools/libspirv.hpp>

#include "stages/spirv/module.h"
#include "tests/test.h"

namespace beampipe {
namespace {

// A channel that no shader of the tests writes.
constexpr std::uint32_t kNotWritten = 0x7b3c614eu;

void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string(what) + ": VkResult " + std::to_string(result));
}

// The name of its enumerator, which VkFormat has too.
VkFormat format_of(TexelFormat format) {
#define BEAMPIPE_SAME_NAME(name) \
  case TexelFormat::name:        \
    return VK_FORMAT_##name;
  switch (format) {
    BEAMPIPE_SAME_NAME(R8_UNORM)
    BEAMPIPE_SAME_NAME(R8G8_UNORM)
    BEAMPIPE_SAME_NAME(R8G8B8A8_UNORM)
    BEAMPIPE_SAME_NAME(R8G8B8A8_SRGB)
    BEAMPIPE_SAME_NAME(B8G8R8A8_UNORM)
    BEAMPIPE_SAME_NAME(B8G8R8A8_SRGB)
    BEAMPIPE_SAME_NAME(R16_SFLOAT)
    BEAMPIPE_SAME_NAME(R16G16_SFLOAT)
    BEAMPIPE_SAME_NAME(R16G16B16A16_SFLOAT)
    BEAMPIPE_SAME_NAME(R16G16B16A16_UNORM)
    BEAMPIPE_SAME_NAME(R32_SFLOAT)
    BEAMPIPE_SAME_NAME(R32G32B32A32_SFLOAT)
    BEAMPIPE_SAME_NAME(R32G32B32A32_UINT)
    BEAMPIPE_SAME_NAME(R32G32B32A32_SINT)
    BEAMPIPE_SAME_NAME(D32_SFLOAT)
  }
#undef BEAMPIPE_SAME_NAME
  return VK_FORMAT_UNDEFINED;
}

VkSamplerAddressMode address_mode_of(SamplerWrap wrap) {
  switch (wrap) {
    case SamplerWrap::repeat:
      return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    case SamplerWrap::mirror:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case SamplerWrap::clamp_to_edge:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    case SamplerWrap::clamp_to_border:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER;
    case SamplerWrap::mirror_clamp:
      return VK_SAMPLER_ADDRESS_MODE_MIRROR_CLAMP_TO_EDGE;
  }
  return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

VkComponentSwizzle swizzle_of(char letter) {
  switch (letter) {
    case 'r':
      return VK_COMPONENT_SWIZZLE_R;
    case 'g':
      return VK_COMPONENT_SWIZZLE_G;
    case 'b':
      return VK_COMPONENT_SWIZZLE_B;
    case 'a':
      return VK_COMPONENT_SWIZZLE_A;
    case '1':
      return VK_COMPONENT_SWIZZLE_ONE;
    default:
      return VK_COMPONENT_SWIZZLE_ZERO;
  }
}

// What the module declares at a set and a binding.
struct Slot {
  VkDescriptorType type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  std::uint32_t count = 1;
  spv::Dim dim = spv::Dim2D;
  bool is_arrayed = false, is_depth = false;
  TexelFormat format = TexelFormat::R8G8B8A8_UNORM;  // of an image that the case lacks
};
using Slots = std::map<std::pair<std::uint32_t, std::uint32_t>, Slot>;

Slots slots_of(const ShaderModule& module) {
  using Kind = ShaderType::Kind;
  Slots slots;
  for (const Instruction& instruction : module.globals()) {
    if (instruction.op != spv::OpVariable) continue;
    const auto set = module.decoration(instruction.result, spv::DecorationDescriptorSet),
               binding = module.decoration(instruction.result, spv::DecorationBinding);
    if (!set || !binding) continue;
    const ShaderType& pointer = module.type(instruction.type);
    Slot slot;
    std::uint32_t id = pointer.element;
    if (module.type(id).kind == Kind::array)
      slot.count = std::max(module.type(id).count, 1u), id = module.type(id).element;
    const bool has_sampler = module.type(id).kind == Kind::sampled_image;
    if (has_sampler) id = module.type(id).element;
    const ShaderType& type = module.type(id);
    if (type.kind == Kind::image) {
      const ShaderType& texel = module.type(type.element);
      slot.dim = type.dim, slot.is_arrayed = type.arrayed, slot.is_depth = type.depth;
      slot.type = type.dim == spv::DimBuffer ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                  : has_sampler              ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                             : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
      if (texel.kind == Kind::integer)
        slot.format = module.definition(type.element).operands[1] == 1 ? TexelFormat::R32G32B32A32_SINT
                                                                       : TexelFormat::R32G32B32A32_UINT;
    } else if (type.kind == Kind::sampler) {
      slot.type = VK_DESCRIPTOR_TYPE_SAMPLER;
    } else if (pointer.storage == spv::StorageClassStorageBuffer || module.decoration(id, spv::DecorationBufferBlock)) {
      slot.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    }
    slots[{*set, *binding}] = slot;
  }
  return slots;
}

// Passes attributes on: the position at location 0, and each input at the one after its own.
std::vector<std::uint32_t> vertex_shader(const std::map<std::uint32_t, CaseInput>& inputs) {
  std::string interface, decorations, variables, body;
  for (const auto& [location, input] : inputs) {
    const std::string n = std::to_string(location), type = input.is_integer ? "u4" : "v4";
    interface += " %in" + n + " %out" + n;
    decorations += "OpDecorate %in" + n + " Location " + std::to_string(location + 1) + "\nOpDecorate %out" + n +
                   " Location " + n + "\n";
    if (input.is_integer) decorations += "OpDecorate %out" + n + " Flat\n";
    variables +=
        "%in" + n + " = OpVariable %in_" + type + " Input\n%out" + n + " = OpVariable %out_" + type + " Output\n";
    body += "%value" + n + " = OpLoad %" + type + " %in" + n + "\nOpStore %out" + n + " %value" + n + "\n";
  }
  const std::string text = R"(
OpCapability Shader
OpMemoryModel Logical GLSL450
OpEntryPoint Vertex %main "main" %from %position %size )" +
                           interface + R"(
OpDecorate %from Location 0
OpDecorate %position BuiltIn Position
OpDecorate %size BuiltIn PointSize
)" + decorations + R"(
%void = OpTypeVoid
%action = OpTypeFunction %void
%float = OpTypeFloat 32
%uint = OpTypeInt 32 0
%v4 = OpTypeVector %float 4
%u4 = OpTypeVector %uint 4
%f1 = OpConstant %float 1
%in_v4 = OpTypePointer Input %v4
%in_u4 = OpTypePointer Input %u4
%out_v4 = OpTypePointer Output %v4
%out_u4 = OpTypePointer Output %u4
%out_float = OpTypePointer Output %float
%from = OpVariable %in_v4 Input
%position = OpVariable %out_v4 Output
%size = OpVariable %out_float Output
)" + variables + R"(
%main = OpFunction %void None %action
%entry = OpLabel
%place = OpLoad %v4 %from
OpStore %position %place
OpStore %size %f1
)" + body + "OpReturn\nOpFunctionEnd\n";
  std::vector<std::uint32_t> words;
  if (!spvtools::SpirvTools(SPV_ENV_UNIVERSAL_1_3).Assemble(text, &words))
    throw std::logic_error("the vertex shader is not SPIR-V: " + text);
  return words;
}

std::vector<std::array<float, 4>> positions_of(const ShaderCase& shader) {
  if (shader.is_triangle) return {{-1, -1, kDepth, 1}, {3, -1, kDepth, 1}, {-1, 3, kDepth, 1}};
  std::vector<std::array<float, 4>> positions;
  const auto middle = [](std::size_t pixel) {
    return (static_cast<float>(pixel) + 0.5f) * (2.0f / static_cast<float>(kSide)) - 1.0f;
  };
  for (std::size_t i = 0; i < kPixels; ++i) positions.push_back({middle(i % kSide), middle(i / kSide), kDepth, 1});
  return positions;
}

class LavapipeDriver : public Driver {
 public:
  LavapipeDriver(VkInstance instance, VkPhysicalDevice physical) : instance_(instance), physical_(physical) {
    constexpr float kPriority = 1;
    const VkDeviceQueueCreateInfo queue{
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &kPriority};
    // All features that it has.
    VkPhysicalDeviceCustomBorderColorFeaturesEXT border{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_CUSTOM_BORDER_COLOR_FEATURES_EXT};
    VkPhysicalDeviceVulkan13Features in_13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                           .pNext = &border};
    VkPhysicalDeviceVulkan12Features in_12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                           .pNext = &in_13};
    VkPhysicalDeviceVulkan11Features in_11{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES,
                                           .pNext = &in_12};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &in_11};
    vkGetPhysicalDeviceFeatures2(physical_, &features);
    const char* extensions[] = {VK_EXT_CUSTOM_BORDER_COLOR_EXTENSION_NAME};
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledExtensionCount = 1,
                                  .ppEnabledExtensionNames = extensions};
    check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, 0, 0, &queue_);
  }
  ~LavapipeDriver() override {
    vkDestroyDevice(device_, nullptr);
    vkDestroyInstance(instance_, nullptr);
  }

  CaseOutputs run(const ShaderCase& shader, const std::set<std::uint32_t>& floats,
                  const std::set<std::uint32_t>& integers) override;

 private:
  VkInstance instance_;
  VkPhysicalDevice physical_;
  VkDevice device_ = nullptr;
  VkQueue queue_ = nullptr;

  friend class DriverRun;
};

struct MappedBuffer {
  VkBuffer buffer = nullptr;
  std::byte* bytes = nullptr;
  VkDeviceSize size = 0;
};

// One draw, with all that it needs until it is over.
class DriverRun {
 public:
  DriverRun(const LavapipeDriver& driver, const ShaderCase& shader)
      : device_(driver.device_), queue_(driver.queue_), shader_(shader) {
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    const VkCommandPool pool = created(&vkCreateCommandPool, &vkDestroyCommandPool, pool_info, "vkCreateCommandPool");
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    check(vkAllocateCommandBuffers(device_, &info, &commands_), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    check(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
  }
  ~DriverRun() {
    for (auto end = ends_.rbegin(); end != ends_.rend(); ++end) (*end)();
  }
  DriverRun(const DriverRun&) = delete;

  CaseOutputs run(const std::set<std::uint32_t>& floats, const std::set<std::uint32_t>& integers);

 private:
  void at_end(std::function<void()> end) { ends_.push_back(std::move(end)); }

  // A Vulkan object, which is destroyed at the end. `what`: the function that creates it.
  template <class Handle, class Info>
  Handle created(VkResult (*create)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*),
                 void (*destroy)(VkDevice, Handle, const VkAllocationCallbacks*), const Info& info, const char* what) {
    Handle handle = nullptr;
    check(create(device_, &info, nullptr, &handle), what);
    at_end([this, destroy, handle] { destroy(device_, handle, nullptr); });
    return handle;
  }

  VkDeviceMemory memory_of(const VkMemoryRequirements& needs) {  // all memory of the driver is the host's
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size};
    return created(&vkAllocateMemory, &vkFreeMemory, info, "vkAllocateMemory");
  }

  MappedBuffer buffer_of(VkDeviceSize size, VkBufferUsageFlags usage, const void* bytes = nullptr) {
    MappedBuffer made{.size = size};
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    made.buffer = created(&vkCreateBuffer, &vkDestroyBuffer, info, "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, made.buffer, &needs);
    const VkDeviceMemory memory = memory_of(needs);
    check(vkBindBufferMemory(device_, made.buffer, memory, 0), "vkBindBufferMemory");
    void* mapped = nullptr;
    check(vkMapMemory(device_, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    made.bytes = static_cast<std::byte*>(mapped);
    if (bytes)
      std::memcpy(mapped, bytes, size);
    else
      std::memset(mapped, 0, size);
    return made;
  }

  VkImage image_of(VkImageCreateInfo info) {
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, info.samples = VK_SAMPLE_COUNT_1_BIT;
    const VkImage image = created(&vkCreateImage, &vkDestroyImage, info, "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_, image, &needs);
    check(vkBindImageMemory(device_, image, memory_of(needs), 0), "vkBindImageMemory");
    return image;
  }

  VkImageView view_of(VkImageViewCreateInfo info) {
    info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    return created(&vkCreateImageView, &vkDestroyImageView, info, "vkCreateImageView");
  }

  VkShaderModule module_of(const std::vector<std::uint32_t>& words) {
    const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                        .codeSize = words.size() * sizeof(std::uint32_t),
                                        .pCode = words.data()};
    return created(&vkCreateShaderModule, &vkDestroyShaderModule, info, "vkCreateShaderModule");
  }

  void move_image(VkImage image, VkImageAspectFlags aspect, VkImageLayout to) {
    const VkImageMemoryBarrier barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = to,
        .image = image,
        .subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &barrier);
  }

  VkImageView texture(const ProgramImage& image, const BoundImage& bound, const Slot& slot);
  VkSampler sampler_of(const ProgramSampler& sampler);
  void write_descriptors(const Slots& slots, const std::vector<VkDescriptorSet>& sets);

  VkDevice device_;
  VkQueue queue_;
  const ShaderCase& shader_;
  VkCommandBuffer commands_ = nullptr;
  std::vector<std::function<void()>> ends_;
};

VkImageView DriverRun::texture(const ProgramImage& image, const BoundImage& bound, const Slot& slot) {
  const bool is_depth = image.format == TexelFormat::D32_SFLOAT;
  const VkImageAspectFlags aspect = is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  const bool is_cube = image.layers >= 6 && image.width == image.height && image.shape != ImageShape::d1;
  const VkImage made = image_of({.flags = is_cube ? VkImageCreateFlags{VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT} : 0u,
                                 .imageType = image.shape == ImageShape::d1   ? VK_IMAGE_TYPE_1D
                                              : image.shape == ImageShape::d3 ? VK_IMAGE_TYPE_3D
                                                                              : VK_IMAGE_TYPE_2D,
                                 .format = format_of(image.format),
                                 .extent = {image.width, image.height, image.depth},
                                 .mipLevels = image.levels,
                                 .arrayLayers = image.layers,
                                 .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  const MappedBuffer staged = buffer_of(image.texels.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, image.texels.data());
  move_image(made, aspect, VK_IMAGE_LAYOUT_GENERAL);
  for (std::uint32_t level = 0; level < image.levels; ++level) {
    const auto side = [level](std::uint32_t size) { return std::max(size >> level, 1u); };
    const VkBufferImageCopy copy{.bufferOffset = level_start(image, level),
                                 .imageSubresource = {aspect, level, 0, image.layers},
                                 .imageExtent = {side(image.width), side(image.height), side(image.depth)}};
    vkCmdCopyBufferToImage(commands_, staged.buffer, made, VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
  }
  const bool arrayed = slot.is_arrayed;
  const VkImageViewType type = slot.dim == spv::Dim1D   ? arrayed ? VK_IMAGE_VIEW_TYPE_1D_ARRAY : VK_IMAGE_VIEW_TYPE_1D
                               : slot.dim == spv::Dim3D ? VK_IMAGE_VIEW_TYPE_3D
                               : slot.dim == spv::DimCube
                                   ? arrayed ? VK_IMAGE_VIEW_TYPE_CUBE_ARRAY : VK_IMAGE_VIEW_TYPE_CUBE
                               : arrayed ? VK_IMAGE_VIEW_TYPE_2D_ARRAY
                                         : VK_IMAGE_VIEW_TYPE_2D;
  const std::uint32_t layers = arrayed                    ? bound.layers.value_or(image.layers - bound.base_layer)
                               : slot.dim == spv::DimCube ? 6
                                                          : 1;
  return view_of({.image = made,
                  .viewType = type,
                  .format = format_of(image.format),
                  .components = {swizzle_of(bound.swizzle[0]), swizzle_of(bound.swizzle[1]),
                                 swizzle_of(bound.swizzle[2]), swizzle_of(bound.swizzle[3])},
                  .subresourceRange = {aspect, bound.base_level, bound.levels.value_or(image.levels - bound.base_level),
                                       bound.base_layer, layers}});
}

VkSampler DriverRun::sampler_of(const ProgramSampler& sampler) {
  const auto filter = [](Filter f) { return f == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST; };
  VkSamplerCustomBorderColorCreateInfoEXT border{.sType = VK_STRUCTURE_TYPE_SAMPLER_CUSTOM_BORDER_COLOR_CREATE_INFO_EXT,
                                                 .format = VK_FORMAT_UNDEFINED};
  for (int i = 0; i < 4; ++i) border.customBorderColor.float32[i] = sampler.border[i];
  const VkSamplerCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
      .pNext = &border,
      .magFilter = filter(sampler.mag),
      .minFilter = filter(sampler.min),
      .mipmapMode = sampler.mip == Filter::linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST,
      .addressModeU = address_mode_of(sampler.wrap[0]),
      .addressModeV = address_mode_of(sampler.wrap[1]),
      .addressModeW = address_mode_of(sampler.wrap[2]),
      .mipLodBias = sampler.lod_bias,
      .anisotropyEnable = sampler.anisotropy > 1,
      .maxAnisotropy = sampler.anisotropy,
      .compareEnable = sampler.compare.has_value(),
      .compareOp = static_cast<VkCompareOp>(sampler.compare.value_or(Compare::never)),  // in the same order
      .minLod = sampler.least_lod,
      .maxLod = sampler.most_lod,
      .borderColor = VK_BORDER_COLOR_FLOAT_CUSTOM_EXT,
      .unnormalizedCoordinates = sampler.unnormalized};
  return created(&vkCreateSampler, &vkDestroySampler, info, "vkCreateSampler");
}

void DriverRun::write_descriptors(const Slots& slots, const std::vector<VkDescriptorSet>& sets) {
  const ProgramUse& use = shader_.use;
  for (const auto& [place, slot] : slots)
    for (std::uint32_t element = 0; element < slot.count; ++element) {
      const auto is_here = [&, set = place.first, binding = place.second](const auto& each) {
        return each.set == set && each.binding == binding && each.element == element;
      };
      const auto buffer = std::find_if(use.buffers.begin(), use.buffers.end(), is_here);
      const auto image = std::find_if(use.images.begin(), use.images.end(), is_here);
      VkDescriptorBufferInfo buffer_info{};
      VkDescriptorImageInfo image_info{.imageLayout = VK_IMAGE_LAYOUT_GENERAL};
      VkBufferView buffer_view = nullptr;
      ProgramImage none{.format = slot.format, .width = 1};
      none.layers = slot.dim == spv::DimCube ? 6 : 1;
      none.shape = slot.dim == spv::Dim1D ? ImageShape::d1 : slot.dim == spv::Dim3D ? ImageShape::d3 : ImageShape::d2;
      none.texels.resize(level_start(none, 1));
      const bool has_image = image != use.images.end() && image->image;
      const ProgramImage& texels = has_image ? shader_.images[*image->image] : none;
      switch (slot.type) {
        case VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER: {
          const MappedBuffer made =
              buffer_of(texels.texels.size(), VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, texels.texels.data());
          const VkBufferViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                            .buffer = made.buffer,
                                            .format = format_of(texels.format),
                                            .range = VK_WHOLE_SIZE};
          buffer_view = created(&vkCreateBufferView, &vkDestroyBufferView, info, "vkCreateBufferView");
          break;
        }
        case VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER:
        case VK_DESCRIPTOR_TYPE_STORAGE_BUFFER: {
          const std::vector<std::uint8_t> zeros(16);
          const std::vector<std::uint8_t>& bytes = buffer == use.buffers.end() ? zeros : buffer->bytes;
          const MappedBuffer made = buffer_of(
              bytes.size(), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, bytes.data());
          buffer_info = {made.buffer, 0, VK_WHOLE_SIZE};
          break;
        }
        default:
          if (slot.type != VK_DESCRIPTOR_TYPE_SAMPLER)
            image_info.imageView = texture(texels, has_image ? *image : BoundImage{}, slot);
          if (slot.type != VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE)
            image_info.sampler = sampler_of(
                image != use.images.end() && image->sampler
                    ? shader_.samplers[*image->sampler]
                    : ProgramSampler{.mag = Filter::nearest, .min = Filter::nearest, .mip = Filter::nearest});
      }
      const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                       .dstSet = sets[place.first],
                                       .dstBinding = place.second,
                                       .dstArrayElement = element,
                                       .descriptorCount = 1,
                                       .descriptorType = slot.type,
                                       .pImageInfo = &image_info,
                                       .pBufferInfo = &buffer_info,
                                       .pTexelBufferView = &buffer_view};
      vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
    }
}

CaseOutputs DriverRun::run(const std::set<std::uint32_t>& floats, const std::set<std::uint32_t>& integers) {
  const Slots slots = slots_of(ShaderModule(shader_.words));

  // Descriptors and push constants.
  std::uint32_t set_count = 0;
  for (const auto& [place, slot] : slots) set_count = std::max(set_count, place.first + 1);
  std::vector<VkDescriptorSetLayout> set_layouts(set_count);
  std::map<VkDescriptorType, std::uint32_t> counts{{VK_DESCRIPTOR_TYPE_SAMPLER, 1}};
  for (std::uint32_t set = 0; set < set_count; ++set) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const auto& [place, slot] : slots) {
      if (place.first != set) continue;
      bindings.push_back({place.second, slot.type, slot.count, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr});
      counts[slot.type] += slot.count;
    }
    const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                               .bindingCount = static_cast<std::uint32_t>(bindings.size()),
                                               .pBindings = bindings.data()};
    set_layouts[set] =
        created(&vkCreateDescriptorSetLayout, &vkDestroyDescriptorSetLayout, info, "vkCreateDescriptorSetLayout");
  }
  constexpr std::uint32_t kPushBytes = 256;
  const VkPushConstantRange push{VK_SHADER_STAGE_FRAGMENT_BIT, 0, kPushBytes};
  const VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = set_count,
                                               .pSetLayouts = set_layouts.data(),
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &push};
  const VkPipelineLayout layout =
      created(&vkCreatePipelineLayout, &vkDestroyPipelineLayout, layout_info, "vkCreatePipelineLayout");
  std::vector<VkDescriptorSet> sets(set_count);
  if (set_count > 0) {
    std::vector<VkDescriptorPoolSize> sizes;
    for (const auto& [type, count] : counts) sizes.push_back({type, count});
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = set_count,
                                          .poolSizeCount = static_cast<std::uint32_t>(sizes.size()),
                                          .pPoolSizes = sizes.data()};
    const VkDescriptorPool pool =
        created(&vkCreateDescriptorPool, &vkDestroyDescriptorPool, info, "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .descriptorPool = pool,
                                               .descriptorSetCount = set_count,
                                               .pSetLayouts = set_layouts.data()};
    check(vkAllocateDescriptorSets(device_, &allocate, sets.data()), "vkAllocateDescriptorSets");
  }
  write_descriptors(slots, sets);

  // Vertices.
  const std::vector<std::array<float, 4>> positions = positions_of(shader_);
  std::vector<VkVertexInputBindingDescription> bindings;
  std::vector<VkVertexInputAttributeDescription> attributes;
  std::vector<VkBuffer> vertex_buffers;
  const auto add_attribute = [&](std::uint32_t location, bool is_integer, const void* data) {
    const auto number = static_cast<std::uint32_t>(bindings.size());
    bindings.push_back({number, sizeof(FourBits), VK_VERTEX_INPUT_RATE_VERTEX});
    attributes.push_back(
        {location, number, is_integer ? VK_FORMAT_R32G32B32A32_UINT : VK_FORMAT_R32G32B32A32_SFLOAT, 0});
    vertex_buffers.push_back(
        buffer_of(positions.size() * sizeof(FourBits), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, data).buffer);
  };
  add_attribute(0, false, positions.data());
  for (const auto& [location, input] : shader_.inputs)
    add_attribute(location + 1, input.is_integer, input.vertices.data());

  // Targets.
  std::uint32_t targets = 0;
  for (const auto* locations : {&floats, &integers})
    for (const std::uint32_t location : *locations) targets = std::max(targets, location + 1);
  std::vector<VkImage> images(targets);
  std::vector<VkFormat> formats(targets, VK_FORMAT_UNDEFINED);
  std::vector<VkRenderingAttachmentInfo> attachments(
      targets, {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, .imageView = nullptr});
  for (std::uint32_t i = 0; i < targets; ++i) {
    if (!floats.contains(i) && !integers.contains(i)) continue;
    formats[i] = integers.contains(i) ? VK_FORMAT_R32G32B32A32_UINT : VK_FORMAT_R32G32B32A32_SFLOAT;
    images[i] = image_of({.imageType = VK_IMAGE_TYPE_2D,
                          .format = formats[i],
                          .extent = {kSide, kSide, 1},
                          .mipLevels = 1,
                          .arrayLayers = 1,
                          .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    move_image(images[i], VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_GENERAL);
    attachments[i].imageView = view_of({.image = images[i],
                                        .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                        .format = formats[i],
                                        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}});
    attachments[i].imageLayout = VK_IMAGE_LAYOUT_GENERAL;
    attachments[i].loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, attachments[i].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    for (std::uint32_t& word : attachments[i].clearValue.color.uint32) word = kNotWritten;
  }

  // The pipeline.
  std::vector<VkSpecializationMapEntry> entries;
  std::vector<std::uint32_t> constants;
  for (const SpecializationConstant& each : shader_.specialization) {
    entries.push_back(
        {each.id, static_cast<std::uint32_t>(constants.size() * sizeof(std::uint32_t)), sizeof(std::uint32_t)});
    constants.push_back(each.bits);
  }
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            constants.size() * sizeof(std::uint32_t), constants.data()};
  const VkPipelineShaderStageCreateInfo stages[] = {{.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                     .stage = VK_SHADER_STAGE_VERTEX_BIT,
                                                     .module = module_of(vertex_shader(shader_.inputs)),
                                                     .pName = "main"},
                                                    {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                     .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
                                                     .module = module_of(shader_.words),
                                                     .pName = "main",
                                                     .pSpecializationInfo = &specialization}};
  const VkPipelineVertexInputStateCreateInfo vertex_input{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
      .vertexBindingDescriptionCount = static_cast<std::uint32_t>(bindings.size()),
      .pVertexBindingDescriptions = bindings.data(),
      .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(attributes.size()),
      .pVertexAttributeDescriptions = attributes.data()};
  const VkPipelineInputAssemblyStateCreateInfo assembly{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = shader_.is_triangle ? VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST : VK_PRIMITIVE_TOPOLOGY_POINT_LIST};
  const VkViewport viewport{0, 0, kSide, kSide, 0, 1};
  const VkRect2D all{{0, 0}, {kSide, kSide}};
  const VkPipelineViewportStateCreateInfo viewports{.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                                                    .viewportCount = 1,
                                                    .pViewports = &viewport,
                                                    .scissorCount = 1,
                                                    .pScissors = &all};
  const VkPipelineRasterizationStateCreateInfo raster{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
      .polygonMode = VK_POLYGON_MODE_FILL,
      .frontFace = VK_FRONT_FACE_CLOCKWISE,  // as the triangle is
      .lineWidth = 1};
  const VkPipelineMultisampleStateCreateInfo multisample{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO, .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  const std::vector<VkPipelineColorBlendAttachmentState> blends(targets, {.colorWriteMask = 0xf});
  const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                  .attachmentCount = targets,
                                                  .pAttachments = blends.data()};
  const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                .colorAttachmentCount = targets,
                                                .pColorAttachmentFormats = formats.data()};
  const VkGraphicsPipelineCreateInfo pipeline_info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                                   .pNext = &rendering,
                                                   .stageCount = 2,
                                                   .pStages = stages,
                                                   .pVertexInputState = &vertex_input,
                                                   .pInputAssemblyState = &assembly,
                                                   .pViewportState = &viewports,
                                                   .pRasterizationState = &raster,
                                                   .pMultisampleState = &multisample,
                                                   .pColorBlendState = &blend,
                                                   .layout = layout};
  VkPipeline pipeline = nullptr;
  check(vkCreateGraphicsPipelines(device_, nullptr, 1, &pipeline_info, nullptr, &pipeline),
        "vkCreateGraphicsPipelines");
  at_end([this, pipeline] { vkDestroyPipeline(device_, pipeline, nullptr); });

  // The draw.
  const VkRenderingInfo rendering_info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                       .renderArea = all,
                                       .layerCount = 1,
                                       .colorAttachmentCount = targets,
                                       .pColorAttachments = attachments.data()};
  vkCmdBeginRendering(commands_, &rendering_info);
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
  if (set_count > 0)
    vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, set_count, sets.data(), 0, nullptr);
  std::vector<std::uint8_t> push_bytes = shader_.use.push_constants;
  push_bytes.resize(kPushBytes);
  vkCmdPushConstants(commands_, layout, VK_SHADER_STAGE_FRAGMENT_BIT, 0, kPushBytes, push_bytes.data());
  const std::vector<VkDeviceSize> offsets(vertex_buffers.size());
  vkCmdBindVertexBuffers(commands_, 0, static_cast<std::uint32_t>(vertex_buffers.size()), vertex_buffers.data(),
                         offsets.data());
  vkCmdDraw(commands_, static_cast<std::uint32_t>(positions.size()), 1, 0, 0);
  vkCmdEndRendering(commands_);
  std::vector<MappedBuffer> read(targets);
  for (std::uint32_t i = 0; i < targets; ++i) {
    if (!images[i]) continue;
    read[i] = buffer_of(kPixels * sizeof(FourBits), VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {kSide, kSide, 1}};
    vkCmdCopyImageToBuffer(commands_, images[i], VK_IMAGE_LAYOUT_GENERAL, read[i].buffer, 1, &copy);
  }
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  const VkSubmitInfo submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands_};
  check(vkQueueSubmit(queue_, 1, &submit, nullptr), "vkQueueSubmit");
  check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");

  CaseOutputs outputs{.locations = {}, .is_kept = std::vector<bool>(kPixels)};
  for (std::uint32_t i = 0; i < targets; ++i) {
    if (!images[i]) continue;
    CaseOutput& output = outputs.locations[i];
    output.is_integer = integers.contains(i);
    output.pixels.resize(kPixels);
    std::memcpy(output.pixels.data(), read[i].bytes, kPixels * sizeof(FourBits));
    for (std::size_t p = 0; p < kPixels; ++p)
      if (output.pixels[p] != FourBits{kNotWritten, kNotWritten, kNotWritten, kNotWritten}) outputs.is_kept[p] = true;
  }
  return outputs;
}

CaseOutputs LavapipeDriver::run(const ShaderCase& shader, const std::set<std::uint32_t>& floats,
                                const std::set<std::uint32_t>& integers) {
  return DriverRun(*this, shader).run(floats, integers);
}

}  // namespace

std::unique_ptr<Driver> Driver::find(std::string& problem) {
  // Filters as Vulkan describes them, without the driver's shortcuts.
  setenv("GALLIVM_PERF", "no_brilinear,no_rho_approx,no_quad_lod,no_aos_sampling", 1);
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
  VkInstance instance = nullptr;
  if (vkCreateInstance(&info, nullptr, &instance) != VK_SUCCESS) {
    problem = "no Vulkan driver";
    return nullptr;
  }
  std::uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  vkEnumeratePhysicalDevices(instance, &count, devices.data());
  for (const VkPhysicalDevice device : devices) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    if (std::string(properties.deviceName).starts_with("llvmpipe") && properties.apiVersion >= VK_API_VERSION_1_3)
      return std::make_unique<LavapipeDriver>(instance, device);
  }
  problem = "no device of Mesa's lavapipe with Vulkan 1.3";
  vkDestroyInstance(instance, nullptr);
  return nullptr;
}

}  // namespace beampipe

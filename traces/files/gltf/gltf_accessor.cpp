#include "traces/files/gltf/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "traces/files/input_file.h"

namespace beampipe {
namespace {

constexpr std::size_t kMostZeros = std::size_t{1} << 26;  // elements of an accessor without a buffer

const char* name_of(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
      return "VEC2";
    case TINYGLTF_TYPE_VEC3:
      return "VEC3";
    case TINYGLTF_TYPE_VEC4:
      return "VEC4";
    case TINYGLTF_TYPE_MAT4:
      return "MAT4";
    default:
      return "another one";
  }
}

// In bytes; 0 of a type that glTF does not have.
std::size_t size_of(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

template <class Number>
double read(const unsigned char* from) {
  Number number;  // glTF is little-endian, as are all machines that beampipe runs on
  std::memcpy(&number, from, sizeof number);
  return static_cast<double>(number);
}

double read(const unsigned char* from, int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return read<std::int8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return read<std::uint8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return read<std::int16_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return read<std::uint16_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return read<std::uint32_t>(from);
    default:
      return read<float>(from);
  }
}

// The largest value of a normalised integer, which stands for 1.
double one_of(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return 127;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return 32767;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 65535;
    default:
      return 1;
  }
}

bool is_unsigned(int component_type) {
  return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace

GltfAccessor::GltfAccessor(const GltfFile& file, int index, const std::string& type, const std::string& named_by) {
  const std::size_t checked = checked_index(index, file.model.accessors.size(), named_by, "accessors");
  const tinygltf::Accessor& accessor = file.model.accessors[checked];
  where_ = file.place("accessors", checked);
  const std::string found = name_of(accessor.type);
  if ((" " + type + " ").find(" " + found + " ") == std::string::npos) fail_trace(where_, "the type " + type, found);
  component_type_ = accessor.componentType;
  component_size_ = size_of(component_type_);
  if (component_size_ == 0) fail_trace(where_, "a componentType of glTF 2.0", std::to_string(component_type_));
  if (accessor.type == TINYGLTF_TYPE_MAT4 && component_type_ != TINYGLTF_COMPONENT_TYPE_FLOAT)
    fail_trace(where_, "matrices of floats", "another componentType");
  components_ = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  normalized_ = accessor.normalized;
  count_ = accessor.count;
  if (count_ == 0) fail_trace(where_, "at least one element", "none");
  if (accessor.bufferView >= 0) {
    dense_ = elements(file, accessor.bufferView, accessor.byteOffset,
                      component_size_ * static_cast<std::size_t>(components_), count_, true);
  } else if (count_ > kMostZeros) {
    fail_trace(where_, "at most " + std::to_string(kMostZeros) + " elements without a bufferView",
               std::to_string(count_));
  }
  if (accessor.sparse.isSparse) read_sparse(file, accessor);
}

GltfAccessor::Elements GltfAccessor::elements(const GltfFile& file, int view_index, std::size_t offset,
                                              std::size_t size, std::size_t count, bool may_have_stride) const {
  const tinygltf::Model& model = file.model;
  const std::size_t checked = checked_index(view_index, model.bufferViews.size(), where_, "bufferViews");
  const tinygltf::BufferView& view = model.bufferViews[checked];
  const std::string place = file.place("bufferViews", checked);
  const std::vector<unsigned char>& data =
      model.buffers[checked_index(view.buffer, model.buffers.size(), place, "buffers")].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
    fail_trace(place, "bytes in its buffer of " + std::to_string(data.size()), "others");
  const std::size_t stride = may_have_stride && view.byteStride > 0 ? view.byteStride : size;
  if (stride < size) fail_trace(place, "a byteStride of at least " + std::to_string(size), std::to_string(stride));
  const bool has_one = offset <= view.byteLength && view.byteLength - offset >= size;
  if (!has_one || count - 1 > (view.byteLength - offset - size) / stride) {
    fail_trace(where_, "elements in their bufferView of " + std::to_string(view.byteLength) + " bytes",
               std::to_string(count) + " of " + std::to_string(size) + " bytes from byte " + std::to_string(offset));
  }
  return {data.data() + view.byteOffset + offset, stride};
}

void GltfAccessor::read_sparse(const GltfFile& file, const tinygltf::Accessor& accessor) {
  const auto& sparse = accessor.sparse;
  const int type = sparse.indices.componentType;
  if (!is_unsigned(type)) fail_trace(where_ + "/sparse/indices", "unsigned integers", std::to_string(type));
  if (sparse.count < 1 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    fail_trace(where_ + "/sparse", "a count of 1 and up, and offsets of 0 and up", "others");
  const auto count = static_cast<std::size_t>(sparse.count);
  const Elements indices = elements(file, sparse.indices.bufferView,
                                    static_cast<std::size_t>(sparse.indices.byteOffset), size_of(type), count, false);
  sparse_ = elements(file, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                     component_size_ * static_cast<std::size_t>(components_), count, false);
  sparse_indices_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto index = static_cast<std::uint32_t>(read(indices.first + i * indices.stride, type));
    if (index >= count_ || (i > 0 && index <= sparse_indices_.back())) {
      fail_trace(where_ + "/sparse/indices", "indices below " + std::to_string(count_) + " in ascending order",
                 std::to_string(index) + " at " + std::to_string(i));
    }
    sparse_indices_.push_back(index);
  }
}

bool GltfAccessor::holds_indices() const { return is_unsigned(component_type_) && !normalized_; }

const unsigned char* GltfAccessor::find(std::size_t element) const {
  const auto found = std::lower_bound(sparse_indices_.begin(), sparse_indices_.end(), element);
  if (found != sparse_indices_.end() && *found == element)
    return sparse_.first + static_cast<std::size_t>(found - sparse_indices_.begin()) * sparse_.stride;
  return dense_.first ? dense_.first + element * dense_.stride : nullptr;
}

double GltfAccessor::number(std::size_t element, int component) const {
  const unsigned char* from = find(element);
  if (!from) return 0;
  const double value = read(from + static_cast<std::size_t>(component) * component_size_, component_type_);
  if (!std::isfinite(value)) fail_trace(where_, "finite numbers", "another one in element " + std::to_string(element));
  return normalized_ ? std::max(value / one_of(component_type_), -1.0) : value;
}

std::uint32_t GltfAccessor::integer(std::size_t element, int component) const {
  return static_cast<std::uint32_t>(number(element, component));
}

glm::vec3 GltfAccessor::vec3(std::size_t element) const {
  return glm::vec3(number(element, 0), number(element, 1), number(element, 2));
}

glm::vec4 GltfAccessor::vec4(std::size_t element) const {
  return glm::vec4(vec3(element), components_ == 4 ? number(element, 3) : 1.0);
}

}  // namespace beampipe

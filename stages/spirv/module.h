// module: the words of a simplified SPIR-V module -> its instructions, decorations and types, to look up
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <spirv/unified1/spirv.hpp>
#include <string>
#include <vector>

namespace beampipe {

struct Instruction {
  spv::Op op = spv::OpNop;
  std::uint32_t type = 0, result = 0;            // ids; 0: it has none
  std::span<const std::uint32_t> operands = {};  // what follows them
};

// The name of an opcode, for messages: "OpFAdd".
std::string name_of(spv::Op op);

// Types are flattened into parts: scalars in the order in which they stand in the type.
struct ShaderType {
  enum class Kind {
    other,
    boolean,
    integer,
    number,
    vector,
    matrix,
    array,
    structure,
    image,
    sampler,
    sampled_image,
    pointer
  };
  Kind kind = Kind::other;
  std::uint32_t width = 0;    // of a scalar, in bits; 32 for booleans
  std::uint32_t element = 0;  // id: of a vector, matrix, array, pointer or sampled image; an image's texels
  std::uint32_t count = 0;    // of elements; 0: a runtime array, whose length only its buffer knows
  std::vector<std::uint32_t> members = {};                                           // ids
  std::uint32_t parts = 0;                                                           // kTooMany at most
  spv::StorageClass storage = spv::StorageClassMax;                                  // of a pointer
  spv::Dim dim = spv::DimMax;                                                        // of an image
  bool depth = false, arrayed = false, multisampled = false, storage_image = false;  // of an image

  static constexpr std::uint32_t kTooMany = 1u << 16;
  bool is_scalar() const { return kind == Kind::boolean || kind == Kind::integer || kind == Kind::number; }
};

class ShaderModule {
 public:
  // Of SPIR-V that simplify() made. Throws ShaderError.
  explicit ShaderModule(std::vector<std::uint32_t> words);
  ShaderModule(const ShaderModule&) = delete;

  std::uint32_t bound() const { return static_cast<std::uint32_t>(definitions_.size()); }  // ids are less
  // All instructions outside functions, and those of the entry point's function.
  std::span<const Instruction> globals() const { return globals_; }
  std::span<const Instruction> body() const { return body_; }

  const Instruction& definition(std::uint32_t id) const;
  const ShaderType& type(std::uint32_t id) const { return types_[id]; }
  bool is_glsl(std::uint32_t set) const { return set == glsl_; }  // the set of GLSL.std.450

  // The first literal of a decoration (0 if it has none); of a member unless `member` is kWhole.
  static constexpr std::uint32_t kWhole = ~0u;
  std::optional<std::uint32_t> decoration(std::uint32_t id, spv::Decoration decoration,
                                          std::uint32_t member = kWhole) const;

  bool has_mode(spv::ExecutionMode mode) const;
  bool ends_invocation(std::uint32_t function) const { return ending_.contains(function); }  // does each call of it?
  std::uint32_t constant_word(std::uint32_t id) const;  // of an integer constant; throws ShaderError

 private:
  void read_instructions();
  void add_type(const Instruction& instruction);

  std::vector<std::uint32_t> words_;
  std::vector<Instruction> globals_, body_, definitions_;
  std::vector<ShaderType> types_;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> decorations_;
  std::vector<spv::ExecutionMode> modes_;
  std::set<std::uint32_t> ending_;  // functions
  std::uint32_t glsl_ = 0, entry_ = 0;
};

}  // namespace beampipe

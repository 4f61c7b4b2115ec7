// The parts of decode(): how each instruction becomes lane operations. Composites are taken apart into rows of scalars,
// so that taking one together, taking one apart and casting bits cost nothing.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "stages/spirv/draft.h"
#include "stages/spirv/module.h"
#include "stages/spirv/shader_error.h"

namespace beampipe {

using Row = std::uint32_t;

// The rows of a value, in the order of its type's parts.
class Parts {
 public:
  Parts() = default;
  Parts(std::initializer_list<Row> rows) : rows_(rows) {}
  explicit Parts(std::vector<Row> rows) : rows_(std::move(rows)) {}

  Row operator[](std::size_t i) const {
    if (i >= rows_.size()) throw ShaderError("an instruction has fewer operands than its type needs");
    return rows_[i];
  }
  std::size_t size() const { return rows_.size(); }
  auto begin() const { return rows_.begin(); }
  auto end() const { return rows_.end(); }
  void push_back(Row row) { rows_.push_back(row); }
  void append(const Parts& more) { rows_.insert(rows_.end(), more.begin(), more.end()); }
  Parts slice(std::size_t first, std::size_t count) const {
    if (first + count > rows_.size()) throw ShaderError("an instruction takes more of a value than it has");
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(first);
    return Parts(std::vector<Row>(begin, begin + static_cast<std::ptrdiff_t>(count)));
  }
  void set(std::size_t i, Row row) {
    (*this)[i];
    rows_[i] = row;
  }

 private:
  std::vector<Row> rows_;
};

// Where a load reads and a store writes. In rows: part `offset` of a variable, plus the value of row `index`. In bytes:
// of a buffer, likewise.
struct ShaderPointer {
  enum class Space : std::uint8_t { rows, bytes, images };
  Space space = Space::rows;
  std::uint32_t variable = 0;             // id
  std::uint32_t type = 0;                 // id, of what it points to
  std::uint32_t first_row = 0, rows = 0;  // of the variable, in rows
  std::uint32_t offset = 0;
  Row index = kNoRow;
  std::optional<std::uint32_t> element = {};  // of an array of buffers; none: not chosen yet
  std::uint32_t matrix_stride = 0;            // of a matrix in bytes
  bool is_row_major = false;
  std::uint32_t vector_stride = 0;  // of a vector in bytes; 0: its components follow each other
  Row image_element = kNoRow;       // of an array of images
};

// An image, a sampler, or both.
struct ImageHandle {
  std::uint32_t type = 0;                          // id of the image's type; 0: a sampler alone
  std::uint32_t image = kNoRow, sampler = kNoRow;  // indices in LaneProgram
  Row image_element = kNoRow, sampler_element = kNoRow;
};

class Decoder {
 public:
  explicit Decoder(const ShaderModule& module) : module_(module), values_(module.bound()) {}
  Draft decode();

 private:
  using Kind = ShaderType::Kind;
  struct Value {
    std::optional<Parts> parts;
    std::optional<ShaderPointer> pointer;
    std::optional<ImageHandle> handle;
  };
  struct Block;  // of the module

  // decode_values.cpp: rows, constants and scalar operations.
  Row constant(std::uint32_t bits);
  Row number(float value);
  Row emit(const LaneOp& op);  // of what has no effect but its result, which it returns
  Row emit(LaneCode code, Row a, Row b = kNoRow, Row c = kNoRow) {
    return emit({.code = code, .a = a, .b = b, .c = c});
  }
  Row emit_free(LaneCode code, Row a, Row b = kNoRow) {  // part of an operation that is counted
    return emit({.code = code, .is_free = true, .a = a, .b = b});
  }
  void add(const LaneOp& op);        // of any other
  void count_op();                   // throws if there are too many
  void emit_copy(Row to, Row from);  // in lanes that run
  const ShaderType& scalar_of(
      std::uint32_t type) const;  // of a scalar, vector or matrix; throws if it is not supported
  Row float_op(std::uint32_t width, LaneCode code, Row a, Row b = kNoRow);
  Row integer_op(std::uint32_t width, LaneCode code, Row a, Row b = kNoRow);
  Row widened(std::uint32_t width, Row row);   // a signed integer, as one of 32 bits
  Row narrowed(std::uint32_t width, Row row);  // an integer of 32 bits, as one of so many
  Row half_bits(Row row);                      // of a 16-bit float, and back
  Row half_value(Row row);
  std::uint32_t parts_of(std::uint32_t type) const;  // throws if there are too many
  void require_room(std::uint32_t type);             // for one more value, before it is made; throws if there is none
  Parts zeros(std::uint32_t type);
  const Parts& parts(std::uint32_t id);
  Row part(std::uint32_t id, std::size_t i = 0) { return parts(id)[i]; }
  void define(const Instruction& instruction, Parts parts) { values_[instruction.result].parts = std::move(parts); }
  void define_constant(const Instruction& instruction);
  Parts cast_bits(std::uint32_t to_type, std::uint32_t from_type, const Parts& from);

  // decode_memory.cpp: variables, pointers, loads and stores.
  void define_variable(const Instruction& instruction);
  void define_interface(const Instruction& instruction, std::uint32_t type, bool is_input);
  void add_interface_rows(std::uint32_t type, InterfaceRow& next, std::vector<InterfaceRow>& rows);
  const ShaderPointer& pointer(std::uint32_t id) const;
  ShaderPointer step(ShaderPointer from, std::uint32_t index_id);
  void add_index(ShaderPointer& pointer, std::uint32_t index_id, std::uint32_t stride, std::uint32_t count);
  Parts load(const ShaderPointer& from);
  void load_bytes(const ShaderPointer& from, std::uint32_t buffer, Parts& parts);
  void store(const ShaderPointer& to, const Parts& from);
  std::uint32_t buffer_of(const ShaderPointer& pointer);
  void access_chain(const Instruction& instruction);

  // decode_arithmetic.cpp, decode_glsl.cpp.
  bool decode_arithmetic(const Instruction& instruction);
  bool decode_composite(const Instruction& instruction);
  bool decode_linear_algebra(const Instruction& instruction);
  bool decode_conversion(const Instruction& instruction);
  void decode_glsl(const Instruction& instruction);
  class GlslFormulas;
  Row dot(std::uint32_t width, const Parts& a, const Parts& b);

  // decode_images.cpp.
  bool decode_image(const Instruction& instruction);
  const ImageHandle& handle(std::uint32_t id) const;
  ImageHandle load_handle(const ShaderPointer& from);
  void define_image_variable(const Instruction& instruction, std::uint32_t type);
  void sample(const Instruction& instruction, ImageAction action, bool is_implicit, bool has_reference,
              bool is_projected);
  void query(const Instruction& instruction, ImageAction action);
  void read_image_operands(std::span<const std::uint32_t> operands, ImageOp& op, bool& has_slopes);
  void finish_image(const Instruction& instruction, ImageOp op, std::uint32_t results);

  // decode.cpp: instructions and the flow of control.
  void decode_instruction(const Instruction& instruction);
  std::vector<Block> split_blocks() const;
  void decode_end(const Block& block, const std::vector<std::uint32_t>& places);

  const ShaderModule& module_;
  Draft draft_;
  std::vector<Value> values_;  // by id
  std::unordered_map<std::uint32_t, Row> constants_;
  std::unordered_map<Row, Row> uncast_;                       // of rows that are casts of 16-bit floats: what was cast
  std::unordered_set<Row> texels_;                            // results of images
  std::map<std::array<std::uint32_t, 6>, std::size_t> made_;  // operations of the block, by what they do
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> buffers_;  // by variable and element
  std::unordered_map<std::uint32_t, std::uint32_t> slots_;                    // image and sampler variables
  DraftBlock* block_ = nullptr;                                               // that is being decoded
  std::size_t ops_ = 0;                                                       // in all blocks, and copies
  std::size_t all_parts_ = 0;                                                 // of values
};

}  // namespace beampipe

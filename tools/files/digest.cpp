#include "tools/files/digest.h"

#include <boost/crc.hpp>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <type_traits>
#include <vector>

namespace beampipe {
namespace {

class Digest {
 public:
  void add_bytes(const void* bytes, std::size_t size) { crc_.process_bytes(bytes, size); }

  template <class Value>
  void add(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    add_bytes(&value, sizeof value);
  }

  template <class Value>
  void add(const std::vector<Value>& values) {
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(Value));
  }

  void add(const std::optional<glm::vec3>& vector) {
    add(vector.has_value());
    add(vector.value_or(glm::vec3(0.0f)));
  }

  std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(crc_.checksum()));
    return digits;
  }

 private:
  static constexpr std::uint64_t kPolynomial = 0x42F0E1EBA9EA3693u;  // ECMA-182
  boost::crc_optimal<64, kPolynomial, ~std::uint64_t{0}, ~std::uint64_t{0}, true, true> crc_;
};

}  // namespace

std::string digest_of(std::string_view bytes) {
  Digest digest;
  digest.add_bytes(bytes.data(), bytes.size());
  return digest.text();
}

std::string digest_of(const Trace& trace) {
  Digest digest;
  for (const Mesh& mesh : trace.meshes) {
    digest.add(mesh.positions);
    digest.add(mesh.triangles);
    digest.add(mesh.colors);
  }
  for (const Frame& frame : trace.frames) {
    digest.add(frame.width);
    digest.add(frame.height);
    digest.add(frame.background);
    digest.add(frame.view);
    digest.add(frame.projection);
    digest.add(frame.light_direction);
    digest.add(frame.draws.size());
    for (const Draw& draw : frame.draws) {
      digest.add(draw.mesh);
      digest.add(draw.transform);
      digest.add(draw.kd);
      digest.add(draw.cull);
      digest.add(draw.shading);
    }
  }
  return digest.text();
}

std::string digest_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Digest digest;
  std::vector<char> bytes(1 << 20);
  while (file.read(bytes.data(), std::ssize(bytes)) || file.gcount() > 0)
    digest.add_bytes(bytes.data(), static_cast<std::size_t>(file.gcount()));
  return digest.text();
}

}  // namespace beampipe

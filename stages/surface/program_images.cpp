#include "stages/surface/program_images.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "stages/data/half_bits.h"
#include "stages/rop/rop_formulas.h"
#include "stages/surface/ellipse_filter.h"
#include "stages/surface/mip_chain.h"

namespace beampipe {
namespace {

using Texel = std::array<float, 4>;  // of integer formats: their bits

float number_of(std::uint32_t bits) { return std::bit_cast<float>(bits); }

template <class Word>
Word word_at(const std::uint8_t* bytes, std::size_t place) {
  Word word;
  std::memcpy(&word, bytes + place * sizeof word, sizeof word);
  return word;
}

// Of all bytes, because a division takes as long as the rest of a texel.
constexpr std::array<float, 256> kUnorm8 = [] {
  std::array<float, 256> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i) / 255.0f;
  return numbers;
}();

float unorm8(const std::uint8_t* bytes, std::size_t place) { return kUnorm8[bytes[place]]; }
float half_at(const std::uint8_t* bytes, std::size_t place) { return half_value(word_at<std::uint16_t>(bytes, place)); }
float unorm16(const std::uint8_t* bytes, std::size_t place) {
  return static_cast<float>(word_at<std::uint16_t>(bytes, place)) / 65535.0f;
}
float word_bits(const std::uint8_t* bytes, std::size_t place) {
  return number_of(word_at<std::uint32_t>(bytes, place));
}

bool is_integer(TexelFormat format) {
  return format == TexelFormat::R32G32B32A32_UINT || format == TexelFormat::R32G32B32A32_SINT;
}

// Channels that a format lacks are 0, and alpha 1.
Texel decoded(TexelFormat format, const std::uint8_t* bytes) {
  const auto srgb = [bytes](std::size_t place) { return srgb_values()[bytes[place]]; };
  switch (format) {
    case TexelFormat::R8_UNORM:
      return {unorm8(bytes, 0), 0, 0, 1};
    case TexelFormat::R8G8_UNORM:
      return {unorm8(bytes, 0), unorm8(bytes, 1), 0, 1};
    case TexelFormat::R8G8B8A8_UNORM:
      return {unorm8(bytes, 0), unorm8(bytes, 1), unorm8(bytes, 2), unorm8(bytes, 3)};
    case TexelFormat::R8G8B8A8_SRGB:
      return {srgb(0), srgb(1), srgb(2), unorm8(bytes, 3)};
    case TexelFormat::B8G8R8A8_UNORM:
      return {unorm8(bytes, 2), unorm8(bytes, 1), unorm8(bytes, 0), unorm8(bytes, 3)};
    case TexelFormat::B8G8R8A8_SRGB:
      return {srgb(2), srgb(1), srgb(0), unorm8(bytes, 3)};
    case TexelFormat::R16_SFLOAT:
      return {half_at(bytes, 0), 0, 0, 1};
    case TexelFormat::R16G16_SFLOAT:
      return {half_at(bytes, 0), half_at(bytes, 1), 0, 1};
    case TexelFormat::R16G16B16A16_SFLOAT:
      return {half_at(bytes, 0), half_at(bytes, 1), half_at(bytes, 2), half_at(bytes, 3)};
    case TexelFormat::R16G16B16A16_UNORM:
      return {unorm16(bytes, 0), unorm16(bytes, 1), unorm16(bytes, 2), unorm16(bytes, 3)};
    case TexelFormat::R32_SFLOAT:
    case TexelFormat::D32_SFLOAT:
      return {word_bits(bytes, 0), 0, 0, 1};
    default:
      return {word_bits(bytes, 0), word_bits(bytes, 1), word_bits(bytes, 2), word_bits(bytes, 3)};
  }
}

// Channels of a border that the format has; integers are numbers in traces.
Texel border_of(const ProgramSampler& sampler, TexelFormat format) {
  Texel border{sampler.border.r, sampler.border.g, sampler.border.b, sampler.border.a};
  switch (format) {
    case TexelFormat::R8_UNORM:
    case TexelFormat::R16_SFLOAT:
    case TexelFormat::R32_SFLOAT:
    case TexelFormat::D32_SFLOAT:
      border[1] = border[2] = 0, border[3] = 1;
      break;
    case TexelFormat::R8G8_UNORM:
    case TexelFormat::R16G16_SFLOAT:
      border[2] = 0, border[3] = 1;
      break;
    case TexelFormat::R32G32B32A32_UINT:
    case TexelFormat::R32G32B32A32_SINT:
      for (float& channel : border)
        channel = number_of(static_cast<std::uint32_t>(static_cast<std::int64_t>(std::clamp(channel, -2e9f, 4e9f))));
      break;
    default:
      break;
  }
  return border;
}

Texel swizzled(const Texel& texel, const ImageView& view) {
  constexpr std::array<char, 4> kPlain{'r', 'g', 'b', 'a'};
  if (std::bit_cast<std::uint32_t>(view.swizzle) == std::bit_cast<std::uint32_t>(kPlain)) return texel;  // most are
  Texel result{};
  const float one = is_integer(view.image->format) ? number_of(1) : 1.0f;
  for (std::size_t i = 0; i < 4; ++i) {
    const char letter = view.swizzle[i];
    result[i] = letter == 'r'   ? texel[0]
                : letter == 'g' ? texel[1]
                : letter == 'b' ? texel[2]
                : letter == 'a' ? texel[3]
                : letter == '1' ? one
                                : 0.0f;
  }
  return result;
}

// Whole numbers that any place is turned into; what is not a number is 0.
std::int64_t whole(float place) {
  constexpr float kMost = 1e9f;
  return std::isnan(place) ? 0 : static_cast<std::int64_t>(std::floor(std::clamp(place, -kMost, kMost)));
}

std::int64_t remainder_of(std::int64_t place, std::int64_t size) {
  const std::int64_t rest = place % size;
  return rest < 0 ? rest + size : rest;
}

std::int64_t mirrored(std::int64_t n) { return n >= 0 ? n : -(1 + n); }

// -1 and `size` are the border.
std::int64_t wrapped(SamplerWrap wrap, std::int64_t place, std::int64_t size) {
  if (static_cast<std::uint64_t>(place) < static_cast<std::uint64_t>(size)) return place;  // most are
  switch (wrap) {
    case SamplerWrap::repeat:
      return remainder_of(place, size);
    case SamplerWrap::mirror:
      return size - 1 - mirrored(remainder_of(place, 2 * size) - size);
    case SamplerWrap::clamp_to_edge:
      return std::clamp<std::int64_t>(place, 0, size - 1);
    case SamplerWrap::clamp_to_border:
      return std::clamp<std::int64_t>(place, -1, size);
    case SamplerWrap::mirror_clamp:
      return std::clamp<std::int64_t>(mirrored(place), 0, size - 1);
  }
  return 0;
}

// log2(square) / 2, between powers of two a straight line: at most 0.043 too little. Mesa's drivers choose levels with
// it (Mesa 22.3, lp_build_fast_log2), and Vulkan leaves open how near levels are.
float half_log2(float square) {
  int exponent = 0;
  const float fraction = std::frexp(square, &exponent);  // 0.5..1
  if (!(square > 0) || std::isinf(square)) return std::log2(square);
  return 0.5f * (static_cast<float>(exponent - 2) + 2.0f * fraction);
}

std::uint32_t side_at(std::uint32_t side, std::uint32_t level) { return std::max(side >> level, 1u); }

// A place on a face of a cube: (s, t) 0..1, and how they change per pixel.
struct FacePlace {
  std::uint32_t face = 0;
  float s = 0, t = 0;
  std::array<float, 2> dx{}, dy{};
};

struct FaceAxes {
  std::size_t major, s, t;  // axes
  float s_sign, t_sign;
};

// The face that a direction points at; z has precedence over y, and y over x.
std::uint32_t face_of(const std::array<float, 3>& direction) {
  const std::array<float, 3> size{std::abs(direction[0]), std::abs(direction[1]), std::abs(direction[2])};
  const std::size_t major = size[2] >= size[0] && size[2] >= size[1] ? 2 : size[1] >= size[0] ? 1 : 0;
  return static_cast<std::uint32_t>(2 * major + (direction[major] < 0));
}

FaceAxes axes_of(std::uint32_t face) {
  constexpr FaceAxes kAxes[] = {{0, 2, 1, -1, -1}, {0, 2, 1, 1, -1}, {1, 0, 2, 1, 1},
                                {1, 0, 2, 1, -1},  {2, 0, 1, 1, -1}, {2, 0, 1, -1, -1}};
  return kAxes[face];
}

FacePlace face_place(const std::array<float, 3>& direction, const std::array<float, 3>& dx,
                     const std::array<float, 3>& dy) {
  FacePlace found{.face = face_of(direction)};
  const FaceAxes axes = axes_of(found.face);
  const float size = std::abs(direction[axes.major]), sign = direction[axes.major] < 0 ? -1.0f : 1.0f;
  const float s = axes.s_sign * direction[axes.s], t = axes.t_sign * direction[axes.t];
  found.s = 0.5f * (s / size) + 0.5f, found.t = 0.5f * (t / size) + 0.5f;
  const auto slopes = [&](const std::array<float, 3>& d) -> std::array<float, 2> {
    const float of_size = sign * d[axes.major], square = size * size;
    return {0.5f * (size * axes.s_sign * d[axes.s] - s * of_size) / square,
            0.5f * (size * axes.t_sign * d[axes.t] - t * of_size) / square};
  };
  found.dx = slopes(dx), found.dy = slopes(dy);
  return found;
}

// Reads of one view through one sampler.
class ViewReader {
 public:
  // `requests`: where texels are added; null: nowhere.
  ViewReader(const ImageSlot& slot, const ImageView& view, const ProgramSampler& sampler, TexelRequests* requests)
      : slot_(slot), view_(view), image_(*view.image), sampler_(sampler), requests_(requests) {
    texel_bytes_ = texel_bytes(image_.format);
    dimensions_ = slot.dim == spv::Dim1D || slot.dim == spv::DimBuffer ? 1
                  : slot.dim == spv::Dim3D                             ? 3
                                                                       : 2;  // of a cube's face
    is_linear_allowed_ = !is_integer(image_.format);
  }

  bool is_cube() const { return slot_.dim == spv::DimCube; }
  std::size_t dimensions() const { return dimensions_; }
  std::array<std::uint32_t, 3> size_at(std::uint32_t level) const {
    const std::uint32_t l = view_.base_level + level;
    return {side_at(image_.width, l), side_at(image_.height, l), side_at(image_.depth, l)};
  }
  std::uint32_t layers() const { return view_.layers; }
  std::uint32_t most_level() const { return view_.levels - 1; }

  // Without a check of the place.
  Texel texel(std::uint32_t level, std::uint32_t layer, std::int64_t x, std::int64_t y, std::int64_t z) {
    const std::uint32_t l = view_.base_level + level;
    const std::uint64_t width = side_at(image_.width, l), height = side_at(image_.height, l);
    const std::uint64_t slice =
        image_.shape == ImageShape::d3 ? static_cast<std::uint64_t>(z) : std::uint64_t{view_.base_layer} + layer;
    const std::uint64_t place =
        (slice * height + static_cast<std::uint64_t>(y)) * width + static_cast<std::uint64_t>(x);
    if (requests_)
      requests_->read(ProgramTexelRead{.image = view_.number,
                                       .level = l,
                                       .slice = slice,
                                       .x = static_cast<std::uint64_t>(x),
                                       .y = static_cast<std::uint64_t>(y)});
    return swizzled(decoded(image_.format, image_.texels.data() + view_.level_starts[l] + place * texel_bytes_), view_);
  }

  // Where an invocation reads. Of a cube (u, v) are on the face, and the face is added to the layer.
  struct Place {
    std::array<float, 3> at{};
    std::array<std::array<float, 3>, 2> slopes{};  // per pixel to the right and down
    std::uint32_t layer = 0;
    std::array<std::int64_t, 3> offset{};
    bool has_reference = false;
    float reference = 0;
  };

  // Levels: the unclamped one, and the clamped one.
  struct Detail {
    float before = 0, level = 0;
  };
  Detail detail(const Place& place, const float* lod, float bias, const float* least_lod) const {
    Detail found;
    if (sampler_.unnormalized || slot_.dim == spv::DimRect) return found;
    if (lod) {
      found.before = *lod;
    } else {
      const std::array<std::uint32_t, 3> size = size_at(0);
      std::array<float, 2> squares{};
      for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t k = 0; k < dimensions_; ++k) {
          const float texels_per_pixel = place.slopes[i][k] * static_cast<float>(size[k]);
          squares[i] += texels_per_pixel * texels_per_pixel;
        }
      }
      const auto [least, most] = std::minmax(squares[0], squares[1]);
      found.before = half_log2(is_anisotropic() ? least : most);
    }
    found.before += sampler_.lod_bias + bias;
    if (std::isnan(found.before)) found.before = 0;
    const float least = least_lod ? std::max(sampler_.least_lod, *least_lod) : sampler_.least_lod;
    found.level = std::max(std::min(found.before, sampler_.most_lod), least);
    return found;
  }

  Texel sample(const Place& place, const Detail& detail) {
    if (is_anisotropic()) return in_ellipse(place, detail);
    const Filter filter = detail.level > 0 ? sampler_.min : sampler_.mag;
    const bool is_linear = filter == Filter::linear && is_linear_allowed_;
    const float most = static_cast<float>(most_level());
    const float level = std::clamp(detail.level, 0.0f, most);
    const bool mixes = sampler_.mip == Filter::linear && is_linear_allowed_;
    const auto first = mixes ? static_cast<std::uint32_t>(level)
                             : static_cast<std::uint32_t>(std::clamp(std::ceil(level + 0.5f) - 1.0f, 0.0f, most));
    const float share = mixes ? level - static_cast<float>(first) : 0.0f;
    Texel found = in_level(place, first, is_linear);
    if (share > 0) {
      const Texel next = in_level(place, first + 1, is_linear);
      for (std::size_t c = 0; c < 4; ++c) found[c] += share * (next[c] - found[c]);
    }
    return found;
  }

  // Upper left first, row by row, in level 0.
  std::array<Texel, 4> gather(const Place& place) {
    const std::array<std::uint32_t, 3> size = size_at(0);
    const auto [x, share_x] = first_of_two(place, 0, size);
    const auto [y, share_y] = first_of_two(place, 1, size);
    return {at(place, 0, size, x, y, 0), at(place, 0, size, x + 1, y, 0), at(place, 0, size, x, y + 1, 0),
            at(place, 0, size, x + 1, y + 1, 0)};
  }

 private:
  struct Pair {
    std::int64_t first;
    float share;  // of the second one
  };

  // In texels.
  float scaled(const Place& place, std::size_t axis, const std::array<std::uint32_t, 3>& size) const {
    if (sampler_.unnormalized || slot_.dim == spv::DimRect) return place.at[axis];
    return place.at[axis] * static_cast<float>(size[axis]);
  }

  Pair first_of_two(const Place& place, std::size_t axis, const std::array<std::uint32_t, 3>& size) const {
    const float middle = scaled(place, axis, size) - 0.5f;
    const std::int64_t first = whole(middle);
    const float share = middle - std::floor(middle);
    return {first, std::isfinite(share) ? share : 0.0f};
  }

  // On the face of a cube, one at the edge stays there.
  Pair nearest(const Place& place, std::size_t axis, const std::array<std::uint32_t, 3>& size) const {
    const std::int64_t found = whole(scaled(place, axis, size));
    return {is_cube() ? std::clamp<std::int64_t>(found, 0, size[axis] - 1) : found, 0.0f};
  }

  bool is_anisotropic() const {
    return sampler_.anisotropy > 1 && is_linear_allowed_ && dimensions_ > 1 && !sampler_.unnormalized &&
           slot_.dim != spv::DimRect;
  }

  // The mean of a footprint's texels in one level, which is not rounded up; in a volume, in one slice.
  Texel in_ellipse(const Place& place, const Detail& detail) {
    const auto level = static_cast<std::uint32_t>(std::clamp(detail.level, 0.0f, static_cast<float>(most_level())));
    const std::array<std::uint32_t, 3> size = size_at(level);
    std::array<std::array<float, 2>, 2> slopes;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t k = 0; k < 2; ++k) slopes[i][k] = place.slopes[i][k] * static_cast<float>(size[k]);
    const std::array<float, 2> middle{scaled(place, 0, size) - 0.5f, scaled(place, 1, size) - 0.5f};
    const std::int64_t slice = dimensions_ > 2 ? nearest(place, 2, size).first : 0;
    const auto on_face = [&](std::int64_t at) { return is_cube() ? std::clamp<std::int64_t>(at, 0, size[0] - 1) : at; };
    Texel sum{};
    float weights = 0;
    visit_ellipse(middle, slopes, [&](std::int64_t x, std::int64_t y, float weight) {
      const Texel found = at(place, level, size, on_face(x), on_face(y), slice);
      for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * found[c];
      weights += weight;
    });
    for (float& channel : sum) channel /= weights;
    return sum;
  }

  Texel in_level(const Place& place, std::uint32_t level, bool is_linear) {
    const std::array<std::uint32_t, 3> size = size_at(level);
    std::array<Pair, 3> pairs{};
    for (std::size_t axis = 0; axis < dimensions_; ++axis)
      pairs[axis] = is_linear ? first_of_two(place, axis, size) : nearest(place, axis, size);
    const int count = is_linear ? 1 << dimensions_ : 1;
    std::array<Texel, 8> corners;
    for (int i = 0; i < count; ++i)
      corners[static_cast<std::size_t>(i)] =
          at(place, level, size, pairs[0].first + (i & 1), pairs[1].first + (i >> 1 & 1), pairs[2].first + (i >> 2));
    for (std::size_t axis = 0, left = static_cast<std::size_t>(count) / 2; left > 0; ++axis, left /= 2)
      for (std::size_t i = 0; i < left; ++i)
        for (std::size_t c = 0; c < 4; ++c)
          corners[i][c] = corners[2 * i][c] + pairs[axis].share * (corners[2 * i + 1][c] - corners[2 * i][c]);
    return corners[0];
  }

  // A texel before it is wrapped, compared with the reference if there is one.
  Texel at(const Place& place, std::uint32_t level, const std::array<std::uint32_t, 3>& size, std::int64_t x,
           std::int64_t y, std::int64_t z) {
    const Texel found =
        is_cube() ? on_cube(place.layer, level, size[0], x, y) : wrapped_texel(place, level, size, {x, y, z});
    if (!place.has_reference) return found;
    const float result = passes(sampler_.compare.value_or(Compare::always), place.reference, found[0]) ? 1.0f : 0.0f;
    return {result, result, result, 1.0f};
  }

  Texel wrapped_texel(const Place& place, std::uint32_t level, const std::array<std::uint32_t, 3>& size,
                      std::array<std::int64_t, 3> to) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axis >= dimensions_) {
        to[axis] = 0;
        continue;
      }
      const std::int64_t side = size[axis];
      to[axis] = wrapped(sampler_.wrap[axis], to[axis] + place.offset[axis], side);
      if (to[axis] < 0 || to[axis] >= side) return swizzled(border_of(sampler_, image_.format), view_);
    }
    return texel(level, place.layer, to[0], to[1], to[2]);
  }

  // `layer`: six times the cube, and the face. Beyond an edge is the face on the other side; beyond a corner the mean
  // of the three texels that meet there.
  Texel on_cube(std::uint32_t layer, std::uint32_t level, std::uint32_t size, std::int64_t x, std::int64_t y) {
    const std::int64_t side = size;
    x = std::clamp<std::int64_t>(x, -1, side), y = std::clamp<std::int64_t>(y, -1, side);
    const bool out_x = x < 0 || x == side, out_y = y < 0 || y == side;
    if (!out_x && !out_y) return texel(level, layer, x, y, 0);
    if (out_x && out_y) {
      const std::int64_t near_x = std::clamp<std::int64_t>(x, 0, side - 1),
                         near_y = std::clamp<std::int64_t>(y, 0, side - 1);
      const Texel corners[] = {texel(level, layer, near_x, near_y, 0), on_cube(layer, level, size, x, near_y),
                               on_cube(layer, level, size, near_x, y)};
      Texel mean{};
      for (std::size_t c = 0; c < 4; ++c) mean[c] = (corners[0][c] + corners[1][c] + corners[2][c]) / 3.0f;
      return mean;
    }
    const FaceAxes axes = axes_of(layer % 6);
    const auto across = [&](std::int64_t place) {
      return 2.0f * (static_cast<float>(place) + 0.5f) / static_cast<float>(size) - 1.0f;
    };
    std::array<float, 3> direction{};
    direction[axes.major] = layer % 2 ? -1.0f : 1.0f;
    direction[axes.s] = axes.s_sign * across(x), direction[axes.t] = axes.t_sign * across(y);
    const FacePlace other = face_place(direction, {}, {});
    const auto nearest = [&](float share) {
      return std::clamp<std::int64_t>(whole(share * static_cast<float>(size)), 0, side - 1);
    };
    return texel(level, layer - layer % 6 + other.face, nearest(other.s), nearest(other.t), 0);
  }

  const ImageSlot& slot_;
  const ImageView& view_;
  const ProgramImage& image_;
  const ProgramSampler& sampler_;
  TexelRequests* requests_;
  std::uint64_t texel_bytes_ = 0;
  std::size_t dimensions_ = 2;
  bool is_linear_allowed_ = true;
};

// One invocation's operands.
class LaneRequest {
 public:
  LaneRequest(const ImageRequest& request, std::size_t lane) : request_(request), lane_(lane) {}

  float number(const LaneRow* row) const { return row ? row->number(lane_) : 0.0f; }
  std::int64_t integer(const LaneRow* row) const { return row ? static_cast<std::int32_t>(row->bits[lane_]) : 0; }

  ViewReader::Place place(const ViewReader& reader, bool is_arrayed) const {
    ViewReader::Place found;
    const std::size_t numbers = reader.is_cube() ? 3 : reader.dimensions();
    std::array<float, 3> at{}, dx{}, dy{};
    for (std::size_t i = 0; i < numbers; ++i)
      at[i] = number(request_.coordinates[i]), dx[i] = number(request_.dx[i]), dy[i] = number(request_.dy[i]);
    const std::uint32_t layers = reader.is_cube() ? reader.layers() / 6 : reader.layers();
    if (is_arrayed && layers > 0) {
      const float layer = std::nearbyint(number(request_.coordinates[numbers]));
      found.layer = static_cast<std::uint32_t>(std::clamp<std::int64_t>(whole(layer), 0, layers - 1));
    }
    if (reader.is_cube()) {
      const FacePlace on_face = face_place(at, dx, dy);
      at = {on_face.s, on_face.t, 0}, dx = {on_face.dx[0], on_face.dx[1], 0}, dy = {on_face.dy[0], on_face.dy[1], 0};
      found.layer = 6 * found.layer + on_face.face;
    }
    found.at = at, found.slopes = {dx, dy};
    for (std::size_t i = 0; i < 3; ++i) found.offset[i] = integer(request_.offset[i]);
    if (request_.reference) {
      found.has_reference = true;
      found.reference = std::clamp(number(request_.reference), 0.0f, 1.0f);
    }
    return found;
  }

  ViewReader::Detail detail(const ViewReader& reader, const ViewReader::Place& place) const {
    const float lod = number(request_.lod), least = number(request_.least_lod);
    return reader.detail(place, request_.lod ? &lod : nullptr, number(request_.bias),
                         request_.least_lod ? &least : nullptr);
  }

 private:
  const ImageRequest& request_;
  std::size_t lane_;
};

std::array<std::uint32_t, 4> bits_of(const Texel& texel) { return std::bit_cast<std::array<std::uint32_t, 4>>(texel); }

// Outside of the image, texels are 0.
Texel fetched(const LaneRequest& lane, const ImageRequest& request, const ImageSlot& slot, ViewReader& reader) {
  const std::int64_t level = request.lod ? lane.integer(request.lod) : 0;
  if (level < 0 || level > reader.most_level()) return {};
  const std::array<std::uint32_t, 3> size = reader.size_at(static_cast<std::uint32_t>(level));
  std::array<std::int64_t, 3> at{};
  for (std::size_t i = 0; i < reader.dimensions(); ++i) {
    at[i] = lane.integer(request.coordinates[i]) + lane.integer(request.offset[i]);
    if (at[i] < 0 || at[i] >= size[i]) return {};
  }
  const std::int64_t layer = slot.arrayed ? lane.integer(request.coordinates[reader.dimensions()]) : 0;
  if (layer < 0 || layer >= reader.layers()) return {};
  return reader.texel(static_cast<std::uint32_t>(level), static_cast<std::uint32_t>(layer), at[0], at[1], at[2]);
}

std::array<std::uint32_t, 4> size_of(const LaneRequest& lane, const ImageRequest& request, const ImageSlot& slot,
                                     const ViewReader& reader) {
  const std::int64_t level =
      std::clamp<std::int64_t>(request.lod ? lane.integer(request.lod) : 0, 0, reader.most_level());
  const std::array<std::uint32_t, 3> size = reader.size_at(static_cast<std::uint32_t>(level));
  std::array<std::uint32_t, 4> result{};
  for (std::size_t i = 0; i < reader.dimensions(); ++i) result[i] = size[i];
  if (slot.arrayed) result[reader.dimensions()] = reader.is_cube() ? reader.layers() / 6 : reader.layers();
  return result;
}

// Does the image have the dimensions that the shader expects?
bool fits(const ImageSlot& slot, const ImageView& view) {
  const ImageShape shape = view.image->shape;
  switch (slot.dim) {
    case spv::Dim1D:
    case spv::DimBuffer:
      return shape == ImageShape::d1;
    case spv::Dim3D:
      return shape == ImageShape::d3;
    case spv::DimCube:
      return (shape == ImageShape::cube || shape == ImageShape::d2) && view.image->width == view.image->height &&
             view.layers >= 6;
    default:
      return shape == ImageShape::d2 || shape == ImageShape::cube || shape == ImageShape::d1;
  }
}

std::array<std::uint32_t, 4> answer(const LaneRequest& lane, const ImageRequest& request, const ImageSlot& slot,
                                    ViewReader& reader) {
  switch (request.action) {
    case ImageAction::fetch:
      return bits_of(fetched(lane, request, slot, reader));
    case ImageAction::query_size:
      return size_of(lane, request, slot, reader);
    case ImageAction::query_levels:
      return {reader.most_level() + 1};
    default:
      break;
  }
  const ViewReader::Place place = lane.place(reader, slot.arrayed);
  if (request.action == ImageAction::gather) {
    const auto [upper_left, upper_right, lower_left, lower_right] = reader.gather(place);
    const std::size_t c = request.component;
    return bits_of({lower_left[c], lower_right[c], upper_right[c], upper_left[c]});
  }
  const ViewReader::Detail detail = lane.detail(reader, place);
  if (request.action == ImageAction::query_lod)
    return bits_of({std::clamp(detail.level, 0.0f, static_cast<float>(reader.most_level())), detail.before, 0, 0});
  return bits_of(reader.sample(place, detail));
}

}  // namespace

BoundImages bound_images(const LaneProgram& program, const std::vector<BoundImage>& bound,
                         const std::vector<ProgramImage>& images, const std::vector<ProgramSampler>& samplers) {
  const auto elements_of = [&](const auto& slot, auto&& visit) {
    for (const BoundImage& each : bound)
      if (each.set == slot.set && each.binding == slot.binding) visit(each);
  };
  constexpr std::uint32_t kMostElements = 1 << 16;
  BoundImages found;
  for (const ImageSlot& slot : program.images) {
    std::vector<ImageView>& views = found.images.emplace_back();
    elements_of(slot, [&](const BoundImage& each) {
      if (!each.image || each.element >= kMostElements) return;
      if (each.element >= views.size()) views.resize(each.element + 1);
      ImageView& view = views[each.element];
      view.image = &images[*each.image], view.number = *each.image;
      if (each.sampler) view.sampler = &samplers[*each.sampler];
      view.base_level = each.base_level, view.levels = each.levels.value_or(view.image->levels - each.base_level);
      view.base_layer = each.base_layer, view.layers = each.layers.value_or(view.image->layers - each.base_layer);
      std::copy_n(each.swizzle.begin(), 4, view.swizzle.begin());
      for (std::uint32_t level = 0; level < view.image->levels; ++level)
        view.level_starts.push_back(level_start(*view.image, level));
      if (!fits(slot, view)) view = {};
    });
  }
  for (const SamplerSlot& slot : program.samplers) {
    std::vector<const ProgramSampler*>& elements = found.samplers.emplace_back();
    elements_of(slot, [&](const BoundImage& each) {
      if (!each.sampler || each.element >= kMostElements) return;
      if (each.element >= elements.size()) elements.resize(each.element + 1);
      elements[each.element] = &samplers[*each.sampler];
    });
  }
  return found;
}

void ProgramImages::read(const ImageRequest& request, const std::array<LaneRow*, 4>& texel) {
  constexpr std::size_t kLanesOfRequest = 4;
  static const ProgramSampler kNoSampler{.mag = Filter::nearest, .min = Filter::nearest, .mip = Filter::nearest};
  const ImageSlot& slot = program_.images[request.image];
  const std::vector<ImageView>& views = bound_.images[request.image];
  const auto element_of = [](const LaneRow* row, std::size_t lane) { return row ? row->bits[lane] : 0u; };
  for (std::size_t lane = 0; lane < request.lanes; ++lane) {
    if (lane % kLanesOfRequest == 0) end_request(requests_);
    if (!request.asks(lane)) continue;
    std::array<std::uint32_t, 4> bits{};
    const std::uint32_t element = element_of(request.image_element, lane);
    if (element < views.size() && views[element].image) {
      const ImageView& view = views[element];
      const ProgramSampler* sampler = view.sampler;
      if (request.sampler != kNoRow) {
        const auto& samplers = bound_.samplers[request.sampler];
        const std::uint32_t number = element_of(request.sampler_element, lane);
        sampler = number < samplers.size() ? samplers[number] : nullptr;
      }
      ViewReader reader(slot, view, sampler ? *sampler : kNoSampler, counted_ >> lane & 1 ? requests_ : nullptr);
      bits = answer({request, lane}, request, slot, reader);
    }
    for (std::size_t c = 0; c < 4; ++c) texel[c]->bits[lane] = bits[c];
  }
  end_request(requests_);
}

}  // namespace beampipe

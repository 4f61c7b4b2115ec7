#include "tools/evaluate/flip.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "tools/evaluate/bands.h"
#include "tools/evaluate/planes.h"
#include "tools/evaluate/powers.h"

namespace beampipe {
namespace {

constexpr double kPi = 3.14159265358979324;

// From linear RGB to XYZ, each divided by that of white (D65). Section 4.1.1 of the paper on LDR-FLIP uses the matrix
// of sRGB in whole numbers; its denominators cancel here.
struct Xyz {
  double x, y, z;
};
Xyz xyz_of(double r, double g, double b) {
  return {(10135552 * r + 8788810 * g + 4435075 * b) * (1.0 / 23359437),
          (2613072 * r + 8788810 * g + 887015 * b) * (1.0 / 12288897),
          (1425312 * r + 8788810 * g + 70074185 * b) * (1.0 / 80288307)};
}

// The inverse of that: columns of R, G and B by x, y and z.
glm::dmat3 rgb_from_xyz() {
  const Xyz r = xyz_of(1, 0, 0), g = xyz_of(0, 1, 0), b = xyz_of(0, 0, 1);
  return glm::inverse(glm::dmat3(r.x, r.y, r.z, g.x, g.y, g.z, b.x, b.y, b.z));
}

// A picture in the opponent space YCxCz, without its scales and offset, as weights of filters add up to 1:
// Y = 116 y - 16, Cx = 500 cx, Cz = 200 cz.
struct Opponent {
  Plane<float> y, cx, cz;
};

double clamped(double value) { return value < 0 ? 0.0 : value > 1 ? 1.0 : value; }

// `light(value)` gives the linear light that is seen, 0..1.
template <class LightOf>
Opponent opponent_of(const Image& image, LightOf light) {
  const Plane<float> empty{image.width, image.height, std::vector<float>(image.rgba.size() / 4)};
  Opponent opponent{empty, empty, empty};
  for (std::size_t i = 0; i < empty.values.size(); ++i) {
    const float* const rgba = image.rgba.data() + 4 * i;
    const auto [x, y, z] = xyz_of(light(rgba[0]), light(rgba[1]), light(rgba[2]));
    opponent.y.values[i] = static_cast<float>(y);
    opponent.cx.values[i] = static_cast<float>(x - y);
    opponent.cz.values[i] = static_cast<float>(y - z);
  }
  return opponent;
}

// e^(-x^2 scale) for x = -radius..radius
std::vector<double> gaussian(int radius, double scale) {
  std::vector<double> weights;
  for (int x = -radius; x <= radius; ++x) weights.push_back(exp2_of(std::max(-1000.0, -x * x * scale / kLn2)));
  return weights;
}

double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

std::vector<float> scaled(const std::vector<double>& values, double factor) {
  std::vector<float> result;
  for (const double value : values) result.push_back(static_cast<float>(value * factor));
  return result;
}

// Of the contrast sensitivity functions (Table 1), whose Gaussians are a sqrt(pi / b) e^(-pi^2 x^2 / b), x in degrees.
// That of Cz is a sum of two; both are normalised together.
struct SpatialFilters {
  std::uint32_t radius;
  std::vector<float> y, cx, cz1, cz2;

  explicit SpatialFilters(double pixels_per_degree) {
    constexpr double kY = 0.0047, kCx = 0.0053, kA1 = 34.1, kB1 = 0.04, kA2 = 13.5, kB2 = 0.025;
    radius = static_cast<std::uint32_t>(std::ceil(3 * std::sqrt(kB1 / (2 * kPi * kPi)) * pixels_per_degree));
    const auto falling = [&](double b) {
      return gaussian(static_cast<int>(radius), kPi * kPi / (b * pixels_per_degree * pixels_per_degree));
    };
    const std::vector<double> of_y = falling(kY), of_cx = falling(kCx), one = falling(kB1), two = falling(kB2);
    y = scaled(of_y, 1 / sum_of(of_y));
    cx = scaled(of_cx, 1 / sum_of(of_cx));
    // The weight of a Gaussian in two dimensions is the square of that of its rows and columns.
    const double weight1 = kA1 * std::sqrt(kPi / kB1), weight2 = kA2 * std::sqrt(kPi / kB2);
    const double all = weight1 * sum_of(one) * sum_of(one) + weight2 * sum_of(two) * sum_of(two);
    cz1 = scaled(one, std::sqrt(weight1 / all));
    cz2 = scaled(two, std::sqrt(weight2 / all));
  }
};

Opponent seen(const Opponent& picture, const SpatialFilters& filters) {
  Opponent result{filtered(picture.y, filters.y, filters.y), filtered(picture.cx, filters.cx, filters.cx),
                  filtered(picture.cz, filters.cz1, filters.cz1)};
  const Plane<float> more = filtered(picture.cz, filters.cz2, filters.cz2);
  for (std::size_t i = 0; i < more.values.size(); ++i) result.cz.values[i] += more.values[i];
  return result;
}

// L*a*b* with the Hunt effect: a and b times L / 100.
struct Lab {
  double l, a, b;
};

double lab_curve(double t) {
  constexpr double kDelta = 6.0 / 29;
  const double root = power(t, 1.0 / 3);
  return t > kDelta * kDelta * kDelta ? root : t / (3 * kDelta * kDelta) + 4.0 / 29;
}

[[gnu::always_inline]] inline Lab lab_of(double r, double g, double b) {
  const auto [x, y, z] = xyz_of(r, g, b);
  const double fx = lab_curve(x), fy = lab_curve(y), fz = lab_curve(z);
  const double l = 116 * fy - 16, hunt = 0.01 * l;
  return {l, hunt * (500 * (fx - fy)), hunt * (200 * (fy - fz))};
}

// HyAB: city block in lightness, Euclidean in chroma.
double hyab(const Lab& a, const Lab& b) {
  const double da = a.a - b.a, db = a.b - b.b;
  return std::abs(a.l - b.l) + std::sqrt(da * da + db * db);
}

// Section 4.1.4: the distance of two colours, 0..1. `largest` is that of green and blue to the power of 0.7.
double color_difference(double distance, double largest) {
  constexpr double kPc = 0.4, kPt = 0.95;
  const double d = power(distance, 0.7), knee = kPc * largest;
  const double below = d * (kPt / knee), above = kPt + (d - knee) / (largest - knee) * (1 - kPt);
  return d < knee ? below : above;
}

[[gnu::always_inline]] inline Lab lab_of_opponent(const glm::dmat3& rgb, double y, double cx, double cz) {
  const double x = y + cx, z = y - cz;
  return lab_of(clamped(rgb[0][0] * x + rgb[1][0] * y + rgb[2][0] * z),
                clamped(rgb[0][1] * x + rgb[1][1] * y + rgb[2][1] * z),
                clamped(rgb[0][2] * x + rgb[1][2] * y + rgb[2][2] * z));
}

std::vector<float> color_differences(const Opponent& a, const Opponent& b) {
  const double largest = power(hyab(lab_of(0, 1, 0), lab_of(0, 0, 1)), 0.7);
  const glm::dmat3 rgb = rgb_from_xyz();
  std::vector<float> differences(a.y.values.size());
  const float *const ya = a.y.values.data(), *const xa = a.cx.values.data(), *const za = a.cz.values.data();
  const float *const yb = b.y.values.data(), *const xb = b.cx.values.data(), *const zb = b.cz.values.data();
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const Lab lab_a = lab_of_opponent(rgb, ya[i], xa[i], za[i]), lab_b = lab_of_opponent(rgb, yb[i], xb[i], zb[i]);
    differences[i] = static_cast<float>(color_difference(hyab(lab_a, lab_b), largest));
  }
  return differences;
}

// How strong edges and points are in the plane y: the lengths of the gradients that Gaussians and their first and
// second derivatives find (Section 4.2). The standard deviation is half of 0.082 degrees.
struct Features {
  std::vector<float> edges, points;
};

struct FeatureFilters {
  std::uint32_t radius;
  std::vector<float> smooth, first, second;

  explicit FeatureFilters(double pixels_per_degree) {
    const double deviation = 0.5 * 0.082 * pixels_per_degree;
    const int reach = static_cast<int>(std::ceil(3 * deviation));
    radius = static_cast<std::uint32_t>(reach);
    const std::vector<double> weights = gaussian(reach, 1 / (2 * deviation * deviation));
    std::vector<double> slopes, bends;
    for (int x = -reach; x <= reach; ++x) {
      const double weight = weights[static_cast<std::size_t>(x + reach)];
      slopes.push_back(-x * weight);
      bends.push_back((x * x / (deviation * deviation) - 1) * weight);
    }
    smooth = scaled(weights, 1 / sum_of(weights));
    first = balanced(slopes);
    second = balanced(bends);
  }

  // The positive weights add up to 1, and the negative ones to -1.
  static std::vector<float> balanced(const std::vector<double>& weights) {
    double above = 0, below = 0;
    for (const double weight : weights) (weight > 0 ? above : below) += std::abs(weight);
    std::vector<float> result;
    for (const double weight : weights) result.push_back(static_cast<float>(weight / (weight > 0 ? above : below)));
    return result;
  }
};

std::vector<float> lengths(const Plane<float>& x, const Plane<float>& y) {
  std::vector<float> result(x.values.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = std::sqrt(x.values[i] * x.values[i] + y.values[i] * y.values[i]);
  return result;
}

Features features_of(const Plane<float>& y, const FeatureFilters& filters) {
  const auto& [radius, smooth, first, second] = filters;
  return {lengths(filtered(y, first, smooth), filtered(y, smooth, first)),
          lengths(filtered(y, second, smooth), filtered(y, smooth, second))};
}

struct Filters {
  SpatialFilters spatial;
  FeatureFilters features;

  explicit Filters(double pixels_per_degree) : spatial(pixels_per_degree), features(pixels_per_degree) {}
  std::uint32_t radius() const { return std::max(spatial.radius, features.radius); }
};

std::vector<float> flip_of(const Opponent& image, const Opponent& reference, const Filters& filters) {
  std::vector<float> map = color_differences(seen(image, filters.spatial), seen(reference, filters.spatial));
  const Features a = features_of(image.y, filters.features), b = features_of(reference.y, filters.features);
  const double half_root = std::sqrt(0.5);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const float edge = std::abs(a.edges[i] - b.edges[i]), point = std::abs(a.points[i] - b.points[i]);
    const double feature = std::sqrt(half_root * (edge > point ? edge : point));
    map[i] = static_cast<float>(power(map[i], 1 - feature));
  }
  return map;
}

// The tone mapper ACES as K. Narkowicz approximates it, without its exposure of 0.6: a rational function.
constexpr double kAces[] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

double aces(double x) {
  return clamped(((kAces[0] * x + kAces[1]) * x + kAces[2]) / ((kAces[3] * x + kAces[4]) * x + kAces[5]));
}

double within_range(double value) { return value < 0 ? 0.0 : value > 65536 ? 65536.0 : value; }

}  // namespace

std::vector<float> flip_map(const Image& image, const Image& reference, double pixels_per_degree) {
  const Filters filters(pixels_per_degree);
  return map_in_bands<float>(image, reference, filters.radius(), [&](const Image& a, const Image& b) {
    return flip_of(opponent_of(a, clamped), opponent_of(b, clamped), filters);
  });
}

Exposures exposures_for(const Image& reference) {
  std::vector<double> luminances;
  for (std::size_t i = 0; i < reference.rgba.size(); i += 4) {
    const float* const rgba = reference.rgba.data() + i;
    luminances.push_back(0.2126 * within_range(rgba[0]) + 0.7152 * within_range(rgba[1]) +
                         0.0722 * within_range(rgba[2]));
  }
  std::sort(luminances.begin(), luminances.end());
  if (luminances.empty() || luminances.back() <= 0) return {};
  double median = luminances[luminances.size() / 2];
  if (median <= 0) {
    const auto first = std::upper_bound(luminances.begin(), luminances.end(), 0.0);
    median = *(first + (luminances.end() - first) / 2);
  }
  // aces(x) = 0.85
  const double a = kAces[0] - 0.85 * kAces[3], b = kAces[1] - 0.85 * kAces[4], c = kAces[2] - 0.85 * kAces[5];
  const double bright = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
  const double start = log2_of(bright / luminances.back()), stop = log2_of(bright / median);
  return {start, stop, static_cast<int>(std::max(2.0, std::ceil(stop - start)))};
}

std::vector<float> hdr_flip_map(const Image& image, const Image& reference, double pixels_per_degree) {
  const Filters filters(pixels_per_degree);
  const Exposures exposures = exposures_for(reference);
  return map_in_bands<float>(image, reference, filters.radius(), [&](const Image& a, const Image& b) {
    std::vector<float> largest(a.rgba.size() / 4);
    for (int i = 0; i < exposures.count; ++i) {
      const double part = exposures.count > 1 ? static_cast<double>(i) / (exposures.count - 1) : 0.0;
      const double factor = exp2_of(exposures.start + part * (exposures.stop - exposures.start));
      const auto light = [&](double value) { return aces(factor * within_range(value)); };
      const std::vector<float> map = flip_of(opponent_of(a, light), opponent_of(b, light), filters);
      for (std::size_t at = 0; at < map.size(); ++at) largest[at] = std::max(largest[at], map[at]);
    }
    return largest;
  });
}

double mean_of(const std::vector<float>& map, std::uint32_t width) {
  double sum = 0;
  for (std::size_t row = 0; row < map.size(); row += width) {
    double row_sum = 0;
    for (std::size_t x = 0; x < width; ++x) row_sum += map[row + x];
    sum += row_sum;
  }
  return sum / static_cast<double>(map.size());
}

}  // namespace beampipe

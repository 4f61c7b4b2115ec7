// The formulas of stages/surface/surface_points.h, for numbers and for vectors. No include guard: see simd/scalar.h.

template <class Real>
Barycentrics<Real> limited_to_triangle(const Barycentrics<Real>& weights) {
  const auto limited = [](const Real& value, const Real& most) {
    const Real zero(0.0f);
    return select(value < zero, zero, select(most < value, most, value));
  };
  const Real one(1.0f), second = limited(weights.second, one);
  return {second, limited(weights.third, one - second)};
}

// rows.get<Columns>(row_of) gives what row_of(triangle) refers to, for the triangle of each lane.
template <class Real, class Int, class Rows>
class SurfacePoint {
 public:
  SurfacePoint(const SetupTriangles& triangles, const Rows& rows, const InvocationOf<Real, Int>& at,
               const PointRules& rules)
      : triangles_(triangles), rows_(rows), at_(at), rules_(rules) {
    anchor_x_ = of_surface<Real>([](const SetupSurface& surface) -> auto& { return surface.anchor_x; });
    anchor_y_ = of_surface<Real>([](const SetupSurface& surface) -> auto& { return surface.anchor_y; });
    planes_ = of_surface<BarycentricPlanes<Real>>([](const SetupSurface& surface) -> auto& { return surface.planes; });
    column_ = to_float(at.x), row_ = to_float(at.y);
    const Real half(0.5f);
    x_ = column_ + (rules.at_centres ? half : at.u) - anchor_x_;
    y_ = row_ + (rules.at_centres ? half : at.v) - anchor_y_;
    weights_ = weights_at(planes_, x_, y_);
    if (rules.at_centres) weights_ = limited_to_triangle(weights_);
  }

  // Sets what the shader needs besides textures.
  void set_inputs(const ShaderInputs& shader, PointInputs<Real>& inputs) const {
    static constexpr float kFacing[2] = {1.0f, -1.0f};
    TriangleInputs<Real> triangle{};
    if (shader.has_own_normal)
      triangle.own_normal = rows_.template get<Triple<Real>>(
          [&](std::uint32_t i) -> const glm::vec3& { return triangles_.attributes[i].normal; });
    triangle.facing =
        of_surface<Real>([](const SetupSurface& surface) -> const float& { return kFacing[surface.turned]; });
    if (shader.material.normal_texture) {
      const auto tangent =
          of_surface<std::array<Real, 4>>([](const SetupSurface& surface) -> auto& { return surface.tangent; });
      triangle.tangent = {tangent[0], tangent[1], tangent[2]};
      triangle.tangent_sign = shader.has_tangents
                                  ? of_vertex<Real>(
                                        0, [](const SurfaceVertex& vertex) -> auto& { return vertex.tangent_sign; })
                                  : tangent[3];
    }
    const auto attribute = [&](const auto& member_of) {
      using Row = std::remove_cvref_t<decltype(member_of(triangles_.vertices[0]))>;
      using Columns = std::array<Real, std::tuple_size_v<Row>>;
      Columns found = of_vertex<Columns>(0, member_of);
      const Columns second = of_vertex<Columns>(1, member_of), third = of_vertex<Columns>(2, member_of);
      for (std::size_t i = 0; i < found.size(); ++i) found[i] = interpolated(found[i], second[i], third[i], weights_);
      return found;
    };
    set_attributes(shader, triangle, attribute, inputs);
  }

  // Where textures with this set of coordinates are read, and how that changes along the sides of the footprint.
  TexturePlace<Real> place(std::size_t set) const {
    std::array<std::array<Real, 2>, 3> uvs;
    for (std::size_t k = 0; k < 3; ++k)
      uvs[k] = of_vertex<std::array<Real, 2>>(
          k, [set](const SurfaceVertex& vertex) -> auto& { return vertex.uvs[set]; });
    if (rules_.at_centres) return place_on_triangle(uvs, planes_, x_, y_, weights_);
    const TexturePlace<Real> place =
        rules_.in_quads ? place_in_quad(uvs) : place_on_triangle(uvs, planes_, x_, y_, weights_);
    return along_sides(place, at_.footprint_xx, at_.footprint_xy, at_.footprint_yy);
  }

 private:
  template <class Columns, class MemberOf>
  Columns of_surface(const MemberOf& member_of) const {
    return rows_.template get<Columns>([&](std::uint32_t i) -> auto& { return member_of(triangles_.surfaces[i]); });
  }
  template <class Columns, class MemberOf>
  Columns of_vertex(std::size_t k, const MemberOf& member_of) const {
    return rows_.template get<Columns>([&](std::uint32_t i) -> auto& {
      return member_of(triangles_.vertices[triangles_.surfaces[i].vertices[k]]);
    });
  }

  std::array<Real, 2> uv(const std::array<std::array<Real, 2>, 3>& uvs, const Barycentrics<Real>& weights) const {
    return {interpolated(uvs[0][0], uvs[1][0], uvs[2][0], weights),
            interpolated(uvs[0][1], uvs[1][1], uvs[2][1], weights)};
  }

  // Slopes between the centres of the pixel and of its neighbours in the quad.
  TexturePlace<Real> place_in_quad(const std::array<std::array<Real, 2>, 3>& uvs) const {
    const Int one(1);
    const Real half(0.5f), forwards(1.0f), backwards(-1.0f);
    const auto is_right = (at_.x & one) == one, is_lower = (at_.y & one) == one;
    const auto uv_at = [&](const Real& column, const Real& row) {
      return uv(uvs, weights_at(planes_, column + half - anchor_x_, row + half - anchor_y_));
    };
    const auto here = uv_at(column_, row_), beside = uv_at(column_ + select(is_right, backwards, forwards), row_),
               above_or_below = uv_at(column_, row_ + select(is_lower, backwards, forwards));
    TexturePlace<Real> place{uv(uvs, weights_), {}, {}};
    for (std::size_t c = 0; c < 2; ++c) {
      place.dx[c] = select(is_right, here[c] - beside[c], beside[c] - here[c]);
      place.dy[c] = select(is_lower, here[c] - above_or_below[c], above_or_below[c] - here[c]);
    }
    return place;
  }

  const SetupTriangles& triangles_;
  const Rows& rows_;
  const InvocationOf<Real, Int>& at_;
  const PointRules& rules_;
  Real anchor_x_, anchor_y_, column_, row_;
  Real x_, y_;  // pixels from the anchor
  BarycentricPlanes<Real> planes_;
  Barycentrics<Real> weights_;
};

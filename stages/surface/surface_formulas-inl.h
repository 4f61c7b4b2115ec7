// The formulas of stages/surface/surface_formulas.h that are computed for several points at once. No include guard: see
// simd/scalar.h.

// A vertex attribute at a point of the triangle.
template <class Real>
Real interpolated(const Real& first, const Real& second, const Real& third, const Barycentrics<Real>& weights) {
  return first + weights.second * (second - first) + weights.third * (third - first);
}

// How an attribute changes.
template <class Real>
Real interpolated_slope(const Real& first, const Real& second, const Real& third, const Barycentrics<Real>& slopes) {
  return slopes.second * (second - first) + slopes.third * (third - first);
}

// Texture coordinates at a point of a triangle and how they change, from the triangle's planes. `uvs`: of the vertices.
template <class Real>
TexturePlace<Real> place_on_triangle(const std::array<std::array<Real, 2>, 3>& uvs,
                                     const BarycentricPlanes<Real>& planes, const Real& x, const Real& y,
                                     const Barycentrics<Real>& weights) {
  const std::array<Barycentrics<Real>, 2> slopes = weight_slopes(planes, x, y, weights);
  TexturePlace<Real> found;
  for (std::size_t c = 0; c < 2; ++c) {
    found.uv[c] = interpolated(uvs[0][c], uvs[1][c], uvs[2][c], weights);
    found.dx[c] = interpolated_slope(uvs[0][c], uvs[1][c], uvs[2][c], slopes[0]);
    found.dy[c] = interpolated_slope(uvs[0][c], uvs[1][c], uvs[2][c], slopes[1]);
  }
  return found;
}

// How texture coordinates change along the sides of a footprint, in place of per pixel. `right`, `down`, `height`: xx,
// xy and yy of the Footprint.
template <class Real>
TexturePlace<Real> along_sides(TexturePlace<Real> place, const Real& right, const Real& down, const Real& height) {
  for (std::size_t c = 0; c < 2; ++c) {
    const Real straight = place.dx[c] * right;
    place.dx[c] = select(down == Real(0.0f), straight, straight + place.dy[c] * down);
    place.dy[c] = place.dy[c] * height;
  }
  return place;
}

// Sets what the material needs of the triangle and its vertices. attribute(member_of) gives what member_of(vertex)
// returns of the three vertices, interpolated.
template <class Real, class Attribute>
void set_attributes(const ShaderInputs& shader, const TriangleInputs<Real>& triangle, const Attribute& attribute,
                    PointInputs<Real>& found) {
  if (shader.has_vertex_colors) found.color = attribute([](const auto& vertex) -> auto& { return vertex.color; });
  if (shader.material.unlit) return;
  found.to_eye = attribute([](const auto& vertex) -> auto& { return vertex.to_eye; });
  found.normal = shader.has_own_normal ? triangle.own_normal
                                       : attribute([](const auto& vertex) -> auto& { return vertex.normal; });
  found.facing = triangle.facing;
  if (!shader.material.normal_texture) return;
  found.tangent =
      shader.has_tangents ? attribute([](const auto& vertex) -> auto& { return vertex.tangent; }) : triangle.tangent;
  found.tangent_sign = triangle.tangent_sign;
}

template <class Real>
Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Real>
Triple<Real> cross(const Triple<Real>& a, const Triple<Real>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class Real>
Triple<Real> scaled(const Triple<Real>& a, const Real& by) {
  return {a[0] * by, a[1] * by, a[2] * by};
}

template <class Real>
Triple<Real> sum(const Triple<Real>& a, const Triple<Real>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

// 0 stays 0.
template <class Real>
Triple<Real> unit(const Triple<Real>& a) {
  return scaled(a, Real(1.0f) / square_root(greater(dot(a, a), Real(1e-30f))));
}

template <class Real>
Real length(const Triple<Real>& a) {
  return square_root(dot(a, a));
}

template <class Real>
Triple<Real> triple(const glm::vec3& v) {
  return {Real(v.x), Real(v.y), Real(v.z)};
}

template <class Real>
Real mixed(const Real& a, const Real& b, const Real& share) {
  return a + share * (b - a);
}

// Light from all around, from a direction of any length up to 1.
template <class Real>
Real ambient_light(const Ambient& ambient, const Triple<Real>& direction, std::size_t channel) {
  const Real share = Real(0.5f) + Real(0.5f) * dot(direction, triple<Real>(ambient.up));
  const int c = static_cast<int>(channel);
  return mixed(Real(ambient.ground[c]), Real(ambient.sky[c]), share);
}

// Microfacets that face half-way between light and eye, for each one of a mirror; `normal_half`: the cosine between
// that direction and the normal.
template <class Real>
Real ggx_density(const Real& normal_half, const Real& alpha2) {
  const Real root = normal_half * normal_half * (alpha2 - Real(1.0f)) + Real(1.0f);
  return alpha2 / (root * root);
}

// What Smith's visibility divides by, for the cosines between the normal and light and eye.
template <class Real>
Real smith_divisor(const Real& normal_light, const Real& normal_eye, const Real& alpha2) {
  const Real one(1.0f);
  return (normal_eye + square_root(normal_eye * normal_eye * (one - alpha2) + alpha2)) *
         (normal_light + square_root(normal_light * normal_light * (one - alpha2) + alpha2));
}

// Schlick's weight of the reflectance of grazing light.
template <class Real>
Real fresnel_weight(const Real& eye_half) {
  const Real zero(0.0f), one(1.0f);
  const Real grazing = one - lesser(greater(eye_half, zero), one), grazing2 = grazing * grazing;
  return grazing2 * grazing2 * grazing;
}

// Linear RGB towards the eye. Ambient light is reflected diffusely, and from the mirrored direction, which roughness
// turns towards the normal.
template <class Real>
Triple<Real> reflected_light(const Reflector<Real>& surface, const Lighting& lighting) {
  const Real zero(0.0f), one(1.0f);
  const Real roughness = greater(surface.roughness, Real(kLeastRoughness));
  const Real alpha = roughness * roughness, alpha2 = alpha * alpha;
  const Real normal_eye = greater(dot(surface.normal, surface.to_eye), Real(1e-3f));
  Triple<Real> diffuse, mirror;  // mirror: reflectance straight on
  for (std::size_t c = 0; c < 3; ++c) {
    diffuse[c] = surface.base[c] * (one - surface.metallic);
    // A base colour may be above 1, but nothing reflects more light than it receives.
    mirror[c] = lesser(mixed(Real(kDielectricReflectance), surface.base[c], surface.metallic), one);
  }
  Triple<Real> light{zero, zero, zero};
  for (const Light& source : lighting.lights) {
    const Triple<Real> to_light = triple<Real>(-source.direction);
    const Triple<Real> half_way = unit(sum(to_light, surface.to_eye));
    const Real normal_light = greater(dot(surface.normal, to_light), zero);
    const Real normal_half = dot(surface.normal, half_way);
    const Real specular = ggx_density(normal_half, alpha2) / smith_divisor(normal_light, normal_eye, alpha2);
    const Real fresnel = fresnel_weight(dot(surface.to_eye, half_way));
    for (std::size_t c = 0; c < 3; ++c) {
      const Real reflectance = mirror[c] + (one - mirror[c]) * fresnel;
      const Real reflected = (one - reflectance) * diffuse[c] + reflectance * specular;
      light[c] = light[c] + Real(source.color[static_cast<int>(c)]) * normal_light * reflected;
    }
  }
  if (!lighting.ambient) return light;
  const Real twice = dot(surface.normal, surface.to_eye) * Real(2.0f);
  Triple<Real> mirrored;
  for (std::size_t axis = 0; axis < 3; ++axis)
    mirrored[axis] = mixed(surface.normal[axis] * twice - surface.to_eye[axis], surface.normal[axis], alpha);
  for (std::size_t c = 0; c < 3; ++c)
    light[c] = light[c] + (one - mirror[c]) * diffuse[c] * ambient_light(*lighting.ambient, surface.normal, c) +
               mirror[c] * ambient_light(*lighting.ambient, mirrored, c);
  return light;
}

// How the directions at a point turn within an area around it: the normal by up to `right` and `down`, towards both
// sides of the area, and all of them by up to `around`, in radians, in any direction.
template <class Real>
struct Turn {
  Triple<Real> right, down;
  Real around;
};

// The shortest vector, about, of from + s * right + t * down with s and t between -1 and 1.
template <class Real>
Triple<Real> nearest_of(const Triple<Real>& from, const Turn<Real>& turn) {
  const Real one(1.0f), tiny(1e-12f);
  Triple<Real> nearest = from;
  Real s(0.0f), t(0.0f);
  const auto move = [&](const Triple<Real>& along, Real& at) {
    const Real wanted = at - dot(nearest, along) / greater(dot(along, along), tiny);
    const Real next = greater(lesser(wanted, one), Real(-1.0f));
    nearest = sum(nearest, scaled(along, next - at));
    at = next;
  };
  move(turn.right, s);
  move(turn.down, t);
  move(turn.right, s);
  return nearest;
}

// How far reflected light may vary, about, around a point where directions turn: a highlight from its brightest to its
// darkest there, and the bend of diffuse light, whose slope does not change a mean. Of the strongest channel; ambient
// light varies little.
template <class Real>
Real light_range(const Reflector<Real>& surface, const Turn<Real>& turn, const Lighting& lighting) {
  const Real zero(0.0f), one(1.0f);
  const Real roughness = greater(surface.roughness, Real(kLeastRoughness));
  const Real alpha = roughness * roughness, alpha2 = alpha * alpha;
  const Real normal_eye = greater(dot(surface.normal, surface.to_eye), Real(1e-3f));
  const Real base = greater(greater(surface.base[0], surface.base[1]), surface.base[2]);
  const Real mirror = lesser(mixed(Real(kDielectricReflectance), base, surface.metallic), one);
  const Real all = length(turn.right) + length(turn.down) + turn.around;
  const Real bend = base * (one - surface.metallic) * (Real(0.25f) * all * all);
  Real range = zero;
  for (const Light& source : lighting.lights) {
    const Triple<Real> to_light = triple<Real>(-source.direction);
    const Triple<Real> half_way = unit(sum(to_light, surface.to_eye));
    const Real normal_light = lesser(greater(dot(surface.normal, to_light) + all, zero), one);
    const Real normal_half = dot(surface.normal, half_way);
    // From the direction half-way to the normal; its length is the sine of the angle between them.
    const Triple<Real> away = sum(surface.normal, scaled(half_way, zero - normal_half));
    const Real nearest = greater(length(nearest_of(away, turn)) - turn.around, zero);
    const Real farthest = lesser(length(away) + all, one);
    const auto density = [&](const Real& sine) {
      return ggx_density(square_root(greater(one - sine * sine, zero)), alpha2);
    };
    const Real specular = (density(nearest) - density(farthest)) / smith_divisor(normal_light, normal_eye, alpha2);
    const Real reflectance = mirror + (one - mirror) * fresnel_weight(dot(surface.to_eye, half_way));
    const Real strongest(std::max(std::max(source.color.r, source.color.g), source.color.b));
    range = range + strongest * normal_light * (reflectance * specular + bend);
  }
  return range;
}

// How far a direction is from another one; both have any length.
template <class Real>
Triple<Real> turned(const Triple<Real>& from, const Triple<Real>& to) {
  return sum(unit(to), scaled(unit(from), Real(-1.0f)));
}

// Roughness with what normals differ within the texel: the mean of unit vectors is the shorter the more they differ.
// `mean`: a mean of normals if `is_mean` is 1; if it is 0, roughness stays. The variance of their directions adds to
// that of the microfacets, which is half of the squared alpha of GGX. Source: Toksvig 2005, "Mipmapping Normal Maps";
// Kaplanyan et al. 2016, "Filtering Distributions of Normals for Shading Antialiasing".
template <class Real>
Real rougher(const Real& roughness, const Triple<Real>& mean, const Real& is_mean) {
  const Real one(1.0f), squared = roughness * roughness;
  const Real length = lesser(greater(square_root(dot(mean, mean)), Real(0.1f)), one);
  const Real variance = is_mean * (one - length) / length;
  return square_root(square_root(lesser(squared * squared + variance + variance, one)));
}

// The surface at a point.
template <class Real>
SurfaceMaterial<Real> material_of(const ShaderInputs& shader, const PointInputs<Real>& point) {
  const Material& material = shader.material;
  std::array<Real, 4> base;
  for (std::size_t c = 0; c < 4; ++c) base[c] = Real(material.base_color[static_cast<int>(c)]);
  if (material.base_texture)
    for (std::size_t c = 0; c < 4; ++c) base[c] = base[c] * point.base_texel[c];
  if (shader.has_vertex_colors)
    for (std::size_t c = 0; c < 4; ++c) base[c] = base[c] * point.color[c];
  SurfaceMaterial<Real> surface{};
  Reflector<Real>& reflector = surface.reflector;
  reflector.base = {base[0], base[1], base[2]};
  surface.alpha = base[3];
  if (material.unlit) return surface;
  reflector.to_eye = unit(point.to_eye);
  reflector.normal = shader.has_own_normal ? point.normal : scaled(unit(point.normal), point.facing);
  reflector.roughness = Real(material.roughness);
  reflector.metallic = Real(material.metallic);
  if (material.metallic_roughness_texture) {
    reflector.roughness = reflector.roughness * point.metallic_roughness_texel[1];
    reflector.metallic = reflector.metallic * point.metallic_roughness_texel[2];
  }
  if (material.normal_texture) {
    const std::array<Real, 4>& code = point.normal_texel;
    const Triple<Real> normal = reflector.normal;
    Triple<Real> tangent = point.tangent;
    const Real along = dot(tangent, normal);
    for (std::size_t axis = 0; axis < 3; ++axis) tangent[axis] = tangent[axis] - along * normal[axis];
    tangent = unit(tangent);
    const Triple<Real> bitangent = scaled(cross(normal, tangent), point.facing * point.tangent_sign);
    const Real two(2.0f), one(1.0f), scale(material.normal_scale);
    const Real to_u = (code[0] * two - one) * scale, to_v = (code[1] * two - one) * scale;
    const Real outward = code[2] * two - one;
    for (std::size_t axis = 0; axis < 3; ++axis)
      reflector.normal[axis] = tangent[axis] * to_u + bitangent[axis] * to_v + normal[axis] * outward;
    reflector.roughness = rougher(reflector.roughness, reflector.normal, code[3]);
    reflector.normal = unit(reflector.normal);
  }
  surface.emissive = triple<Real>(material.emissive);
  if (material.emissive_texture)
    for (std::size_t c = 0; c < 3; ++c) surface.emissive[c] = surface.emissive[c] * point.emissive_texel[c];
  return surface;
}

// How far light may vary in an area, about.
template <class Real>
Real light_range(const ShaderInputs& shader, const AreaInputs<Real>& area, const Lighting& lighting) {
  const PointInputs<Real>& middle = area.middle;
  const Real zero(0.0f);
  Turn<Real> turn{{zero, zero, zero}, {zero, zero, zero}, zero};
  turn.around = Real(0.5f) * (length(turned(middle.to_eye, area.right_to_eye)) +
                              length(turned(middle.to_eye, area.below_to_eye)));  // of the direction half-way
  turn.around = turn.around + area.around_of_texels + area.around_within_texels;
  if (!shader.has_own_normal) {
    turn.right = scaled(turned(middle.normal, area.right_normal), middle.facing);
    turn.down = scaled(turned(middle.normal, area.below_normal), middle.facing);
  }
  return light_range(material_of(shader, middle).reflector, turn, lighting);
}

// Linear RGB towards the eye.
template <class Real>
Triple<Real> lit_color(const Material& material, const SurfaceMaterial<Real>& surface, const Lighting& lighting) {
  if (material.unlit) return surface.reflector.base;
  const Triple<Real> light = reflected_light(surface.reflector, lighting);
  return material.emissive == glm::vec3(0.0f) ? light : sum(light, surface.emissive);
}

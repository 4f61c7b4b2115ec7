// Compares reflected light with glTF 2.0's appendix B, written out in double precision, and with values worked by hand.
#include "stages/surface/surface_formulas.h"

#include <numbers>

#include "tests/simd/random.h"

namespace beampipe::surface_formulas_test {

struct Case {
  glm::dvec3 base, normal, to_eye;
  double metallic, roughness;
};

glm::dvec3 random_unit(Random& random) {
  for (;;) {
    const glm::dvec3 v(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
    if (const double length = glm::length(v); length > 0.01 && length <= 1) return v / length;
  }
}

Case random_case(Random& random, double metallic, double roughness) {
  const glm::dvec3 base(random.real(0, 1), random.real(0, 1), random.real(0, 1));
  const glm::dvec3 normal = random_unit(random);
  return {base, normal, random_unit(random), metallic, roughness};
}

Triple<float> triple_of(const glm::dvec3& v) { return triple<float>(glm::vec3(v)); }

glm::dvec3 reflected(const Case& c, const Lighting& lighting) {
  const Triple<float> light =
      reflected_light(Reflector<float>{triple_of(c.base), static_cast<float>(c.metallic),
                                       static_cast<float>(c.roughness), triple_of(c.normal), triple_of(c.to_eye)},
                      lighting);
  return {light[0], light[1], light[2]};
}

// Appendix B.3: the metallic BRDF mixed with the dielectric one, whose layers Fresnel's term weighs. N, L and V are
// unit vectors. The result is the reflected radiance for a light of irradiance pi, which is what Light::color is.
glm::dvec3 gltf(const Case& c, const glm::dvec3& light) {
  const double pi = std::numbers::pi;
  const glm::dvec3 N = c.normal, V = c.to_eye, L = -light, H = glm::normalize(L + V);
  const double NL = glm::dot(N, L), NV = glm::dot(N, V), NH = glm::dot(N, H), VH = glm::dot(V, H), HL = glm::dot(H, L);
  if (NL <= 0) return glm::dvec3(0);
  const double alpha = c.roughness * c.roughness, a2 = alpha * alpha;
  const double D = NH > 0 ? a2 / (pi * std::pow(NH * NH * (a2 - 1) + 1, 2)) : 0;
  const auto G1 = [&](double cosine, double half) {
    return half > 0 ? 2 * std::abs(cosine) / (std::abs(cosine) + std::sqrt(a2 + (1 - a2) * cosine * cosine)) : 0;
  };
  const double specular = D * G1(NL, HL) * G1(NV, VH) / (4 * std::abs(NL) * std::abs(NV));
  const double schlick = std::pow(1 - std::abs(VH), 5);
  const glm::dvec3 diffuse = c.base / pi;
  const double dielectric_fresnel = 0.04 + (1 - 0.04) * schlick;
  const glm::dvec3 dielectric = (1 - dielectric_fresnel) * diffuse + dielectric_fresnel * specular;
  const glm::dvec3 metal = specular * (c.base + (1.0 - c.base) * schlick);
  return pi * NL * ((1 - c.metallic) * dielectric + c.metallic * metal);
}

Lighting one_light(const glm::dvec3& direction) { return {{{glm::vec3(direction)}}, {}}; }

// A mix of BRDFs and the BRDF of a mixed reflectance differ by products of metallic and 1 - metallic, so materials here
// are metal or not. Appendix B.3.5 uses the mixed form, which MixedMaterials holds.
TEST(SurfaceFormulas, ReflectedLightIsThatOfTheSpecification) {
  Random random(1);
  for (int i = 0; i < 50'000; ++i) {
    const Case c = random_case(random, random.one_in(2) ? 1 : 0, random.real(0.15, 1));
    if (glm::dot(c.normal, c.to_eye) < 0.01) continue;  // NV is kept from 0
    const glm::dvec3 light = random_unit(random);
    const glm::dvec3 expected = gltf(c, light), found = reflected(c, one_light(light));
    // Rounding of N, L and V turns them by 2^-23. The highlight's density changes by up to its slope, 2 / alpha^2,
    // times that, and the least alpha^2 is 5e-4.
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(found[k], expected[k], 2e-6 + 2e-3 * expected[k]) << i;
  }
}

TEST(SurfaceFormulas, MixedMaterials) {
  Random random(2);
  for (int i = 0; i < 10'000; ++i) {
    const Case c = random_case(random, random.real(0, 1), random.real(0.3, 1));
    const glm::dvec3 light = random_unit(random);
    if (glm::dot(c.normal, c.to_eye) < 0.05) continue;
    Case black = c, mirror = c;  // the specular layer alone, for the mixed reflectance straight on, as a metal
    mirror.base = (1 - c.metallic) * 0.04 + c.metallic * c.base, mirror.metallic = 1;
    black.base = glm::dvec3(0);
    const double VH = glm::dot(c.to_eye, glm::normalize(c.to_eye - light));
    const glm::dvec3 fresnel = mirror.base + (1.0 - mirror.base) * std::pow(1 - VH, 5);
    const double NL = std::max(0.0, glm::dot(c.normal, -light));
    const glm::dvec3 expected = gltf(mirror, light) + NL * (1.0 - fresnel) * c.base * (1 - c.metallic);
    const glm::dvec3 found = reflected(c, one_light(light));
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(found[k], expected[k], 2e-6 + 2e-4 * expected[k]) << i;
  }
}

void expect_near(const glm::dvec3& found, const glm::dvec3& expected, double bound) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], bound);
}

// Light, eye and normal in one line: N.L = N.V = N.H = V.H = 1, so that Fresnel's term is the reflectance straight on,
// D = 1 / (pi alpha^2) and both masking terms are 1. Times pi: 1 / (4 alpha^2) of the reflectance.
TEST(SurfaceFormulas, StraightOnByHand) {
  const glm::dvec3 up(0, 0, 1);
  const Lighting light = one_light(-up);
  // Dielectric, roughness 1: 0.96 of the base colour, and 0.04 / 4.
  expect_near(reflected({{0.5, 0.25, 1}, up, up, 0, 1}, light), glm::dvec3(0.5, 0.25, 1) * 0.96 + 0.01, 1e-6);
  // Metal, roughness 1/2: alpha^2 = 1/16, and 1 / (4 alpha^2) = 4.
  expect_near(reflected({{0.5, 0.25, 1}, up, up, 1, 0.5}, light), {4 * 0.5, 4 * 0.25, 4}, 1e-5);
}

// N = V = (0, 0, 1), L = (0.8, 0, 0.6): N.L = 0.6, H = (1, 0, 2) / sqrt(5), N.H^2 = V.H^2 = 0.8. Roughness 1: alpha is
// 1, D = 1 / pi, masking is 2 x 0.6 / (0.6 + 1) x 1 = 0.75, and specular reflection is 0.75 / (pi 4 x 0.6) = 0.3125 /
// pi.
TEST(SurfaceFormulas, SlantedByHand) {
  const glm::dvec3 up(0, 0, 1);
  const double schlick = std::pow(1 - std::sqrt(0.8), 5), fresnel = 0.04 + 0.96 * schlick;
  expect_near(reflected({{0.5, 0, 1}, up, up, 0, 1}, one_light({-0.8, 0, -0.6})),
              0.6 * ((1 - fresnel) * glm::dvec3(0.5, 0, 1) + fresnel * 0.3125), 1e-6);
}

TEST(SurfaceFormulas, LightsAddUpAndHaveColors) {
  const Case c{{0.5, 0.25, 0.75}, {0, 0, 1}, glm::normalize(glm::dvec3(0.5, 0.25, 1)), 0.25, 0.6};
  const glm::dvec3 a = glm::normalize(glm::dvec3(0.5, 0, -1)), b = glm::normalize(glm::dvec3(-0.25, 1, -1));
  const Lighting both{{{glm::vec3(a), glm::vec3(2, 0, 1)}, {glm::vec3(b), glm::vec3(0, 3, 1)}}, {}};
  const glm::dvec3 of_a = reflected(c, one_light(a)), of_b = reflected(c, one_light(b)), found = reflected(c, both);
  expect_near(found, {2 * of_a.r, 3 * of_b.g, of_a.b + of_b.b}, 1e-6);
}

TEST(SurfaceFormulas, LightIsNeverNegativeAndAlwaysFinite) {
  Random random(3);
  const double kParts[] = {0, 1e-9, 0.5, 1};
  for (int i = 0; i < 100'000; ++i) {
    Case c;
    c.base = {random.pick(kParts), random.pick(kParts), random.pick(kParts)};
    c.normal = random_unit(random), c.to_eye = random_unit(random);
    if (random.one_in(4)) c.to_eye = -c.normal;
    if (random.one_in(4)) c.to_eye = c.normal;
    if (random.one_in(8)) c.normal = glm::dvec3(0);
    if (random.one_in(8)) c.to_eye = glm::dvec3(0);
    c.metallic = random.pick(kParts), c.roughness = random.pick(kParts);
    glm::dvec3 light = random_unit(random);
    if (random.one_in(4)) light = c.to_eye;  // from behind
    if (random.one_in(4)) light = -c.to_eye;
    if (glm::length(light) == 0) light = {0, 0, 1};
    Lighting lighting = one_light(light);
    if (random.one_in(2)) lighting.ambient = Ambient{glm::vec3(1, 0, 0.5f), glm::vec3(0, 1, 0.5f)};
    const glm::dvec3 found = reflected(c, lighting);
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(found[k] >= 0 && std::isfinite(found[k])) << i << ": " << found[k];
  }
}

// The same light from everywhere: a surface cannot reflect more than it receives.
TEST(SurfaceFormulas, NoMoreAmbientLightIsReflectedThanReceived) {
  Random random(4);
  for (int i = 0; i < 10'000; ++i) {
    Case c;
    c.base = {1, random.real(0, 1), 0};
    c.normal = random_unit(random), c.to_eye = random_unit(random);
    if (glm::dot(c.normal, c.to_eye) < 0) c.to_eye = -c.to_eye;
    c.metallic = random.one_in(2) ? 0 : random.real(0, 1), c.roughness = random.real(0, 1);
    const glm::dvec3 found = reflected(c, {{}, Ambient{glm::vec3(1), glm::vec3(1)}});
    for (int k = 0; k < 3; ++k) ASSERT_LE(found[k], 1 + 1e-6) << "metallic " << c.metallic;
  }
}

// A rough metal sees the ambient light above it, a smooth one that in the mirror.
TEST(SurfaceFormulas, AmbientLightOfAMetalIsMirrored) {
  const Lighting sky{{}, Ambient{glm::vec3(1), glm::vec3(0), glm::vec3(0, 1, 0)}};
  const glm::dvec3 eye = glm::normalize(glm::dvec3(0, 3, 4));
  const Case rough{{1, 1, 1}, {0, 0, 1}, eye, 1, 1}, smooth{{1, 1, 1}, {0, 0, 1}, eye, 1, 0.1};
  EXPECT_NEAR(reflected(rough, sky).r, 0.5, 1e-6);
  EXPECT_NEAR(reflected(smooth, sky).r, 0.5 + 0.5 * -0.6 * 0.99, 1e-6);  // alpha of 0.01 turns it to the normal
}

// Normals whose mean has the length 0.8 have the variance 0.2 / 0.8, which adds to half of alpha squared.
TEST(SurfaceFormulas, NormalsThatDifferMakeASurfaceRough) {
  EXPECT_NEAR(rougher(0.2f, {0, 0, 0.8f}, 1.0f), std::pow(0.0016 + 2 * 0.25, 0.25), 1e-6);
  EXPECT_NEAR(rougher(0.7f, {0.6f, 0, 0}, 1.0f), 1, 1e-6) << "no more than all directions";
  EXPECT_NEAR(rougher(0.2f, {0, 1, 0}, 1.0f), 0.2, 1e-6) << "one direction";
  EXPECT_NEAR(rougher(0.2f, {0, 0, 0.8f}, 0.0f), 0.2, 1e-6) << "one texel, whose length is a rounding error";
}

// A normal map that leans all the way along the tangent gives the part of it that lies in the surface.
TEST(SurfaceFormulas, TangentsAreMadePerpendicular) {
  Material material;
  material.normal_texture = Texture{};
  SurfaceVertex vertex;
  vertex.to_eye = vertex.normal = {0, 0, 1};
  vertex.tangent = {2, 0, 1};
  const ShaderInputs shader{material, false, false, true};
  PointInputs<float> inputs;
  set_attributes(
      shader, TriangleInputs<float>{{0, 0, 1}, 1, {}, 1}, [&](const auto& member_of) { return member_of(vertex); },
      inputs);
  const auto normal_of = [&](const std::array<float, 4>& texel) {
    inputs.normal_texel = texel;
    const Triple<float> normal = material_of(shader, inputs).reflector.normal;
    return glm::vec3(normal[0], normal[1], normal[2]);
  };
  EXPECT_LT(glm::length(normal_of({1, 0.5f, 0.5f, 0}) - glm::vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::length(normal_of({0.5f, 1, 0.5f, 0}) - glm::vec3(0, 1, 0)), 1e-6f);
}

TEST(SurfaceFormulas, UnlitAndEmissive) {
  SurfaceMaterial<float> surface{{{0.5f, 0.25f, 1}, 0, 1, {0, 0, 1}, {0, 0, 1}}, {2, 0, 0.5f}, 1};
  Material material;
  material.unlit = true;
  const Lighting light = one_light({0, 0, -1});
  EXPECT_EQ(lit_color(material, surface, light), (Triple<float>{0.5f, 0.25f, 1}));
  material.unlit = false;
  const Triple<float> dark = lit_color(material, surface, light);
  material.emissive = glm::vec3(2, 0, 0.5f);
  const Triple<float> bright = lit_color(material, surface, light);
  EXPECT_EQ(bright, (Triple<float>{dark[0] + 2, dark[1], dark[2] + 0.5f}));
  EXPECT_EQ(lit_color(material, surface, {}), (Triple<float>{2, 0, 0.5f}));
}

}  // namespace beampipe::surface_formulas_test

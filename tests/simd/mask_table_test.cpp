#include "simd/mask_table.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::mask_table_test {

constexpr TableEdge kEverything{0, 0, 1.0f};  // the whole pixel is inside this edge

// The edge a x + b y + c >= 0 as a pixel sees it, with x and y from the pixel's centre in 1/256 px.
TableEdge table_edge(std::int64_t a, std::int64_t b, std::int64_t c) {
  bool flip = false;
  TableEdge edge;
  edge.angle = table_angle(double(a), double(b), flip);
  edge.flip = flip ? ~0u : 0u;
  const double length = std::sqrt(double(a) * double(a) + double(b) * double(b));
  edge.distance = static_cast<float>((flip ? -1.0 : 1.0) * double(c) / (256 * length));
  return edge;
}

std::uint32_t edge_mask(const TableEdge& edge, const MaskTable& table) {
  return table_mask_formula({{edge, kEverything, kEverything}}, table);
}

struct RandomEdge {
  std::int64_t a, b, c;
};

RandomEdge random_edge(Random& random) {
  const std::int64_t reach = std::int64_t{1} << random.integer(0, 24);
  RandomEdge edge{random.integer(-reach, reach), random.integer(-reach, reach), 0};
  if (random.one_in(6)) edge.a = 0;
  if (edge.a == 0 && edge.b == 0) edge.b = random.one_in(2) ? 1 : -1;
  if (random.one_in(6)) edge.b = edge.a == 0 ? edge.b : 0;
  const std::int64_t cuts = 180 * (std::abs(edge.a) + std::abs(edge.b));
  if (!random.one_in(4)) edge.c = random.integer(-cuts, cuts);  // otherwise the edge passes through the centre
  return edge;
}

TEST(MaskTable, EntriesGrowWithTheDistance) {
  const MaskTable table(hammersley_pattern());
  for (int angle = 0; angle < kTableAngles; ++angle) {
    const std::uint32_t* row = table.words() + angle * kTableDistances;
    for (int r = 1; r < kTableDistances; ++r) ASSERT_EQ(row[r - 1] & ~row[r], 0u) << angle << ", " << r;
    EXPECT_EQ(row[0], 0u);
    EXPECT_EQ(row[kTableDistances - 1], ~0u);
  }
}

TEST(MaskTable, EdgeAndItsReverseShareNoBitAndMissNone) {
  const MaskTable table(hammersley_pattern());
  Random random(31);
  for (int i = 0; i < 200'000; ++i) {
    const RandomEdge e = random_edge(random);
    const TableEdge edge = table_edge(e.a, e.b, e.c), reverse = table_edge(-e.a, -e.b, -e.c);
    ASSERT_EQ(edge_mask(edge, table), ~edge_mask(reverse, table)) << e.a << ", " << e.b << ", " << e.c;
  }
}

std::vector<float> border_distances() {
  std::vector<float> distances = {0.0f, -0.0f, 1.0f, -1.0f, 1e6f, -1e6f};
  for (int r = 0; r <= kTableDistances; ++r) {
    const float border = (static_cast<float>(r) / (kTableDistances / 2) - 1.0f) * kHalfDiagonal;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const float d : {border, std::nextafter(border, kInfinity), std::nextafter(border, -kInfinity)})
      distances.push_back(d);
  }
  return distances;
}

TEST(MaskTable, ComplementsWhereTheColumnChanges) {
  const MaskTable table(hammersley_pattern());
  for (std::int32_t angle = 0; angle < kTableAngles; ++angle)
    for (const float distance : border_distances())
      ASSERT_EQ(edge_mask({angle, 0u, distance}, table), ~edge_mask({angle, ~0u, distance}, table))
          << angle << ", " << distance;
}

TEST(MaskTable, EveryTargetEqualsTheFormula) {
  const MaskTable table(hammersley_pattern());
  Random random(32);
  const std::vector<float> borders = border_distances();
  std::vector<TableTriangle> triangles(20'003);
  for (TableTriangle& triangle : triangles)
    for (TableEdge& edge : triangle.edges) {
      const RandomEdge e = random_edge(random);
      edge = table_edge(e.a, e.b, e.c);
      if (random.one_in(3)) edge.distance = random.pick(borders);
    }
  on_every_target([&] {
    for (const std::size_t count : {triangles.size(), std::size_t{1}, std::size_t{5}}) {
      std::vector<std::uint32_t> masks(triangles.size(), 0xdeadbeef);
      table_masks(triangles.data(), count, table, masks.data());
      for (std::size_t i = 0; i < triangles.size(); ++i)
        ASSERT_EQ(masks[i], i < count ? table_mask_formula(triangles[i], table) : 0xdeadbeef) << "triangle " << i;
    }
  });
}

// A sample that the table puts on the wrong side of an edge lies within 0.0403 px of the edge: half a step of distance,
// 1 / (128 sqrt 2) px, and half a step of angle, pi / 64, seen from at most half a diagonal away. On average a sixth of
// a sample is on the wrong side.
TEST(MaskTable, DiffersFromTheExactMaskOnlyNearTheEdge) {
  const SamplePattern pattern = hammersley_pattern();
  const MaskTable table(pattern);
  Random random(33);
  const double bound = 1 / (128 * std::sqrt(2.0)) + std::acos(-1.0) / 64 / std::sqrt(2.0) + 1e-6;
  constexpr int kEdges = 50'000;
  double wrong = 0;
  for (int i = 0; i < kEdges; ++i) {
    const RandomEdge e = random_edge(random);
    const std::uint32_t mask = edge_mask(table_edge(e.a, e.b, e.c), table);
    std::int64_t value[32];
    std::uint32_t exact = 0;
    for (std::size_t s = 0; s < 32; ++s) {
      value[s] = e.a * (pattern.x[s] - 128) + e.b * (pattern.y[s] - 128) + e.c;
      exact |= static_cast<std::uint32_t>(value[s] >= 0) << s;
    }
    wrong += std::popcount(mask ^ exact);
    const double length = std::sqrt(double(e.a) * double(e.a) + double(e.b) * double(e.b));
    for (std::uint32_t rest = mask ^ exact; rest != 0; rest &= rest - 1) {
      const double distance = double(value[std::countr_zero(rest)]) / (256 * length);
      ASSERT_LE(std::abs(distance), bound) << e.a << ", " << e.b << ", " << e.c;
    }
  }
  EXPECT_LT(wrong / kEdges, 0.2) << "bits of 32";
}

}  // namespace beampipe::mask_table_test

#include "stages/beam/a_buffer.h"

#include "tests/simd/random.h"

namespace beampipe::a_buffer_test {

constexpr std::uint32_t kItem = 50, kRecord = 42;  // bytes of an incoming and of a stored fragment

SortRecord record_at(std::uint32_t pixel, float depth) { return {pixel, 0, depth}; }

std::vector<std::uint32_t> list_of(const ABuffer& buffer, std::size_t pixel) {
  return {buffer.records.begin() + buffer.first[pixel], buffer.records.begin() + buffer.first[pixel + 1]};
}

using List = std::vector<std::uint32_t>;

TEST(ABuffer, NearToFarPerPixel) {
  StageCounters counters;
  const ABuffer buffer = a_buffer(
      {record_at(2, -0.25f), record_at(0, -0.5f), record_at(2, -0.75f), record_at(0, -1.0f), record_at(2, -0.5f)}, 4,
      kItem, kRecord, counters);
  EXPECT_EQ(list_of(buffer, 0), (List{3, 1}));
  EXPECT_EQ(list_of(buffer, 1), List{});
  EXPECT_EQ(list_of(buffer, 2), (List{2, 4, 0}));
  EXPECT_EQ(list_of(buffer, 3), List{});
  EXPECT_EQ(buffer.record_count(2), 3u);
  EXPECT_EQ(counters.items_in, 5u);
  EXPECT_EQ(counters.items_out, 5u);
}

TEST(ABuffer, EqualDepthKeepsTheOrderOfArrival) {
  std::vector<SortRecord> records;  // more than one sorted run
  for (int i = 0; i < 100; ++i) records.push_back(record_at(0, i % 2 == 0 ? -0.5f : -0.25f));
  List expected;
  for (std::uint32_t i = 0; i < 100; i += 2) expected.push_back(i);
  for (std::uint32_t i = 1; i < 100; i += 2) expected.push_back(i);
  StageCounters counters;
  EXPECT_EQ(list_of(a_buffer(records, 1, kItem, kRecord, counters), 0), expected);
}

// If sorted by nearest depth, the fragment with the nearest point comes first, wherever its centroid is.
TEST(ABuffer, TheKeyMayBeTheNearestDepth) {
  std::vector<Fragment> fragments(2);
  fragments[0].centroid_z = -0.75f, fragments[1].centroid_z = -0.5f;
  fragments[0].z_min = -0.8f, fragments[1].z_min = -0.9f;
  StageCounters counters;
  EXPECT_EQ(list_of(a_buffer(sort_records(fragments, SortKey::centroid), 1, kItem, kRecord, counters), 0),
            (List{0, 1}));
  EXPECT_EQ(list_of(a_buffer(sort_records(fragments, SortKey::nearest), 1, kItem, kRecord, counters), 0), (List{1, 0}));
}

TEST(ABuffer, NothingIn) {
  StageCounters counters;
  const ABuffer buffer = a_buffer({}, 3, kItem, kRecord, counters);
  EXPECT_EQ(buffer.first, (List{0, 0, 0, 0}));
  EXPECT_TRUE(buffer.records.empty());
}

// There is a record and a 4-byte link per fragment, and a 4-byte head per pixel. Each insertion reads the incoming
// fragment and reads and writes the head. Then everything is read once.
TEST(ABuffer, Bytes) {
  EXPECT_EQ(a_buffer_bytes(0, 100, kRecord), 400u);
  EXPECT_EQ(a_buffer_bytes(10, 100, kRecord), 10u * 46 + 400);
  StageCounters counters;
  a_buffer({record_at(0, -0.5f), record_at(1, -0.5f)}, 4, kItem, kRecord, counters);
  EXPECT_EQ(counters.bytes_read, 2u * (kItem + 4) + a_buffer_bytes(2, 4, kRecord));
  EXPECT_EQ(counters.bytes_written, 2u * (4 + 46));
}

}  // namespace beampipe::a_buffer_test

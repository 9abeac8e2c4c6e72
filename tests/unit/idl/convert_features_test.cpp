// The door for what constraints can name, and its chunks.
#include <gtest/gtest.h>

#include "idl/chunks.h"
#include "idl/convert.h"
#include "idl/topics.h"
#include "tests/support/numbers.h"
#include "tests/unit/idl/samples.h"

namespace mortise {
namespace {

TEST(Features, GoRound) {
  const FeatureInfo cone = test::some_feature();
  const Result<FeatureInfo> back = from_wire(to_wire(cone));
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_EQ(back->name, cone.name);
  EXPECT_EQ(back->origin, cone.origin);
  EXPECT_EQ(back->kind, cone.kind);
  EXPECT_EQ(back->inward, cone.inward);
  EXPECT_EQ(back->point_P, cone.point_P);
  EXPECT_EQ(back->axis_P, cone.axis_P);
  EXPECT_EQ(back->radius_mm, cone.radius_mm);
  EXPECT_EQ(back->tube_radius_mm, cone.tube_radius_mm);
  EXPECT_EQ(back->half_angle_rad, cone.half_angle_rad);
  EXPECT_EQ(back->along_mm, cone.along_mm);
  EXPECT_EQ(back->middle_P, cone.middle_P);
}

TEST(Features, AreRefused) {
  const auto passes = [](auto change) {
    wire::Feature feature = to_wire(test::some_feature());
    change(feature);
    return static_cast<bool>(from_wire(feature));
  };
  using F = wire::Feature;
  EXPECT_TRUE(passes([](F&) {}));
  EXPECT_FALSE(passes([](F& f) { f.origin(0); }));
  EXPECT_FALSE(passes([](F& f) { f.origin(kFeatureOriginCount); }));
  EXPECT_FALSE(passes([](F& f) { f.kind(0); }));
  EXPECT_FALSE(passes([](F& f) { f.kind(kSurfaceKindCount); }));
  EXPECT_FALSE(passes([](F& f) { f.point_mm()[1] = kInf; }));
  EXPECT_FALSE(passes([](F& f) { f.axis() = {0.0, 0.0, 0.0}; }));
  EXPECT_FALSE(passes([](F& f) { f.axis()[0] = kNan; }));
  EXPECT_FALSE(passes([](F& f) { f.radius_mm(-1.0); }));
  EXPECT_FALSE(passes([](F& f) { f.tube_radius_mm(kNan); }));
  EXPECT_FALSE(passes([](F& f) { f.half_angle_rad(1.6); }));
  EXPECT_FALSE(passes([](F& f) { f.along_mm().lo(kNan); }));
  EXPECT_FALSE(passes([](F& f) { f.along_mm().hi(kInf); }));
  EXPECT_FALSE(passes([](F& f) { f.along_mm().lo(f.along_mm().hi() + 1.0); }));
  EXPECT_FALSE(passes([](F& f) { f.middle_mm()[2] = -kInf; }));
  EXPECT_FALSE(passes([](F& f) { f.name(""); }));
  EXPECT_FALSE(passes([](F& f) { f.name("a\tb"); }));
  EXPECT_FALSE(passes([](F& f) { f.name(std::string(129, 'x')); }));
  wire::FeatureSet set;
  set.parts() = {1, 0};
  EXPECT_FALSE(from_wire(set));
  set.parts() = {1, 2};
  EXPECT_TRUE(from_wire(set));
}

/// So many parts with so many features each, all in one set.
FeatureTable table_of(std::uint32_t parts, std::size_t features) {
  FeatureTable table;
  FeatureSet& set = table.sets.emplace_back();
  for (std::uint32_t i = 1; i <= parts; ++i) set.parts.push_back(PartId{i});
  for (std::size_t i = 0; i < features; ++i) {
    set.features.push_back(test::some_feature());
    set.features.back().name = "hole_" + std::to_string(i) + std::string(i % 100, 'x');
  }
  table.meshes_too_large = 3;
  return table;
}

TEST(Features, LargeTablesAreCutAndLoseNothing) {
  const FeatureTable table = table_of(10'000, 1'000);
  const std::vector<wire::Features> chunks = cut(table, 2);
  EXPECT_GT(chunks.size(), 4u);
  std::map<std::uint32_t, std::size_t> features_of;
  for (const wire::Features& chunk : chunks) {
    wire::FeaturesPubSubType type;
    eprosima::fastrtps::rtps::SerializedPayload_t payload(1 << 20);
    wire::Features copy = chunk;
    ASSERT_TRUE(type.serialize(&copy, &payload));
    EXPECT_LE(payload.length, kSampleLimit_bytes);
    const auto back = from_wire(chunk);
    ASSERT_TRUE(back) << back.error().text;
    EXPECT_EQ(back->meshes_too_large, 3u);
    EXPECT_EQ(back->left_out, 0u);
    for (const FeatureSet& set : back->sets)
      for (const PartId part : set.parts) features_of[part.value] += set.features.size();
  }
  EXPECT_EQ(features_of.size(), 10'000u);
  for (const auto& [part, count] : features_of) ASSERT_EQ(count, 1'000u) << part;
  EXPECT_EQ(cut(FeatureTable{}, 1).size(), 1u);  // none is said, too
}

TEST(Features, WhatHasNoRoomOrNoPlaceInTheWorldIsCounted) {
  FeatureTable table = table_of(2, 3);
  table.sets[0].features[1].point_P.x() = 1e10;  // such an apex costs nobody the rest
  const std::vector<wire::Features> chunks = cut(table, 2);
  ASSERT_EQ(chunks.size(), 1u);
  EXPECT_EQ(chunks[0].left_out(), 1u);
  ASSERT_EQ(chunks[0].sets().size(), 1u);
  EXPECT_EQ(chunks[0].sets()[0].features().size(), 2u);

  FeatureTable huge;
  for (int i = 0; i < 6'000; ++i) huge.sets.push_back(table_of(2'000, 100).sets[0]);
  const std::vector<wire::Features> most = cut(huge, 2);
  EXPECT_EQ(most.size(), static_cast<std::size_t>(row_of(Topic::kFeatures).max_keys));
  std::size_t told = 0;
  for (const wire::Features& chunk : most)
    for (const wire::FeatureSet& set : chunk.sets()) told += set.features().size();
  EXPECT_GT(most[0].left_out(), 0u);
  EXPECT_EQ(told + most[0].left_out(), 600'000u);
}

}  // namespace
}  // namespace mortise

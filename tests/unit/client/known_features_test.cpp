#include "client/known_features.h"

#include <gtest/gtest.h>

#include "client/client.h"
#include "common/messages/memory_channel.h"

namespace mortise {
namespace {

FeatureInfo named(const std::string& name) {
  FeatureInfo feature;
  feature.name = name;
  feature.kind = SurfaceKind::kCylinder;
  return feature;
}

TEST(KnownFeatures, PiecesOfOnePartAreJoined) {
  FeatureTable table;
  table.sets.push_back({{PartId{1}, PartId{2}}, {named("bore_1"), named("bore_2")}});
  table.sets.push_back({{PartId{1}, PartId{2}}, {named("bore_3")}});
  table.sets.push_back({{PartId{3}}, {named("shaft_1")}});
  table.meshes_waiting = 4;
  KnownFeatures known;
  EXPECT_FALSE(known.told());
  known.take(table);
  EXPECT_TRUE(known.told());
  EXPECT_EQ(known.meshes_waiting(), 4u);
  ASSERT_EQ(known.of(PartId{1}).size(), 3u);
  EXPECT_EQ(known.of(PartId{1})[2].name, "bore_3");
  EXPECT_EQ(known.of(PartId{1}).data(), known.of(PartId{2}).data()) << "alike parts share";
  EXPECT_EQ(known.of(PartId{3}).size(), 1u);
  EXPECT_TRUE(known.of(PartId{4}).empty());
  ASSERT_NE(known.find(PartId{2}, "bore_3"), nullptr);
  EXPECT_EQ(known.find(PartId{3}, "bore_3"), nullptr);
  table.sets.resize(1);
  known.take(table);  // the newest table is all there is
  EXPECT_EQ(known.of(PartId{1}).size(), 2u);
  EXPECT_TRUE(known.of(PartId{3}).empty());
}

TEST(KnownFeatures, AClientKeepsThemUntilAnotherServerComes) {
  MemoryHub hub;
  auto server = hub.open_server();
  FeatureTable table;
  table.sets.push_back({{PartId{1}}, {named("bore")}});
  server->publish_features(table);
  const auto channel = hub.open_client();  // late: they are kept for it
  Client client(*channel);
  EXPECT_TRUE(client.poll().features);
  EXPECT_FALSE(client.poll().features);
  EXPECT_NE(client.features().find(PartId{1}, "bore"), nullptr);
  table.sets[0].features.push_back(named("shaft"));
  server->publish_features(table);
  EXPECT_TRUE(client.poll().features);
  EXPECT_NE(client.features().find(PartId{1}, "shaft"), nullptr);
  server = hub.open_server();
  client.poll();
  EXPECT_FALSE(client.features().told());
}

}  // namespace
}  // namespace mortise

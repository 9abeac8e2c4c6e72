// Tables of features are made beside who asks for them.
#include "server/table_maker.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/unit/server/small_world.h"

namespace mortise {
namespace {

std::vector<std::string> names_of(const FeatureTable& table) {
  std::vector<std::string> names;
  for (const FeatureSet& set : table.sets)
    for (const FeatureInfo& feature : set.features) names.push_back(feature.name);
  return names;
}

// The world goes on meanwhile: the table is that of the time at which it was asked for.
TEST(TableMaker, MakesWhatTheWorldWouldHaveTold) {
  World world = testing::small_world();
  Feature face;
  face.name = "top";
  face.surface.kind = SurfaceKind::kPlane;
  face.triangles = {0, 1};
  world.parts[0].features = {face};
  const FeatureTable then = feature_table(world);
  ASSERT_EQ(names_of(then), std::vector<std::string>{"top"});
  TableMaker maker;
  EXPECT_FALSE(maker.is_busy());
  EXPECT_FALSE(maker.take());
  maker.make(feature_sources(world));
  EXPECT_TRUE(maker.is_busy());
  world.parts[0].features.change()[0].name = "later";
  world.parts[1].present = false;
  std::optional<FeatureTable> made;
  for (int i = 0; i < 60'000 && !(made = maker.take()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(made);
  EXPECT_FALSE(maker.is_busy());
  EXPECT_EQ(names_of(*made), names_of(then));
  EXPECT_EQ(made->meshes_waiting, then.meshes_waiting);
  maker.make(feature_sources(world));  // and whoever goes while one is made waits for its end
}

}  // namespace
}  // namespace mortise

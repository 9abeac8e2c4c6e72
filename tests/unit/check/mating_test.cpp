#include "client/tools/check/mating.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/io/scenario/scene_load.h"

namespace mortise {
namespace {

LoadedScene ring_and_pin(const std::string& pin, const std::string& more = "") {
  const auto reading = read_scenario_text(
      "name: a\nunits: mm\nparts:\n  - {name: ring, generator: {kind: ring, bore: 3.3, outer: 20, "
      "width: 5}}\n  - {name: pin, generator: {kind: dowel, " +
          pin + "}, pose: {position: [0, 0, 1]}}\n" + more,
      "s.yaml");
  EXPECT_TRUE(reading && reading->usable());
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene && scene->usable());
  return std::move(*scene);
}

Mating mating_of(const LoadedScene& scene) {
  return MatingFinder(scene.world).find(scene.world.parts[0], scene.world.parts[1]);
}

TEST(Mating, SizesSayWhatAPairMayBe) {
  const auto relation = [](double hole, double shaft) {
    return relation_of_sizes(hole, shaft).relation;
  };
  EXPECT_EQ(relation(10.0, 10.0), MatingKind::kFitNotStated);
  EXPECT_EQ(relation(10.0, 10.001), MatingKind::kFitNotStated);
  EXPECT_EQ(relation(3.4, 3.0), MatingKind::kClearanceHole);
  EXPECT_EQ(relation(6.0, 3.0), MatingKind::kUnknown);
  EXPECT_EQ(relation(2.5, 3.0), MatingKind::kThread);
  EXPECT_EQ(relation_of_sizes(2.5, 3.0).thread, "M3");
  EXPECT_EQ(relation(1.6, 2.0), MatingKind::kThread);
  EXPECT_EQ(relation(3.3, 3.6), MatingKind::kInsert);
  EXPECT_EQ(relation(20.0, 20.04), MatingKind::kPressFit);
  EXPECT_EQ(relation(39.0, 40.0), MatingKind::kUnknown);  // no insert is so large
  EXPECT_EQ(relation(2.0, 4.0), MatingKind::kUnknown);
}

TEST(Mating, AnInsertIsExplainedByItsRing) {
  const Mating mating = mating_of(ring_and_pin("diameter: 3.6, length: 3"));
  EXPECT_EQ(mating.relation, MatingKind::kInsert);
  ASSERT_EQ(mating.pairs.size(), 1U);
  // Its journal is shorter by a chamfer of 0.5 mm at either end.
  const double exact = 0.25 * std::numbers::pi * (3.6 * 3.6 - 3.3 * 3.3) * 2.0;
  EXPECT_NEAR(mating.explained_mm3, exact, 0.02 * exact);
}

TEST(Mating, TheLengthIsThatOfBoth) {
  // The pin begins 1 mm inside, its journal 0.5 mm later; both go on beyond the ring's end.
  const Mating mating = mating_of(ring_and_pin("diameter: 3.6, length: 30"));
  ASSERT_EQ(mating.pairs.size(), 1U);
  EXPECT_NEAR(mating.pairs[0].length_mm, 3.5, 1e-9);
}

TEST(Mating, PartsBesideEachOtherAreNothingToEachOther) {
  LoadedScene scene = ring_and_pin("diameter: 3.6, length: 3");
  scene.world.parts[1].X_WP.p.x() = 0.2;
  EXPECT_EQ(mating_of(scene).relation, MatingKind::kUnknown);
  scene.world.parts[1].X_WP.p = {0.0, 0.0, 50.0};
  EXPECT_EQ(mating_of(scene).relation, MatingKind::kUnknown);
}

TEST(Mating, AStatedFitIsStated) {
  const std::string fit = "fits:\n  - {between: [ring.bore, pin.journal], code: Ø3.3 H7/g6}\n";
  EXPECT_EQ(mating_of(ring_and_pin("diameter: 3.3, length: 3")).relation,
            MatingKind::kFitNotStated);
  EXPECT_EQ(mating_of(ring_and_pin("diameter: 3.3, length: 3", fit)).relation,
            MatingKind::kFitStated);
}

}  // namespace
}  // namespace mortise

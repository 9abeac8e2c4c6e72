// What pages are told, key by key.
#include "client/web/json_out.h"

#include <gtest/gtest.h>

#include <limits>

namespace mortise::web {
namespace {

ClashEvent clash(std::uint32_t id, std::uint32_t a, std::uint32_t b, CollisionClass klass) {
  ClashEvent event;
  event.kind = ClashEvent::Kind::kChange;
  event.seq = 4;
  event.tick = 9;
  event.clash = ClashId{id};
  event.part_a = PartId{a};
  event.part_b = PartId{b};
  event.verdict.collision_class = klass;
  return event;
}

TEST(JsonOut, AnEventHasAllOfAVerdict) {
  ClashEvent event = clash(2, 1, 5, CollisionClass::kReal);
  event.verdict.delta_mm = {0.25, 0.5};
  event.verdict.gpd_mm = {0.1, std::numeric_limits<double>::infinity()};
  event.verdict.point_W = Vec3(1, 2, 3);
  event.verdict.face_a = "bore";
  event.verdict.explanation = "they meet";
  event.review = {ReviewStatus::kApproved, "fine", UserId{2}, 7};
  const Json json = json_of(event);
  EXPECT_EQ(json["kind"], "change");
  EXPECT_EQ(json["clash"], 2);
  EXPECT_EQ(json["a"], 1);
  EXPECT_EQ(json["b"], 5);
  EXPECT_EQ(json["class"], "real");
  EXPECT_EQ(json["delta"], Json::parse("[0.25, 0.5]"));
  EXPECT_EQ(json["gpd"], Json::parse("[0.1, null]"));  // no number is not JSON
  EXPECT_EQ(json["point"], Json::parse("[1.0, 2.0, 3.0]"));
  EXPECT_TRUE(json["witness"].is_null());
  EXPECT_EQ(json["faces"], Json::parse(R"(["bore", ""])"));
  EXPECT_TRUE(json["t_real"].is_null());
  EXPECT_EQ(json["t_contact"], 1.0);
  EXPECT_EQ(json["review"]["status"], "approved");
  EXPECT_EQ(json["explanation"], "they meet");
  EXPECT_EQ(json["probability"], 0.0);
  event.verdict.probability = kProbabilityUnknown;
  EXPECT_TRUE(json_of(event)["probability"].is_null());
  event.verdict.has_witness = true;
  event.verdict.witness_W = Vec3(0.5, 0, 0);
  EXPECT_EQ(json_of(event)["witness"], Json::parse("[0.5, 0.0, 0.0]"));
}

TEST(JsonOut, TheWholeOfASceneWithClassesOfItsParts) {
  Scene scene;
  scene.session = "demo";
  scene.policy = "slide";
  scene.tick = 77;
  scene.tick_rate_hz = 60.0;
  for (std::uint32_t id : {1u, 2u, 3u}) {
    PartInfo part;
    part.part = PartId{id};
    part.name = "part" + std::to_string(id);
    part.mesh_hash = "abc";
    part.X_WP = Pose::translation(Vec3(id, 0, 0));
    scene.parts.push_back(part);
  }
  scene.users.push_back({UserId{1}, "ann", true, Role::kDesigner});
  scene.clashes = {clash(1, 1, 2, CollisionClass::kReal), clash(2, 1, 3, CollisionClass::kFake)};
  Decision decision;
  decision.kind = Decision::Kind::kSetPolicy;
  decision.user = UserId{1};
  decision.details.text = "slide";
  scene.standing.push_back(decision);
  scene.notes = {{PartId{2}, "was turned"}, {PartId{2}, "is open"}, {PartId{9}, "of no part here"}};

  const Json json = json_of(scene, class_bits_of(scene.clashes));
  EXPECT_EQ(json["type"], "scene");
  EXPECT_EQ(json["tick"], 77);
  EXPECT_EQ(json["parts"].size(), 3u);
  EXPECT_EQ(json["parts"][0]["classes"], 5u);
  EXPECT_EQ(json["parts"][1]["classes"], 4u);
  EXPECT_EQ(json["parts"][2]["classes"], 1u);
  EXPECT_EQ(json["parts"][0]["notes"], Json::array());
  EXPECT_EQ(json["parts"][1]["notes"], Json::parse(R"(["was turned", "is open"])"));
  EXPECT_EQ(json["parts"][1]["p"], Json::parse("[2.0, 0.0, 0.0]"));
  EXPECT_EQ(json["parts"][1]["q"], Json::parse("[0.0, 0.0, 0.0, 1.0]"));
  EXPECT_EQ(json["users"][0]["role"], "designer");
  EXPECT_EQ(json["clashes"][0]["kind"], "begin");
  EXPECT_EQ(json["standing"][0]["text"], "slide");
}

TEST(JsonOut, ADecisionSaysWhatItsKindHas) {
  Decision decision;
  decision.kind = Decision::Kind::kAddConstraint;
  decision.part = PartId{4};
  decision.details.constraint = {
      ConstraintKind::kCoaxial, {PartId{4}, "pin"}, {PartId{2}, "bore"}, 0.0, true};
  decision.details.constraint_id = ConstraintId{9};
  const Json json = json_of(decision);
  EXPECT_EQ(json["constraint"]["kind"], "coaxial");
  EXPECT_EQ(json["constraint"]["other_feature"], "bore");
  EXPECT_EQ(json["constraint_id"], 9);
  EXPECT_FALSE(json.contains("clash"));
  EXPECT_FALSE(json.contains("name"));
}

TEST(JsonOut, NamesThatAreNoUtf8AreMended) {
  UserInfo user;
  user.name = "a\xff";
  const SharedBytes text = text_of(json_of(user));
  EXPECT_FALSE(Json::parse(*text, nullptr, false).is_discarded());
}

TEST(JsonOut, PercentilesOfNothingAreNull) {
  EXPECT_TRUE(percentiles_of({}).is_null());
  const Json json = percentiles_of({3.0, 1.0, 2.0});
  EXPECT_EQ(json["p50"], 2.0);
  EXPECT_EQ(json["samples"], 3);
  EXPECT_EQ(json["p99"], 3.0) << "by nearest rank p99 of few samples is the largest";
}

}  // namespace
}  // namespace mortise::web

#include "tests/unit/idl/samples.h"

#include <gtest/gtest.h>

#include "common/math/rotation.h"
#include "idl/chunks.h"

namespace mortise::test {

Increment some_increment() {
  Increment increment;
  increment.user = UserId{2};
  increment.part = PartId{3};
  increment.seq = 4;
  increment.translation_mm = Vec3(0.1, -2.5, 1e-9);
  increment.rotation_rad = Vec3(0.3, 0.2, -1.0);
  return increment;
}

PartPose some_pose(std::mt19937_64& random) {
  const auto number = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
  PartPose pose;
  pose.part = PartId{1 + static_cast<std::uint32_t>(random() % 100)};
  pose.holder = UserId{static_cast<std::uint32_t>(random() % 3)};
  pose.X_WP.q = rotation_exp(Vec3(number(), number(), number()) * 1.7);
  pose.X_WP.p = Vec3(number(), number(), number()) * 1e4;
  return pose;
}

ClashEvent some_clash(std::uint64_t seq) {
  ClashEvent event;
  event.kind = ClashEvent::Kind::kChange;
  event.seq = seq;
  event.tick = 50;
  event.begin_tick = 40;
  event.clash = ClashId{6};
  event.part_a = PartId{2};
  event.part_b = PartId{9};
  event.user = UserId{1};
  event.t_contact = 0.25;
  event.t_potential = 0.125;  // t_real: never
  event.worst_class = CollisionClass::kReal;
  event.worst_delta_mm = {0.1, 0.2};
  Verdict& verdict = event.verdict;
  verdict.collision_class = CollisionClass::kPotential;
  verdict.delta_mm = {0.01, 0.02};
  verdict.gpd_mm = {0.03, 0.04};
  verdict.fake_below_mm = -0.005;
  verdict.real_above_mm = 0.05;
  verdict.margin_mm = 0.03;
  verdict.probability = 0.4;
  verdict.travel_mm = 2.5;
  verdict.normal_travel_mm = 1.5;
  verdict.point_W = Vec3(1, 2, 3);
  verdict.normal_W = Vec3(0, 0, 1);
  verdict.area_mm2 = 12.0;
  verdict.has_witness = true;
  verdict.witness_W = Vec3(1, 2, 2.99);
  verdict.separation_translation_mm = Vec3(0, 0, 0.04);
  verdict.separation_rotation_rad = Vec3(0.001, 0, 0);
  verdict.separation_about_W = Vec3(1, 2, 3);
  verdict.separation_of_b = true;
  verdict.separation_way = SeparationWay::kFitted;
  verdict.separation_path = SeparationPath::kBlocked;
  verdict.separation_blocker = PartId{4};
  verdict.shape_a = FaceShape::kConvex;
  verdict.shape_b = FaceShape::kConcave;
  verdict.grade = DeviationGrade::kRecognizedFeature;
  verdict.face_a = "bore";
  verdict.face_b = "shaft";
  verdict.explanation = "the shaft lies 0.015 mm inside the bore";
  return event;
}

Request some_join() {
  Request join;
  join.kind = Request::Kind::kJoin;
  join.nonce = 5;
  join.name = "anna";
  join.role = "designer";
  return join;
}

wire::EventBatch some_event_batch() {
  const ClashEvent events[] = {some_clash(4), some_clash(5)};
  return cut(events)[0];
}

wire::Snapshot some_snapshot_chunk() {
  Snapshot snapshot;
  snapshot.session = "test";
  snapshot.policy = "stop";
  PartInfo part;
  part.part = PartId{1};
  part.name = "block";
  part.radius_mm = 2.0;
  snapshot.parts = {part, part};
  snapshot.users = {{UserId{1}, "anna", true}};
  snapshot.open_clashes = {some_clash()};
  return cut(snapshot, 1)[0];
}

FeatureInfo some_feature() {
  FeatureInfo cone;
  cone.name = "countersink_4";
  cone.origin = FeatureOrigin::kRecognized;
  cone.kind = SurfaceKind::kCone;
  cone.inward = true;
  cone.point_P = {1.5, -2.5, 3.25};
  cone.axis_P = {0.0, 0.6, -0.8};
  cone.radius_mm = 4.5;
  cone.tube_radius_mm = 0.5;
  cone.half_angle_rad = 0.7;
  cone.along_mm = {-2.0, 8.5};
  cone.middle_P = {1.0, 2.0, 3.0};
  return cone;
}

Details some_details() {
  Details details;
  details.parts = {PartId{1}, PartId{7}};
  details.other_part = PartId{8};
  details.feature = "bore";
  details.other_feature = "journal";
  details.other_user = UserId{4};
  details.clash = ClashId{12};
  details.status = ReviewStatus::kApproved;
  details.text =
      "\xc3\x98"
      "20 H7/g6";
  details.constraint = {
      ConstraintKind::kParallelDistance, {PartId{1}, "top"}, {PartId{2}, "foot"}, -2.5, true};
  details.constraint_id = ConstraintId{6};
  return details;
}

void expect_same(const ClashEvent& a, const ClashEvent& b) {
  EXPECT_EQ(a.cause, b.cause);
  EXPECT_EQ(a.review.status, b.review.status);
  EXPECT_EQ(a.review.comment, b.review.comment);
  EXPECT_EQ(a.review.user, b.review.user);
  EXPECT_EQ(a.review.tick, b.review.tick);
  EXPECT_EQ(a.approval_lost, b.approval_lost);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.seq, b.seq);
  EXPECT_EQ(a.tick, b.tick);
  EXPECT_EQ(a.begin_tick, b.begin_tick);
  EXPECT_EQ(a.clash, b.clash);
  EXPECT_EQ(a.part_a, b.part_a);
  EXPECT_EQ(a.part_b, b.part_b);
  EXPECT_EQ(a.user, b.user);
  EXPECT_EQ(a.t_contact, b.t_contact);
  EXPECT_EQ(a.t_potential, b.t_potential);
  EXPECT_EQ(a.t_real, b.t_real);
  EXPECT_EQ(a.worst_class, b.worst_class);
  EXPECT_EQ(a.worst_delta_mm, b.worst_delta_mm);
  const Verdict &v = a.verdict, &w = b.verdict;
  EXPECT_EQ(v.collision_class, w.collision_class);
  EXPECT_EQ(v.delta_mm, w.delta_mm);
  EXPECT_EQ(v.gpd_mm, w.gpd_mm);
  EXPECT_EQ(v.fake_below_mm, w.fake_below_mm);
  EXPECT_EQ(v.real_above_mm, w.real_above_mm);
  EXPECT_EQ(v.margin_mm, w.margin_mm);
  EXPECT_EQ(v.probability, w.probability);
  EXPECT_EQ(v.travel_mm, w.travel_mm);
  EXPECT_EQ(v.normal_travel_mm, w.normal_travel_mm);
  EXPECT_EQ(v.point_W, w.point_W);
  EXPECT_EQ(v.normal_W, w.normal_W);
  EXPECT_EQ(v.area_mm2, w.area_mm2);
  EXPECT_EQ(v.has_witness, w.has_witness);
  EXPECT_EQ(v.witness_W, w.witness_W);
  EXPECT_EQ(v.separation_translation_mm, w.separation_translation_mm);
  EXPECT_EQ(v.separation_rotation_rad, w.separation_rotation_rad);
  EXPECT_EQ(v.separation_about_W, w.separation_about_W);
  EXPECT_EQ(v.separation_of_b, w.separation_of_b);
  EXPECT_EQ(v.separation_way, w.separation_way);
  EXPECT_EQ(v.separation_path, w.separation_path);
  EXPECT_EQ(v.separation_blocker, w.separation_blocker);
  EXPECT_EQ(v.shape_a, w.shape_a);
  EXPECT_EQ(v.shape_b, w.shape_b);
  EXPECT_EQ(v.grade, w.grade);
  EXPECT_EQ(v.face_a, w.face_a);
  EXPECT_EQ(v.face_b, w.face_b);
  EXPECT_EQ(v.explanation, w.explanation);
}

}  // namespace mortise::test

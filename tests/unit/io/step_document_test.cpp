#include "common/io/step/step_document.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/math/unit.h"
#include "tests/support/effort.h"
#include "tests/unit/io/step_samples.h"

namespace mortise {
namespace {

StepDocument full_document() {
  StepDocument document = test::ring_and_pins();
  StepStatement statement;
  statement.kind = StepStatement::Kind::kSize;
  statement.name = "diameter";
  statement.value = 20.0;
  statement.upper = -0.007;
  statement.lower = -0.02;
  statement.faces = {{1, test::cylinder_of(document.parts[1], false)}};
  document.statements.push_back(statement);
  document.not_solid = {"cable"};
  document.notes = {"1 place has no faces"};
  return document;
}

TEST(StepDocument, IsReadAsItWasWritten) {
  const StepDocument document = full_document();
  const std::vector<std::byte> bytes = encode(document);
  const auto read = decode_step(bytes);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(encode(*read), bytes);
  ASSERT_EQ(read->parts.size(), 2U);
  EXPECT_EQ(mesh_hash(read->parts[0].mesh), mesh_hash(document.parts[0].mesh));
  EXPECT_EQ(read->instances[1].path, "base/pin.1");
  EXPECT_EQ(read->statements[0].upper, -0.007);
  EXPECT_TRUE(std::isnan(read->statements[0].limit_upper));
  EXPECT_EQ(read->not_solid, document.not_solid);
}

TEST(StepDocument, DirectionsAreOfLengthOneBehindIt) {
  StepDocument document = full_document();
  for (StepFace& face : document.parts[1].faces) face.surface.axis *= 1.0 + 1e-7;
  const auto read = decode_step(encode(document));
  ASSERT_TRUE(read) << read.error().text;
  for (const StepFace& face : read->parts[1].faces) EXPECT_TRUE(is_unit(face.surface.axis));
}

TEST(StepDocument, IsRefusedWhereverItIsCut) {
  const std::vector<std::byte> bytes = encode(full_document());
  for (std::size_t n = 0; n < bytes.size(); n += 1 + n / 64)
    EXPECT_FALSE(decode_step(std::span(bytes).first(n))) << n;
}

TEST(StepDocument, NoChangedByteReachesBehindIt) {
  const std::vector<std::byte> bytes = encode(full_document());
  std::mt19937_64 random(7);
  int accepted = 0;
  for (int i = 0; i < test::effort(500); ++i) {
    std::vector<std::byte> changed = bytes;
    for (int k = 0; k < 3; ++k)
      changed[random() % changed.size()] = static_cast<std::byte>(random());
    const auto read = decode_step(changed);
    if (!read) continue;
    ++accepted;
    for (const StepPart& part : read->parts) {
      EXPECT_TRUE(valid(part.mesh));
      for (const std::uint32_t f : part.face_of_triangle) EXPECT_LT(f, part.faces.size());
    }
    for (const StepInstance& instance : read->instances)
      EXPECT_LT(instance.part, read->parts.size());
  }
  EXPECT_GT(accepted, 0);  // a changed coordinate is another part
}

TEST(StepDocument, WhatNamesNothingIsRefused) {
  StepDocument document = full_document();
  document.instances[0].part = 2;
  EXPECT_FALSE(decode_step(encode(document)));
  document = full_document();
  document.parts[0].mesh.triangles[0][1] = 1'000'000;
  EXPECT_FALSE(decode_step(encode(document)));
  document = full_document();
  document.statements[0].faces[0].face = 99;
  EXPECT_FALSE(decode_step(encode(document)));
  document = full_document();
  document.instances[1].path = document.instances[0].path;
  EXPECT_FALSE(decode_step(encode(document)));
  document = full_document();
  document.parts[0].mesh.points_mm[0].x() = NAN;
  EXPECT_FALSE(decode_step(encode(document)));
}

TEST(StepDocument, QuestionsAndAnswersAreReadAsTheyWereWritten) {
  const std::vector<StepCommonQuery> queries = {{0, 1, Pose::translation({1, 2, 3})}};
  const auto asked = decode_step_queries(encode(std::span(queries)));
  ASSERT_TRUE(asked);
  EXPECT_EQ((*asked)[0].part_b, 1U);
  EXPECT_EQ((*asked)[0].X_AB.p, Vec3(1, 2, 3));
  const std::vector<StepCommon> commons = {{2.5, 7.0}, {}};
  const auto answered = decode_step_commons(encode(std::span(commons)));
  ASSERT_TRUE(answered);
  EXPECT_EQ((*answered)[0].volume_mm3, 2.5);
  EXPECT_LT((*answered)[1].volume_mm3, 0.0);
  EXPECT_FALSE(decode_step_commons(encode(std::span(queries))));
}

}  // namespace
}  // namespace mortise

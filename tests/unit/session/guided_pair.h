#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "common/math/rotation.h"
#include "common/session/guide/guidance.h"
#include "tests/support/shapes.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {

inline Feature feature(const std::string& name, const Surface& surface) {
  Feature f;
  f.name = name;
  f.surface = surface;
  return f;
}

inline Surface cylinder(double radius_mm, bool inward, const Vec3& point = Vec3::Zero(),
                        const Vec3& axis = Vec3::UnitZ()) {
  Surface s;
  s.kind = SurfaceKind::kCylinder;
  s.point = point;
  s.axis = axis;
  s.radius_mm = radius_mm;
  s.inward = inward;
  return s;
}

inline Surface plane(const Vec3& point, const Vec3& normal) {
  Surface s;
  s.kind = SurfaceKind::kPlane;
  s.point = point;
  s.axis = normal;
  return s;
}

inline Surface ball(double radius_mm, bool inward, const Vec3& point = Vec3::Zero()) {
  Surface s = cylinder(radius_mm, inward, point);
  s.kind = SurfaceKind::kSphere;
  return s;
}

inline constexpr double kKept_mm = 1e-9;

/// A ring with a bore and a pin of 10 um less radius above it, askew; Ada holds the pin.
struct GuidedPair : ::testing::Test {
  SessionBuilder session{Policy::kStop};
  Scratch scratch;
  UserId ada = session.join("ada"), bob = session.join("bob");
  PartId ring, pin;
  std::mt19937_64 rng{11};
  std::uniform_real_distribution<double> u{-1.0, 1.0};

  GuidedPair() {
    const Pose X{rotation_exp(Vec3(0.3, -0.7, 0.4)), Vec3(120, -40, 900)};
    ring = session.add(
        "ring", shapes::ring({10.01 / std::cos(std::acos(-1.0) / 48.0), -10.0, 10.0, 48}, 20.0), X,
        true);
    pin = session.add("pin", shapes::peg({10.0, 0.0, 40.0, 48}),
                      X * Pose{rotation_exp(Vec3(0.05, 0.02, 0.5)), Vec3(1.5, -0.7, 14)}, true);
    session.world.find(ring)->features = {feature("bore", cylinder(10.01, true)),
                                          feature("top", plane(Vec3(0, 0, 10), Vec3::UnitZ())),
                                          feature("socket", ball(5.0, true, Vec3(0, 0, 3)))};
    session.world.find(pin)->features = {feature("shaft", cylinder(10.0, false)),
                                         feature("end", plane(Vec3::Zero(), -Vec3::UnitZ())),
                                         feature("side", plane(Vec3(10, 0, 0), Vec3::UnitX())),
                                         feature("ball", ball(5.0, false, Vec3(0, 0, 20)))};
    session.grab(ada, pin);
  }
  Constraint between(ConstraintKind kind, const std::string& of_pin, const std::string& of_ring,
                     double distance_mm = 0.0, bool snap = true) {
    return {kind, {pin, of_pin}, {ring, of_ring}, distance_mm, snap};
  }
  Vec3 any() { return {u(rng), u(rng), u(rng)}; }
  StepReport tremble(double mm, double rad) {
    return play_tick(session.world, {session.push(ada, pin, mm * any(), rad * any())}, scratch);
  }
  double off() { return guided_state(session.world, pin).residual_mm; }
};

}  // namespace mortise

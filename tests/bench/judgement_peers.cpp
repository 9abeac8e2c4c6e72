// What users have today: FCL's depth of a contact, and the deepest vertex.
#include <fcl/fcl.h>

#include <algorithm>

#include "common/geometry/signed_distance.h"
#include "tests/bench/judgement_methods.h"
#include "tests/bench/statistics.h"
#include "tests/oracle/fcl_model.h"

namespace mortise::bench {
namespace {

// More pairs of triangles than any case has crossing.
constexpr std::size_t kContacts = 100'000;

Word of_depth(double depth_mm, double time_s) {
  Word word;
  word.collision_class = depth_mm > 0.0 ? CollisionClass::kReal : CollisionClass::kNone;
  word.time_s = time_s;
  word.depth_mm = Interval{depth_mm, depth_mm};
  return word;
}

double deepest_vertex_mm(const Solid& of, const Solid& in, const Pose& X) {
  double deepest = 0.0;
  // Vertices outside of the other part's bounds are not asked: a kind thing to do for its time.
  const Box bounds = in.bounds();
  for (const Vec3& p : of.mesh().points_mm) {
    const Vec3 x = X * p;
    if ((x.array() < bounds.lo.array()).any() || (x.array() > bounds.hi.array()).any()) continue;
    deepest = std::max(deepest, -signed_distance_mm(in, x));
  }
  return deepest;
}

}  // namespace

struct FclPair::Models {
  testing::FclModel a, b;
};

FclPair::FclPair(const JudgedCase& c)
    : models_(new Models{testing::fcl_model(c.a.solid->mesh()),
                         testing::fcl_model(c.b.solid->mesh())}) {}
FclPair::~FclPair() = default;

Word FclPair::ask(const JudgedCase& c) const {
  fcl::CollisionRequestd request(kContacts, true);
  const fcl::Transform3d X_WA = testing::fcl_pose(c.X_WA), X_WB = testing::fcl_pose(c.X_WB);
  const Stopwatch watch;
  fcl::CollisionResultd result;
  fcl::collide(models_->a.get(), X_WA, models_->b.get(), X_WB, request, result);
  double deepest = 0.0;
  for (std::size_t i = 0; i < result.numContacts(); ++i)
    deepest = std::max(deepest, result.getContact(i).penetration_depth);
  Word word = of_depth(deepest, watch.elapsed_s());
  return word;
}

Word ask_vertices(const JudgedCase& c) {
  const Solid &a = *c.a.solid, &b = *c.b.solid;
  a.bvh(), b.bvh();
  const Stopwatch watch;
  const double deepest = std::max(deepest_vertex_mm(a, b, c.X_WB.inverse() * c.X_WA),
                                  deepest_vertex_mm(b, a, c.X_WA.inverse() * c.X_WB));
  return of_depth(deepest, watch.elapsed_s());
}

}  // namespace mortise::bench

#include "common/depth/cells/deepest.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <queue>

namespace mortise {
namespace {

// A face is held by a point that is no more than this outside of it: rounding of a linear program.
constexpr double kHeld_mm = 1e-9;
// The other branches of a clause overlap the first by this, so that no point falls between them.
constexpr double kBranchOverlap_mm = 1e-7;
// Linear programs of one window before it is halved.
constexpr std::uint64_t kMostProgramsOfWindow = 400;

// Where less faces the other part, the gap is told as if so much did.
constexpr double kLeastFaced = 0.05;

Box moved(const Pose& X, const Box& box) {
  Box moved;
  for (int corner = 0; corner < 8; ++corner)
    moved.add(X * Vec3((corner & 1 ? box.hi : box.lo).x(), (corner & 2 ? box.hi : box.lo).y(),
                       (corner & 4 ? box.hi : box.lo).z()));
  return moved;
}

FaceSet held_of(const std::vector<double>& slacks) {
  FaceSet set = 0;
  for (std::size_t i = 0; i < slacks.size(); ++i)
    if (slacks[i] >= -kHeld_mm) set |= FaceSet{1} << i;
  return set;
}

// The clause that a point violates: the shortest, and of these the one that it violates most.
FaceSet worst_violated(const std::vector<FaceSet>& clauses, FaceSet held,
                       const std::vector<double>& slacks) {
  FaceSet best = 0;
  double best_excess = 0.0;
  for (const FaceSet clause : clauses) {
    if (clause & held) continue;
    double excess = -kInfinity;
    for (FaceSet rest = clause; rest != 0; rest &= rest - 1)
      excess = std::max(excess, slacks[static_cast<std::size_t>(std::countr_zero(rest))]);
    const int length = std::popcount(clause), best_length = std::popcount(best);
    if (best != 0 && (length > best_length || (length == best_length && excess >= best_excess)))
      continue;
    best = clause;
    best_excess = excess;
  }
  return best;
}

}  // namespace

WindowPair::WindowPair(const SharpQuery& query, double reach_mm, const Box& core_B,
                       const Vec3& origin_B)
    : part{SharpWindow(*query.a.solid, *query.a.planes, moved(query.X_BA.inverse(), core_B),
                       reach_mm, query.depth_mm),
           SharpWindow(*query.b.solid, *query.b.planes, core_B, reach_mm, query.depth_mm)} {
  core.lo = core_B.lo - origin_B;
  core.hi = core_B.hi - origin_B;
  for (int i = 0; i < 2; ++i) {
    const PlaneFaces& all = i == 0 ? *query.a.planes : *query.b.planes;
    for (const std::uint32_t f : part[i].faces()) {
      const PlaneFace& face = all.faces[f];
      Plane plane{
          face.n, face.c, {face.offset_mm.lo - all.noise_mm, face.offset_mm.hi + all.noise_mm}};
      if (i == 0) {
        plane.n = query.X_BA.q * face.n;
        plane.c += plane.n.dot(query.X_BA.p);
      }
      plane.c -= plane.n.dot(origin_B);
      planes[i].push_back(plane);
    }
  }
}

// A face of a part that a point holds, or fails.
struct DeepestPoint::Literal {
  std::uint8_t part = 0, bit = 0;
  bool fails = false;
};

struct DeepestPoint::Node {
  double bound = 0.0;
  LinearProgram::Optimum optimum;
  std::vector<Literal> literals;
  std::uint64_t id = 0;
  bool operator<(const Node& other) const {
    return bound != other.bound ? bound < other.bound : id > other.id;
  }
};

class DeepestPoint::Queue : public std::priority_queue<Node> {
 public:
  std::uint64_t next_id() { return ++ids_; }

 private:
  std::uint64_t ids_ = 0;
};

// g · y <= h says that a face is held with the depth of its part.
LinearProgram::Row DeepestPoint::row_of(const WindowPair& windows, const Literal& literal) const {
  const WindowPair::Plane& plane = windows.planes[literal.part][literal.bit];
  LinearProgram::Row row;
  row.g = {plane.n.x(), plane.n.y(), plane.n.z()};
  row.g[measure_ == SharpMeasure::kSum && literal.part == 1 ? 4 : 3] = 1.0;
  row.h = plane.c_in(layer_);
  if (!literal.fails) return row;
  for (double& g : row.g) g = -g;
  row.h = kBranchOverlap_mm - row.h;
  return row;
}

LinearProgram DeepestPoint::program_of(const WindowPair& windows) const {
  const Vec3 &lo = windows.core.lo, &hi = windows.core.hi;
  if (measure_ == SharpMeasure::kSum)
    return {5,
            {lo.x(), lo.y(), lo.z(), 0.0, 0.0},
            {hi.x(), hi.y(), hi.z(), depth_mm_, depth_mm_},
            {0.0, 0.0, 0.0, 1.0, 1.0}};
  return {4,
          {lo.x(), lo.y(), lo.z(), -depth_mm_},
          {hi.x(), hi.y(), hi.z(), depth_mm_},
          {0.0, 0.0, 0.0, 2.0}};
}

std::vector<double> DeepestPoint::slacks(const WindowPair& windows, int part,
                                         const LinearProgram::Optimum& at) const {
  std::vector<double> all;
  all.reserve(windows.planes[part].size());
  const double depth = at.y[measure_ == SharpMeasure::kSum && part == 1 ? 4 : 3];
  for (const WindowPair::Plane& plane : windows.planes[part])
    all.push_back(plane.c_in(layer_) - plane.n.x() * at.y[0] - plane.n.y() * at.y[1] -
                  plane.n.z() * at.y[2] - depth);
  return all;
}

bool DeepestPoint::in_least(WindowPair& windows, const LinearProgram::Optimum& at) const {
  for (int part = 0; part < 2; ++part)
    if (!windows.part[part].in_least(held_of(slacks(windows, part, at)))) return false;
  return true;
}

double DeepestPoint::proven_mm(const LinearProgram::Optimum& at) const {
  return (measure_ == SharpMeasure::kSum ? at.y[3] + at.y[4] : 2.0 * at.y[3]) - 2.0 * kHeld_mm;
}

// 0: none, the point is in the body.
FaceSet DeepestPoint::violated(WindowPair& windows, int part, const LinearProgram::Optimum& at,
                               bool least_bodies) const {
  const std::vector<double> slack_of = slacks(windows, part, at);
  std::vector<FaceSet>& known = windows.known[part];
  const FaceSet held = held_of(slack_of);
  if (const FaceSet clause = worst_violated(known, held, slack_of)) return clause;
  const std::vector<FaceSet>& fresh = windows.part[part].clauses(held);
  known.insert(known.end(), fresh.begin(), fresh.end());
  if (const FaceSet clause = worst_violated(fresh, held, slack_of)) return clause;
  if (!least_bodies || windows.part[part].in_least(held)) return 0;
  return windows.part[part].all() & ~held;
}

FaceSet DeepestPoint::violated(WindowPair& windows, const LinearProgram::Optimum& at,
                               bool least_bodies, int& part) const {
  part = 0;
  const FaceSet of_a = violated(windows, 0, at, least_bodies);
  if (std::popcount(of_a) == 1) return of_a;
  const FaceSet of_b = violated(windows, 1, at, least_bodies);
  if (of_b == 0 || (of_a != 0 && std::popcount(of_a) <= std::popcount(of_b))) return of_a;
  part = 1;
  return of_b;
}

DeepestPoint::Found DeepestPoint::find(WindowPair& windows, bool least_bodies, double best) const {
  Queue open;
  Found found;
  Node root;
  LinearProgram program = program_of(windows);
  ++found.programs;
  if (!program.maximize(root.optimum)) return found;
  root.bound = program.upper_bound(root.optimum);
  open.push(root);
  while (!open.empty()) {
    const Node node = open.top();
    found.bound = node.bound;
    if (node.bound <= best || found.programs > kMostProgramsOfWindow) return found;
    open.pop();
    int part = 0;
    const FaceSet clause = violated(windows, node.optimum, least_bodies, part);
    if (clause == 0) {
      found.closed = true;
      found.at = node.optimum;
      tell_faces(windows, node, found);
      return found;
    }
    found.programs += branch(windows, node, part, clause, best, open);
  }
  found.bound = nothing_mm();
  return found;
}

// The multipliers balance the normals of both parts, and make 2 together. For all x of A, sum of
// multiplier times (n · x - c) <= 0; the same of B: along the sum of A's the parts are m apart.
void DeepestPoint::tell_faces(const WindowPair& windows, const Node& node, Found& found) const {
  LinearProgram program = program_of(windows);
  for (const Literal& literal : node.literals) program.rows.push_back(row_of(windows, literal));
  const LinearProgram::Vector weights = program.multipliers(node.optimum);
  Vec3 sum = Vec3::Zero();
  double most[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const int id = node.optimum.active[i];
    if (!(weights[i] > 0.0) || id < 0) continue;
    const Literal& literal = node.literals[static_cast<std::size_t>(id)];
    if (!literal.fails && weights[i] > most[literal.part]) {
      most[literal.part] = weights[i];
      found.deciding[literal.part] = literal.bit;
    }
    const LinearProgram::Row row = program.row_of(id);
    if (literal.part == 0) sum += weights[i] * Vec3(row.g[0], row.g[1], row.g[2]);
  }
  found.facing = std::clamp(sum.norm(), kLeastFaced, 1.0);
}

// A child for each face of the clause: it is held, and those before it fail.
std::uint64_t DeepestPoint::branch(WindowPair& windows, const Node& node, int part, FaceSet clause,
                                   double best, Queue& open) const {
  std::uint64_t programs = 0;
  LinearProgram program = program_of(windows);
  for (const Literal& literal : node.literals) program.rows.push_back(row_of(windows, literal));
  std::vector<Literal> literals = node.literals;
  for (FaceSet rest = clause; rest != 0; rest &= rest - 1) {
    literals.push_back({static_cast<std::uint8_t>(part),
                        static_cast<std::uint8_t>(std::countr_zero(rest)), false});
    Node child;
    child.optimum = node.optimum;
    ++programs;
    if (program.maximize_with(row_of(windows, literals.back()), child.optimum)) {
      child.bound = std::min(node.bound, program.upper_bound(child.optimum));
      child.literals = literals;
      child.id = open.next_id();
      if (child.bound > best) open.push(std::move(child));
    }
    literals.back().fails = true;
    program.rows.back() = row_of(windows, literals.back());
  }
  return programs;
}

}  // namespace mortise

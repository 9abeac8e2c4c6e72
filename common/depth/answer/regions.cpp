#include "common/depth/answer/regions.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "common/base/check.h"
#include "common/base/union_find.h"
#include "common/depth/cells/cover_bound.h"

namespace mortise {
namespace {

// More separate spots than this between two parts are one contact of two rough surfaces.
constexpr std::size_t kMostRegions = 16;

// Points asked in a brief look at the meshes.
constexpr std::uint64_t kBriefWork = 3000;

// kNear: a candidate; kReached: from a neighbour that was kept, or a shell inside.
enum class State : std::uint8_t { kUnseen = 0, kNear, kReached, kDropped, kKept };

struct Asked {
  State state = State::kUnseen;
  bool may_interfere = false;
  std::uint32_t met = Topology::kNone;  // triangle of the other part
  std::uint32_t number = 0;             // in the list of kept ones
  std::int32_t middle = -1;             // of Regions::middles
};

class Grouping {
 public:
  Grouping(const RegionsQuery& query, SearchScratch& scratch, std::uint64_t& evaluations)
      : query_(query), pair_(*query.pair), scratch_(scratch), evaluations_(evaluations) {}

  Regions run() {
    const std::uint64_t begin = evaluations_;
    const std::vector<ContainedShell> shells = contained_shells(pair_, evaluations_);
    for (int role = 0; role < 2; ++role) {
      if (!pair_.k(role).has_inside) continue;
      prepare_limits(role);
      std::deque<std::uint32_t> queue;
      for (const std::uint32_t t : query_.candidates->triangles[role]) {
        queue.push_back(t);
        asked_[role][t].state = State::kNear;
      }
      for (const ContainedShell& shell : shells)
        if (shell.role == role && asked_[role].find(shell.triangle) == nullptr) {
          queue.push_back(shell.triangle);
          asked_[role][shell.triangle].state = State::kReached;
        }
      while (!queue.empty()) {
        const std::uint32_t t = queue.front();
        queue.pop_front();
        const bool capped = evaluations_ - begin > query_.work_cap;
        regions_.capped |= capped;
        if (capped) asked_[role][t].may_interfere = true;
        const bool keep = capped || may_interfere(role, t);
        asked_[role][t].state = keep ? State::kKept : State::kDropped;
        if (!keep) continue;
        kept_[role].push_back(t);
        if (capped) continue;
        for (std::uint32_t k = 0; k < 3; ++k)
          pair_.s(role).solid->topology().each_across(t, k, [&](std::uint32_t n) {
            if (asked_[role].find(n) != nullptr) return;
            asked_[role][n].state = State::kReached;
            queue.push_back(n);
          });
      }
      std::sort(kept_[role].begin(), kept_[role].end());
    }
    group();
    return std::move(regions_);
  }

 private:
  Layer widest() const { return pair_.trivial ? Layer::kMesh : Layer::kUpper; }

  // What a closed form already says of a face is not asked again: its triangles are only looked at
  // beyond that.
  void prepare_limits(int role) {
    const Body& s = pair_.s(role);
    const Body& k = pair_.k(role);
    limit_.assign(s.band->faces.size(), pair_.touch_mm);
    known_face_.assign(s.band->faces.size(), false);
    for (const KnownOverlaps::Row& row : query_.known->rows) {
      if (!row.told) continue;
      const std::uint16_t fs = row.face[role], fk = row.face[1 - role];
      known_face_[fs] = true;
      const double offsets_mm = Body::offset_of(s.band->faces[fs], Layer::kUpper) +
                                Body::offset_of(k.band->faces[fk], Layer::kUpper);
      // Of faces that keep apart nothing is told, whatever lies beside their ends.
      if (row.told_mm + offsets_mm <= pair_.touch_mm) continue;
      limit_[fs] = std::max(limit_[fs], row.overlap_mm + offsets_mm + pair_.touch_mm);
    }
  }

  // Where the meshes are the parts: a triangle that goes through one of the other part reaches
  // inside; one that meets none is wholly inside or outside, as its middle is. Only touching ones
  // are doubtful.
  bool reaches_inside(int role, std::uint32_t t) {
    Asked& asked_of = asked_[role][t];
    const std::uint32_t* partner = query_.candidates->crossing[role].find(t);
    if (partner != nullptr) {
      asked_of.met = *partner;
      asked_of.may_interfere = true;
      return true;
    }
    const TriangleMesh& mesh = *pair_.s(role).mesh;
    const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
    const Sample sample = sample_at(pair_, Layer::kMesh, role, t, middle, near_[role]);
    ++evaluations_;
    asked_of.met = near_[role] = sample.at.triangle;
    asked_of.may_interfere = sample.depth_mm > pair_.touch_mm;
    if (!asked_of.may_interfere) return false;
    asked_of.middle = static_cast<std::int32_t>(regions_.middles.size());
    regions_.middles.push_back(sample.at);
    return true;
  }

  bool may_interfere(int role, std::uint32_t t) {
    if (query_.candidates->has_meetings && (asked_[role].find(t)->state == State::kReached ||
                                            query_.candidates->crossing[role].find(t) != nullptr))
      return reaches_inside(role, t);
    const std::uint16_t face = pair_.s(role).face_index(t);
    double limit = limit_[face];
    if (!query_.known->rows.empty())
      for (const std::uint32_t n : pair_.s(role).sharp_neighbours(t))
        limit = std::max(limit, limit_[pair_.s(role).face_index(n)]);
    // No deeper than a closed form tells, as closely as cells are bounded: it is told already.
    const double same_mm = limit > pair_.touch_mm ? kBoundAccuracy_mm : 0.0;
    const bool may_be_deeper = query_.most_mm > limit + same_mm;
    if (may_be_deeper && asked(role, t, widest(), limit)) {
      asked_[role][t].may_interfere = true;
      return true;
    }
    return !pair_.trivial && !beside_known(role, t) && meshes_overlap(role, t);
  }

  // Whether what is certainly no interference looks like one: a fake.
  bool meshes_overlap(int role, std::uint32_t t) {
    if (!query_.brief) return asked(role, t, Layer::kMesh, pair_.touch_mm);
    if (brief_work_ >= kBriefWork) return false;
    const TriangleMesh& mesh = *pair_.s(role).mesh;
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    for (const Vec3& x :
         {Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a)), Vec3((a + b + c) / 3.0)}) {
      ++brief_work_;
      ++evaluations_;
      const Sample sample = sample_at(pair_, Layer::kMesh, role, t, x, near_[role]);
      near_[role] = sample.at.triangle;
      if (sample.depth_mm <= pair_.touch_mm) continue;
      asked_[role][t].met = sample.at.triangle;
      return true;
    }
    return false;
  }

  // On a face with a closed form or at its rim: the overlap of the meshes is told there.
  bool beside_known(int role, std::uint32_t t) const {
    const Body& s = pair_.s(role);
    if (known_face_[s.face_index(t)]) return true;
    if (query_.known->rows.empty()) return false;
    for (const std::uint32_t n : s.sharp_neighbours(t))
      if (known_face_[s.face_index(n)]) return true;
    return false;
  }

  bool asked(int role, std::uint32_t t, Layer layer, double limit) {
    const RootQuery root{&pair_, layer, query_.known, role, t, limit, near_[role]};
    const RootAnswer answer = ask_root(root, scratch_, evaluations_);
    if (std::isfinite(answer.best.depth_mm)) near_[role] = answer.best.at.triangle;
    if (answer.state == RootState::kBelow) return false;
    asked_[role][t].met = answer.best.at.triangle;
    return true;
  }

  const Asked* kept(int role, std::uint32_t t) const {
    const Asked* asked = t == Topology::kNone ? nullptr : asked_[role].find(t);
    return asked != nullptr && asked->state == State::kKept ? asked : nullptr;
  }

  void join_neighbours(int role, UnionFind& sets) const {
    const Topology& topology = pair_.s(role).solid->topology();
    for (const std::uint32_t t : kept_[role])
      for (std::uint32_t k = 0; k < 3; ++k)
        topology.each_across(t, k, [&](std::uint32_t n) {
          if (const Asked* other = kept(role, n)) sets.join(kept(role, t)->number, other->number);
        });
  }

  std::size_t count_sets(int role, UnionFind& sets) const {
    std::size_t count = 0;
    for (const std::uint32_t t : kept_[role]) {
      const std::uint32_t number = kept(role, t)->number;
      count += sets.leads(number);
    }
    return count;
  }

  void group() {
    std::uint32_t number = 0;
    for (int role = 0; role < 2; ++role)
      for (const std::uint32_t t : kept_[role]) asked_[role][t].number = number++;
    UnionFind sets(number);
    std::size_t count[2];
    for (int role = 0; role < 2; ++role) {
      join_neighbours(role, sets);
      count[role] = count_sets(role, sets);
    }
    const int primary = count[1] > count[0] ? 1 : 0;
    regions_.primary = primary;
    if (count[primary] > kMostRegions)
      for (int role = 0; role < 2; ++role)
        for (const std::uint32_t t : kept_[role]) {
          const Asked* mine = kept(role, t);
          if (const Asked* other = kept(1 - role, mine->met))
            sets.join(mine->number, other->number);
        }
    number_regions(primary, sets);
  }

  void number_regions(int primary, UnionFind& sets) {
    FlatMap<std::uint32_t> region_of_set;
    const auto region_of_leader = [&](std::uint32_t leader) {
      if (regions_.capped) leader = 0;  // what is connected is not known: all is one
      if (region_of_set.find(leader) == nullptr)
        region_of_set[leader] = static_cast<std::uint32_t>(regions_.count++);
      return *region_of_set.find(leader);
    };
    for (const std::uint32_t t : kept_[primary]) {
      const std::uint32_t region = region_of_leader(sets.leader_of(kept(primary, t)->number));
      regions_.region_of_triangle[t] = region;
      regions_.roots.push_back({primary, t, region, kept(primary, t)->middle});
    }
    const int other = 1 - primary;
    for (const std::uint32_t t : kept_[other]) {
      const Asked* mine = kept(other, t);
      const std::uint32_t* met =
          mine->met == Topology::kNone ? nullptr : regions_.region_of_triangle.find(mine->met);
      std::uint32_t region = 0;
      if (met != nullptr)
        region = *met;
      else
        region = regions_.count > 0 ? nearest_region(other, t)
                                    : region_of_leader(sets.leader_of(mine->number));
      regions_.roots.push_back({other, t, region, mine->middle});
    }
    regions_.may_interfere.assign(regions_.count, false);
    for (const Root& root : regions_.roots)
      if (kept(root.role, root.triangle)->may_interfere) regions_.may_interfere[root.region] = true;
  }

  // Of the first triangle of the primary part that is nearest to a triangle of the other.
  std::uint32_t nearest_region(int other, std::uint32_t t) const {
    if (regions_.count == 1) return 0;
    const Body& s = pair_.s(other);
    const Body& k = pair_.k(other);
    const Vec3 x = pair_.X_KS[other] *
                   ((s.mesh->corner(t, 0) + s.mesh->corner(t, 1) + s.mesh->corner(t, 2)) / 3.0);
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t region = 0;
    for (const Root& root : regions_.roots) {
      if (root.role == other) continue;
      const double d2 = (k.mesh->corner(root.triangle, 0) - x).squaredNorm();
      if (d2 < best) {
        best = d2;
        region = root.region;
      }
    }
    return region;
  }

  const RegionsQuery& query_;
  const PairFrame& pair_;
  SearchScratch& scratch_;
  std::uint64_t& evaluations_;
  FlatMap<Asked> asked_[2];
  std::vector<std::uint32_t> kept_[2];                          // ascending
  std::uint32_t near_[2] = {Topology::kNone, Topology::kNone};  // met by the triangle asked before
  std::vector<double> limit_;
  std::vector<bool> known_face_;
  std::uint64_t brief_work_ = 0;
  Regions regions_;
};

}  // namespace

Regions find_regions(const RegionsQuery& query, SearchScratch& scratch,
                     std::uint64_t& evaluations) {
  Regions regions = Grouping(query, scratch, evaluations).run();
  for (const Root& root : regions.roots)
    MORTISE_CHECK(root.region < regions.count, "every root belongs to a region");
  return regions;
}

std::vector<ContainedShell> contained_shells(const PairFrame& pair, std::uint64_t& evaluations) {
  std::vector<ContainedShell> found;
  for (int role = 0; role < 2; ++role) {
    const Body& k = pair.k(role);
    if (!k.has_inside) continue;
    const Body& s = pair.s(role);
    for (const std::uint32_t shell : s.solid->shells()) {
      const Vec3 x =
          pair.X_KS[role] *
          ((s.mesh->corner(shell, 0) + s.mesh->corner(shell, 1) + s.mesh->corner(shell, 2)) / 3.0);
      const Box& box = k.solid->bounds();
      if ((x.array() < box.lo.array()).any() || (x.array() > box.hi.array()).any()) continue;
      ++evaluations;
      if (nearest_surface(*k.solid, x).depth_mm > pair.touch_mm) found.push_back({role, shell});
    }
  }
  return found;
}

}  // namespace mortise

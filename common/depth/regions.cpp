#include "common/depth/regions.h"

#include <algorithm>
#include <deque>
#include <numeric>

namespace mortise {
namespace {

// More separate spots than this between two parts are one contact of two rough surfaces.
constexpr std::size_t kMostRegions = 16;

// Shells of one part that are asked whether they lie inside the other.
constexpr std::size_t kMostShells = 256;

// Points asked in a brief look at the meshes.
constexpr std::uint64_t kBriefWork = 3000;

class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The lower index leads, so that numbering does not depend on the order of calls.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

enum class State : std::uint8_t { kUnseen = 0, kQueued, kDropped, kKept };

class Grouping {
 public:
  Grouping(const RegionsQuery& query, SearchScratch& scratch, std::uint64_t& evaluations)
      : query_(query), pair_(*query.pair), scratch_(scratch), evaluations_(evaluations) {}

  Regions run() {
    const std::uint64_t begin = evaluations_;
    const std::vector<ContainedShell> shells = contained_shells(pair_, evaluations_);
    for (int role = 0; role < 2; ++role) {
      state_[role].assign(pair_.s(role).mesh->triangles.size(), State::kUnseen);
      met_[role].assign(state_[role].size(), Topology::kNone);
      may_interfere_[role].assign(state_[role].size(), 0);
      if (!pair_.k(role).has_inside) continue;
      prepare_limits(role);
      std::deque<std::uint32_t> queue;
      for (const std::uint32_t t : query_.candidates->triangles[role]) {
        queue.push_back(t);
        state_[role][t] = State::kQueued;
      }
      for (const ContainedShell& shell : shells)
        if (shell.role == role && state_[role][shell.triangle] == State::kUnseen) {
          queue.push_back(shell.triangle);
          state_[role][shell.triangle] = State::kQueued;
        }
      while (!queue.empty()) {
        const std::uint32_t t = queue.front();
        queue.pop_front();
        const bool capped = evaluations_ - begin > query_.work_cap;
        regions_.capped |= capped;
        if (capped) may_interfere_[role][t] = 1;
        const bool keep = capped || may_interfere(role, t);
        state_[role][t] = keep ? State::kKept : State::kDropped;
        if (!keep || capped) continue;
        for (const std::uint32_t n : pair_.s(role).solid->topology().neighbor[t])
          if (n != Topology::kNone && state_[role][n] == State::kUnseen) {
            state_[role][n] = State::kQueued;
            queue.push_back(n);
          }
      }
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
      limit_[fs] = std::max(limit_[fs],
                            row.overlap_mm + Body::offset_of(s.band->faces[fs], Layer::kUpper) +
                                Body::offset_of(k.band->faces[fk], Layer::kUpper) + pair_.touch_mm);
    }
  }

  bool may_interfere(int role, std::uint32_t t) {
    const std::uint16_t face = pair_.s(role).face_index(t);
    double limit = limit_[face];
    if (!query_.known->rows.empty())
      for (const std::uint32_t n : pair_.s(role).sharp_neighbours(t))
        limit = std::max(limit, limit_[pair_.s(role).face_index(n)]);
    if (asked(role, t, widest(), limit)) {
      may_interfere_[role][t] = 1;
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
      const Sample sample = sample_at(pair_, Layer::kMesh, role, t, x);
      if (sample.depth_mm <= pair_.touch_mm) continue;
      met_[role][t] = sample.at.triangle;
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
    const RootQuery root{&pair_, layer, query_.known, role, t, limit};
    const RootAnswer answer = ask_root(root, scratch_, evaluations_);
    if (answer.state == RootState::kBelow) return false;
    met_[role][t] = answer.best.at.triangle;
    return true;
  }

  void join_neighbours(int role, std::uint32_t first, UnionFind& sets) const {
    const Topology& topology = pair_.s(role).solid->topology();
    for (std::uint32_t t = 0; t < state_[role].size(); ++t) {
      if (state_[role][t] != State::kKept) continue;
      for (const std::uint32_t n : topology.neighbor[t])
        if (n != Topology::kNone && state_[role][n] == State::kKept)
          sets.join(first + t, first + n);
    }
  }

  std::size_t count_sets(int role, std::uint32_t first, UnionFind& sets) const {
    std::size_t count = 0;
    for (std::uint32_t t = 0; t < state_[role].size(); ++t)
      count += state_[role][t] == State::kKept && sets.find(first + t) == first + t;
    return count;
  }

  void group() {
    const auto n0 = static_cast<std::uint32_t>(state_[0].size());
    const std::uint32_t first[2] = {0, n0};
    UnionFind sets(n0 + state_[1].size());
    std::size_t count[2];
    for (int role = 0; role < 2; ++role) {
      join_neighbours(role, first[role], sets);
      count[role] = count_sets(role, first[role], sets);
    }
    const int primary = count[1] > count[0] ? 1 : 0;
    regions_.primary = primary;
    if (count[primary] > kMostRegions) {
      for (int role = 0; role < 2; ++role)
        for (std::uint32_t t = 0; t < state_[role].size(); ++t)
          if (state_[role][t] == State::kKept && met_[role][t] != Topology::kNone &&
              state_[1 - role][met_[role][t]] == State::kKept)
            sets.join(first[role] + t, first[1 - role] + met_[role][t]);
    }
    number(primary, first, sets);
  }

  void number(int primary, const std::uint32_t (&first)[2], UnionFind& sets) {
    std::vector<std::uint32_t> region_of_set(state_[0].size() + state_[1].size(), Topology::kNone);
    std::vector<std::uint32_t>& region_of = regions_.region_of_triangle;
    region_of.assign(state_[primary].size(), Topology::kNone);
    const auto region_of_leader = [&](std::uint32_t leader) {
      if (region_of_set[leader] == Topology::kNone)
        region_of_set[leader] = static_cast<std::uint32_t>(regions_.count++);
      return region_of_set[leader];
    };
    for (std::uint32_t t = 0; t < state_[primary].size(); ++t) {
      if (state_[primary][t] != State::kKept) continue;
      region_of[t] = region_of_leader(sets.find(first[primary] + t));
      regions_.roots.push_back({primary, t, region_of[t]});
    }
    const int other = 1 - primary;
    for (std::uint32_t t = 0; t < state_[other].size(); ++t) {
      if (state_[other][t] != State::kKept) continue;
      const std::uint32_t met = met_[other][t];
      std::uint32_t region = met == Topology::kNone ? Topology::kNone : region_of[met];
      if (region == Topology::kNone)
        region = regions_.count > 0 ? nearest_region(other, t)
                                    : region_of_leader(sets.find(first[other] + t));
      regions_.roots.push_back({other, t, region});
    }
    regions_.may_interfere.assign(regions_.count, false);
    for (const Root& root : regions_.roots)
      if (may_interfere_[root.role][root.triangle] != 0) regions_.may_interfere[root.region] = true;
  }

  // Of the first triangle of the primary part that is nearest to a triangle of the other.
  std::uint32_t nearest_region(int other, std::uint32_t t) const {
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
  std::vector<State> state_[2];
  std::vector<std::uint32_t> met_[2];
  std::vector<std::uint8_t> may_interfere_[2];
  std::vector<double> limit_;
  std::vector<bool> known_face_;
  std::uint64_t brief_work_ = 0;
  Regions regions_;
};

}  // namespace

Regions find_regions(const RegionsQuery& query, SearchScratch& scratch,
                     std::uint64_t& evaluations) {
  return Grouping(query, scratch, evaluations).run();
}

std::vector<ContainedShell> contained_shells(const PairFrame& pair, std::uint64_t& evaluations) {
  std::vector<ContainedShell> found;
  for (int role = 0; role < 2; ++role) {
    const Body& k = pair.k(role);
    if (!k.has_inside) continue;
    const Body& s = pair.s(role);
    const std::vector<std::uint32_t>& shells = s.solid->shells();
    for (std::size_t i = 0; i < std::min(shells.size(), kMostShells); ++i) {
      const Vec3 x =
          pair.X_KS[role] * ((s.mesh->corner(shells[i], 0) + s.mesh->corner(shells[i], 1) +
                              s.mesh->corner(shells[i], 2)) /
                             3.0);
      const Box& box = k.solid->bounds();
      if ((x.array() < box.lo.array()).any() || (x.array() > box.hi.array()).any()) continue;
      ++evaluations;
      if (nearest_surface(*k.solid, x).depth_mm > pair.touch_mm) found.push_back({role, shells[i]});
    }
  }
  return found;
}

}  // namespace mortise

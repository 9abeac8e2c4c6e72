#include "common/depth/search/search.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace mortise {
namespace {

// Pieces that one root may be cut into before it is passed on undecided.
constexpr int kRootEvaluations = 24;

// A decided search goes on for this many evaluations per root, so that the numbers in its report
// are good; the class is known by then.
constexpr std::uint64_t kPolishPerRoot = 2, kPolishLeast = 60, kPolishMost = 600;
// Few roots are large ones, whose deepest points are far from their corners.
constexpr std::uint64_t kFewRoots = 16, kPolishFew = 200;

// How often the best triangle is cut in four around its best quarter.
constexpr int kClimbs = 10;
// A step that gains less than this is the last one.
constexpr double kWorthwhile = 1.05;

// The zone in which the corner of a layer may lie is as large as it is, however small the piece at
// it: one whose longest edge is below this share of its patch's radius is not cut again. Its bound
// stays. With half the share a tooth's edge used up 3,600 evaluations; 2,100 do with this one.
constexpr double kLeastShare = 1.0 / 8.0;

// Contact points kept for the fitted separating motion.
constexpr std::size_t kMostSamples = 48;

// Roots whose corners are asked too when only the class is wanted.
constexpr std::size_t kMostCornerRoots = 512;

struct Item {
  double bound_mm = 0.0;  // no point of the piece is deeper
  Piece piece;
  int role = 0;
  std::uint32_t region = 0;
  std::uint64_t order = 0;
  SurfacePoint at;
  double center_depth_mm = 0.0;
};

bool worse(const Item& a, const Item& b) {
  return a.bound_mm != b.bound_mm ? a.bound_mm < b.bound_mm : a.order > b.order;
}

Piece whole(const Body& s, std::uint32_t triangle) {
  return {{s.mesh->corner(triangle, 0), s.mesh->corner(triangle, 1), s.mesh->corner(triangle, 2)},
          triangle};
}

std::array<Piece, 4> quarters(const Piece& piece) {
  const std::array<Vec3, 3>& c = piece.corners;
  const Vec3 ab = 0.5 * (c[0] + c[1]), bc = 0.5 * (c[1] + c[2]), ca = 0.5 * (c[2] + c[0]);
  return {Piece{{c[0], ab, ca}, piece.triangle}, Piece{{ab, c[1], bc}, piece.triangle},
          Piece{{ca, bc, c[2]}, piece.triangle}, Piece{{ab, bc, ca}, piece.triangle}};
}

double longest_edge_mm(const Piece& piece) {
  const std::array<Vec3, 3>& c = piece.corners;
  return std::sqrt(std::max(
      {(c[1] - c[0]).squaredNorm(), (c[2] - c[1]).squaredNorm(), (c[0] - c[2]).squaredNorm()}));
}

struct Looked {
  Patch patch;
  Sample sample;
  double bound_mm;
};

// known: what is nearest to the middle of the piece; null: it is asked.
Looked look(const PairFrame& pair, Layer layer, int role, const Piece& piece, std::uint32_t near,
            const SurfacePoint* known = nullptr) {
  const Body& k = pair.k(role);
  Looked looked{make_patch(pair.s(role), layer, piece, pair.X_KS[role]), {}, 0.0};
  looked.sample.role = role;
  looked.sample.triangle = piece.triangle;
  looked.bound_mm = -std::numeric_limits<double>::infinity();
  if (looked.patch.count == 0) return looked;  // cut away by its neighbours
  looked.sample.point_K = looked.patch.center;
  looked.sample.at =
      known != nullptr ? *known : nearest_surface(*k.solid, looked.patch.center, near);
  looked.sample.depth_mm = k.depth_in(looked.patch.center, looked.sample.at, layer);
  looked.bound_mm = looked.sample.at.depth_mm + looked.patch.radius_mm +
                    k.largest_offset_mm[static_cast<int>(layer)];
  return looked;
}

DepthProof proof_for(const PairFrame& pair, Layer layer, const KnownOverlaps* known, int role,
                     std::uint32_t triangle, const SurfacePoint& at, double center_depth_mm,
                     double limit_mm) {
  DepthProof proof;
  proof.known = layer == Layer::kMesh ? nullptr : known;
  proof.role = role;
  proof.s = &pair.s(role);
  proof.triangle_s = triangle;
  proof.k = &pair.k(role);
  proof.layer = layer;
  proof.limit_mm = limit_mm;
  proof.at_center = at;
  proof.center_depth_mm = center_depth_mm;
  proof.rounding_mm = pair.rounding_mm;
  return proof;
}

class Search {
 public:
  Search(const SearchQuery& query, SearchScratch& scratch, std::uint64_t& evaluations)
      : query_(query),
        pair_(*query.pair),
        scratch_(scratch),
        evaluations_(evaluations),
        brackets_(query.regions),
        best_of_role_(query.regions),
        kept_(query.regions) {}

  std::vector<Bracket> run() {
    heap_.reserve(query_.roots->size());
    for (const Root& root : *query_.roots) add_root(root);
    std::make_heap(heap_.begin(), heap_.end(), worse);
    if (query_.sign_only)
      for (std::size_t i = 0; i < brackets_.size(); ++i)
        for (const Sample& from : best_of_role_[i]) climb(from, brackets_[i]);
    const std::uint64_t roots = query_.roots->size();
    const std::uint64_t polish =
        roots <= kFewRoots ? kPolishFew
                           : std::clamp(kPolishPerRoot * roots, kPolishLeast, kPolishMost);
    while (!heap_.empty() && work_ < query_.work_cap && !has_found()) {
      std::pop_heap(heap_.begin(), heap_.end(), worse);
      const Item item = std::move(heap_.back());
      heap_.pop_back();
      // What is left is for regions whose class is open.
      if (query_.sign_only && work_ >= polish && is_decided(brackets_[item.region]))
        keep_bound(item);
      else
        treat(item);
    }
    // What was not reached keeps its bound.
    const bool found = has_found();
    for (const Item& item : heap_) {
      Bracket& bracket = brackets_[item.region];
      const bool open = found              ? false
                        : query_.sign_only ? bracket.best.depth_mm <= pair_.touch_mm &&
                                                 bound_of(item) > pair_.touch_mm
                                           : bound_of(item) > tight_limit(bracket);
      bracket.undecided |= open;
      bracket.hi_mm = std::max(bracket.hi_mm, bound_of(item));
    }
    for (Bracket& bracket : brackets_)
      bracket.hi_mm = std::max(bracket.hi_mm, bracket.best.depth_mm);
    return std::move(brackets_);
  }

 private:
  void add_root(const Root& root) {
    const Body& s = pair_.s(root.role);
    const Piece piece = whole(s, root.triangle);
    std::uint32_t& near = near_[root.role];  // roots beside each other follow each other
    const bool known = query_.middles != nullptr && root.middle >= 0;
    push(piece, root.role, root.region, std::numeric_limits<double>::infinity(), near,
         known ? &(*query_.middles)[static_cast<std::size_t>(root.middle)] : nullptr);
    if (!heap_.empty() && heap_.back().role == root.role) near = heap_.back().at.triangle;
    int inside = !heap_.empty() && heap_.back().at.depth_mm > pair_.touch_mm ? 1 : 0;
    // Depth is often reached at a corner. Where there are many, some are enough to know the class.
    const bool skip_corners =
        query_.sign_only && roots_seen_++ % (1 + query_.roots->size() / kMostCornerRoots) != 0;
    const bool shared = query_.layer == Layer::kMesh;
    for (int k = 0; k < 3 && !skip_corners; ++k) {
      const std::uint32_t point = s.mesh->triangles[root.triangle][k];
      if (const double* depth = shared ? depth_at_[root.role].find(point) : nullptr) {
        inside += *depth > pair_.touch_mm ? 1 : 0;
        continue;
      }
      const Sample sample =
          sample_at(pair_, query_.layer, root.role, root.triangle, piece.corners[k], near);
      if (shared) depth_at_[root.role][point] = sample.depth_mm;
      ++work_;
      ++evaluations_;
      const std::uint32_t region = region_of(root.role, root.region, sample.at.triangle);
      take(sample, region);
      if (sample.depth_mm <= pair_.touch_mm) continue;
      ++inside;
      keep(sample, region);
    }
    if (root.role != query_.primary) return;
    const Vec3 n = (piece.corners[1] - piece.corners[0]).cross(piece.corners[2] - piece.corners[0]);
    brackets_[root.region].area_mm2 += 0.5 * n.norm() * inside / (skip_corners ? 1.0 : 4.0);
  }

  // From a triangle's middle towards its deepest point. Of a layer only the sign counts.
  void climb(const Sample& from, Bracket& bracket) {
    if (!std::isfinite(from.depth_mm)) return;
    Piece piece = whole(pair_.s(from.role), from.triangle);
    double reached = from.depth_mm;
    for (int i = 0; i < kClimbs; ++i) {
      if (query_.layer != Layer::kMesh && bracket.best.depth_mm > pair_.touch_mm) return;
      double deepest = -std::numeric_limits<double>::infinity();
      Piece next = piece;
      for (const Piece& quarter : quarters(piece)) {
        const Vec3 middle = (quarter.corners[0] + quarter.corners[1] + quarter.corners[2]) / 3.0;
        const Sample sample =
            sample_at(pair_, query_.layer, from.role, piece.triangle, middle, from.at.triangle);
        ++work_;
        ++evaluations_;
        if (sample.depth_mm > deepest) {
          deepest = sample.depth_mm;
          next = quarter;
        }
        if (sample.depth_mm > bracket.best.depth_mm) bracket.best = sample;
      }
      if (reached > pair_.touch_mm && deepest <= kWorthwhile * reached) return;
      reached = std::max(reached, deepest);
      piece = next;
    }
  }

  // Some of all, evenly: of too many every other one is left away, and from then on of new ones.
  void keep(const Sample& sample, std::uint32_t region) {
    Kept& kept = kept_[region];
    if (kept.seen++ % kept.step != 0) return;
    std::vector<Sample>& samples = brackets_[region].samples;
    samples.push_back(sample);
    if (samples.size() < 2 * kMostSamples) return;
    for (std::size_t i = 0; i < kMostSamples; ++i) samples[i] = samples[2 * i];
    samples.resize(kMostSamples);
    kept.step *= 2;
  }

  std::uint32_t region_of(int role, std::uint32_t inherited, std::uint32_t met) const {
    if (query_.region_of_triangle == nullptr || role == query_.primary) return inherited;
    const std::uint32_t* region = query_.region_of_triangle->find(met);
    return region == nullptr ? inherited : *region;
  }

  void take(const Sample& sample, std::uint32_t region) {
    Bracket& bracket = brackets_[region];
    if (sample.depth_mm > bracket.best.depth_mm) bracket.best = sample;
    Sample& of_role = best_of_role_[region][sample.role];
    if (sample.depth_mm > of_role.depth_mm) of_role = sample;
  }

  void push(const Piece& piece, int role, std::uint32_t region, double parent_bound,
            std::uint32_t near, const SurfacePoint* known = nullptr) {
    const Looked looked = look(pair_, query_.layer, role, piece, near, known);
    const int asked = known == nullptr ? 1 : 0;
    work_ += asked;
    evaluations_ += asked;
    if (looked.patch.count == 0) return;
    Item item;
    item.bound_mm = std::min(parent_bound, looked.bound_mm);
    item.piece = piece;
    item.role = role;
    item.region = region_of(role, region, looked.sample.at.triangle);
    item.order = order_++;
    item.at = looked.sample.at;
    item.center_depth_mm = looked.sample.depth_mm;
    take(looked.sample, item.region);
    heap_.push_back(std::move(item));
    if (started_) std::push_heap(heap_.begin(), heap_.end(), worse);
  }

  bool has_found() const {
    return std::isfinite(query_.ignore_below_mm) &&
           std::any_of(brackets_.begin(), brackets_.end(), [&](const Bracket& bracket) {
             return bracket.best.depth_mm > query_.ignore_below_mm;
           });
  }

  // Below touch only the sign matters: nothing is gained by knowing how far apart to 0.1 um.
  double tight_limit(const Bracket& bracket) const {
    const double lo = bracket.best.depth_mm;
    const double u = std::max(lo + query_.accuracy_mm, query_.ignore_below_mm);
    return lo <= pair_.touch_mm ? std::max(std::min(u, pair_.touch_mm), query_.ignore_below_mm) : u;
  }

  double loose_limit(const Bracket& bracket) const {
    const double lo = bracket.best.depth_mm;
    if (lo <= pair_.touch_mm) return pair_.touch_mm;
    return lo + std::max(query_.accuracy_mm, kLooseShare * lo);
  }

  double bound_of(const Item& item) const { return std::min(item.bound_mm, query_.most_mm); }

  void treat(const Item& item) {
    started_ = true;
    Bracket& bracket = brackets_[item.region];
    const double tight = tight_limit(bracket);
    if (bound_of(item) <= tight) return keep_bound(item);
    const Patch patch =
        make_patch(pair_.s(item.role), query_.layer, item.piece, pair_.X_KS[item.role]);
    const auto below = [&](double limit) {
      const DepthProof proof = proof_for(pair_, query_.layer, query_.known, item.role,
                                         item.piece.triangle, item.at, item.center_depth_mm, limit);
      return depth_at_most(proof, patch, scratch_.proof);
    };
    ++work_;
    ++evaluations_;
    if (below(tight)) {
      bracket.hi_mm = std::max(bracket.hi_mm, tight);
      return;
    }
    if (query_.sign_only) {
      const double loose = loose_limit(bracket);
      if (loose > tight && (item.bound_mm <= loose || below(loose))) {
        bracket.hi_mm = std::max(bracket.hi_mm, std::min(loose, item.bound_mm));
        return;
      }
    }
    if (longest_edge_mm(item.piece) < kLeastShare * patch.radius_mm) return keep_bound(item);
    for (const Piece& half : split(pair_.s(item.role), query_.layer, item.piece))
      push(half, item.role, item.region, item.bound_mm, item.at.triangle);
  }

  bool is_decided(const Bracket& bracket) const { return bracket.best.depth_mm > pair_.touch_mm; }

  void keep_bound(const Item& item) {
    double& hi_mm = brackets_[item.region].hi_mm;
    hi_mm = std::max(hi_mm, bound_of(item));
  }

  const SearchQuery& query_;
  const PairFrame& pair_;
  SearchScratch& scratch_;
  std::uint64_t& evaluations_;
  std::vector<Bracket> brackets_;
  std::vector<std::array<Sample, 2>> best_of_role_;
  struct Kept {
    std::uint64_t seen = 0, step = 1;
  };
  std::vector<Kept> kept_;
  std::vector<Item> heap_;
  std::uint32_t near_[2] = {Topology::kNone, Topology::kNone};  // met by the root before, by role
  FlatMap<double> depth_at_[2];  // corners of the meshes that were asked
  std::uint64_t work_ = 0, order_ = 0;
  std::uint64_t roots_seen_ = 0;
  bool started_ = false;
};

// The corner of a triangle that just reaches into the other part is found at once, by halves late.
bool corner_is_above(const RootQuery& query, const Piece& piece, std::uint32_t near,
                     RootAnswer& answer, std::uint64_t& evaluations) {
  for (const Vec3& corner : piece.corners) {
    const Sample sample =
        sample_at(*query.pair, query.layer, query.role, query.triangle, corner, near);
    ++evaluations;
    if (sample.depth_mm > answer.best.depth_mm) answer.best = sample;
    if (sample.depth_mm <= query.limit_mm) continue;
    answer.state = RootState::kAbove;
    return true;
  }
  return false;
}

}  // namespace

Sample sample_at(const PairFrame& pair, Layer layer, int role, std::uint32_t triangle,
                 const Vec3& x_S, std::uint32_t near) {
  Sample sample;
  sample.role = role;
  sample.triangle = triangle;
  sample.point_K = pair.X_KS[role] * on_layer(pair.s(role), layer, triangle, x_S);
  sample.at = nearest_surface(*pair.k(role).solid, sample.point_K, near);
  sample.depth_mm = pair.k(role).depth_in(sample.point_K, sample.at, layer);
  return sample;
}

std::vector<Bracket> search_depth(const SearchQuery& query, SearchScratch& scratch,
                                  std::uint64_t& evaluations) {
  MORTISE_CHECK(query.pair != nullptr && query.roots != nullptr, "a search has a pair and roots");
  for (const Root& root : *query.roots)
    MORTISE_CHECK(root.region < query.regions && (root.role == 0 || root.role == 1),
                  "a root is of one of the parts and of a region");
  std::vector<Bracket> brackets = Search(query, scratch, evaluations).run();
  for (const Bracket& bracket : brackets)
    MORTISE_CHECK(bracket.best.depth_mm <= bracket.hi_mm, "a bracket has its lower end first");
  return brackets;
}

RootAnswer ask_root(const RootQuery& query, SearchScratch& scratch, std::uint64_t& evaluations) {
  const PairFrame& pair = *query.pair;
  RootAnswer answer;
  std::array<Piece, kRootEvaluations + 1> stack;
  int top = 0;
  stack[top++] = whole(pair.s(query.role), query.triangle);
  std::uint32_t near = query.near;
  for (int work = 0; top > 0; ++work) {
    if (work >= kRootEvaluations) return answer;
    const Piece piece = stack[--top];
    const Looked looked = look(pair, query.layer, query.role, piece, near);
    ++evaluations;
    near = looked.sample.at.triangle;
    if (looked.sample.depth_mm > answer.best.depth_mm) answer.best = looked.sample;
    if (looked.sample.depth_mm > query.limit_mm) {
      answer.state = RootState::kAbove;
      return answer;
    }
    if (looked.patch.count == 0 || looked.bound_mm <= query.limit_mm) continue;
    const DepthProof proof = proof_for(pair, query.layer, query.known, query.role, piece.triangle,
                                       looked.sample.at, looked.sample.depth_mm, query.limit_mm);
    if (depth_at_most(proof, looked.patch, scratch.proof)) continue;
    if (work == 0 && corner_is_above(query, piece, near, answer, evaluations)) return answer;
    for (const Piece& half : split(pair.s(query.role), query.layer, piece)) stack[top++] = half;
  }
  answer.state = RootState::kBelow;
  return answer;
}

}  // namespace mortise

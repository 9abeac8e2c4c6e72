// S movers among M static parts, as boxes. The peer is FCL's tree as a careful user would have it:
// objects registered once, only what moved is updated, only what moved asks. It is asked in three
// ways, and the quickest of the row counts.
#include "tests/bench/broad_phase_rows.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <memory>

#include "common/broadphase/broad_phase.h"
#include "common/broadphase/brute_force.h"
#include "common/broadphase/dynamic_tree.h"
#include "common/broadphase/pair_filter.h"
#include "tests/bench/grid_phase.h"
#include "tests/bench/scenes.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

constexpr double kBarRatio = 0.5;
constexpr double kCell_mm = 60.0;  // about as large as most parts

struct Workload {
  const char* name;
  double share_that_moves;  ///< of the movers, in a tick
  double least_step_mm, most_step_mm;
  bool asleep;  ///< most pairs sleep: the bar holds here
};
constexpr Workload kWorkloads[] = {
    {"a tenth moves, 0.1 to 2 mm a tick", 0.1, 0.1, 2.0, true},
    {"all creep, 0.01 to 0.1 mm a tick", 1.0, 0.01, 0.1, true},
    {"all move, 0.1 to 2 mm a tick", 1.0, 0.1, 2.0, true},
    {"all run, 5 to 20 mm a tick", 1.0, 5.0, 20.0, false},
    {"all jump anywhere in every tick", 1.0, 0.0, 0.0, false},
};

// What one tick tells a broad phase.
struct Tick {
  std::vector<std::uint32_t> moved;
  std::vector<Box> swept, resting;  ///< of moved[i]
};

struct Crowd {
  std::vector<Box> first;  ///< movers, then static parts
  std::uint32_t movers = 0;
  std::vector<Tick> ticks;
};

Box shifted(Box box, const Vec3& by) {
  box.lo += by;
  box.hi += by;
  return box;
}

// An assembly hall: parts of 10 to 60 mm about 60 mm apart, one in a thousand as large as a tenth
// of the hall.
Crowd make_crowd(const Workload& workload, std::uint32_t movers, std::uint32_t fixed, int ticks) {
  Dice dice(5);
  const double hall_mm = 60.0 * std::cbrt(static_cast<double>(fixed + movers));
  const auto anywhere = [&] {
    const double x = dice.between(0, hall_mm), y = dice.between(0, hall_mm);
    return Vec3(x, y, dice.between(0, hall_mm));
  };
  const auto part = [&](double least_mm, double most_mm) {
    Box box;
    const Vec3 corner = anywhere();
    box.add(corner);
    const double x = dice.between(least_mm, most_mm), y = dice.between(least_mm, most_mm);
    box.add(corner + Vec3(x, y, dice.between(least_mm, most_mm)));
    return box;
  };
  Crowd crowd;
  crowd.movers = movers;
  for (std::uint32_t i = 0; i < movers; ++i) crowd.first.push_back(part(10, 60));
  for (std::uint32_t i = 0; i < fixed; ++i)
    crowd.first.push_back(i % 1000 == 999 ? part(0.05 * hall_mm, 0.1 * hall_mm) : part(10, 60));
  std::vector<Vec3> step;
  for (std::uint32_t i = 0; i < movers; ++i)
    step.push_back(dice.between(workload.least_step_mm, workload.most_step_mm) * dice.direction());
  std::vector<Box> now = crowd.first;
  // Who moves does so for a while: the hand that is on a part stays on it.
  std::uint32_t first = 0;
  const auto at_once = std::max(1U, static_cast<std::uint32_t>(workload.share_that_moves * movers));
  for (int t = 0; t < ticks; ++t) {
    if (t % 60 == 59) first += at_once;
    Tick tick;
    for (std::uint32_t k = 0; k < at_once; ++k) tick.moved.push_back((first + k) % movers);
    std::sort(tick.moved.begin(), tick.moved.end());
    for (const std::uint32_t i : tick.moved) {
      Box next = shifted(now[i], step[i]);
      if (workload.most_step_mm == 0.0) next = shifted(now[i], anywhere() - now[i].lo);
      for (int c = 0; c < 3; ++c)
        if (next.lo[c] < 0.0 || next.hi[c] > hall_mm) step[i][c] = -step[i][c];
      Box swept = next;
      // A jump is a part put somewhere, not a way.
      if (workload.most_step_mm > 0.0) swept.add(now[i]);
      tick.swept.push_back(swept);
      tick.resting.push_back(next);
      now[i] = next;
    }
    crowd.ticks.push_back(std::move(tick));
  }
  return crowd;
}

struct Answer {
  std::vector<double> tick_us;
  std::uint64_t pairs = 0, checksum = 0;
  void take(IndexPair pair) {
    ++pairs;
    checksum += (static_cast<std::uint64_t>(pair.a) << 32 | pair.b) * 0x9E3779B97F4A7C15U;
  }
};

// As the session does it: box of the motion, question, filter, and the box where the part rests.
Answer ask_ours(const Crowd& crowd, std::unique_ptr<BroadPhase> phase) {
  Answer answer;
  for (std::uint32_t i = 0; i < crowd.first.size(); ++i) phase->set_box(i, crowd.first[i]);
  std::vector<char> moved(crowd.first.size(), 0);
  std::vector<IndexPair> pairs, asked;
  phase->find_pairs({}, pairs);  // trees are built before the clock starts, as FCL's are
  for (const Tick& tick : crowd.ticks) {
    for (const std::uint32_t i : tick.moved) moved[i] = 1;
    const Stopwatch watch;
    for (std::size_t k = 0; k < tick.moved.size(); ++k)
      phase->set_box(tick.moved[k], tick.swept[k]);
    phase->find_pairs(tick.moved, pairs);
    asked.clear();
    for (const IndexPair pair : pairs) {
      const FilterPart a{pair.a < crowd.movers, moved[pair.a] != 0};
      const FilterPart b{pair.b < crowd.movers, moved[pair.b] != 0};
      if (filter_pair(a, b, false) == PairSkip::kAsk) asked.push_back(pair);
    }
    for (std::size_t k = 0; k < tick.moved.size(); ++k)
      phase->set_box(tick.moved[k], tick.resting[k]);
    answer.tick_us.push_back(1e6 * watch.elapsed_s());
    for (const std::uint32_t i : tick.moved) moved[i] = 0;
    for (const IndexPair pair : asked) answer.take(pair);
  }
  return answer;
}

// FCL computes the box of an object from its geometry; here it is given.
class PeerObject final : public fcl::CollisionObjectd {
 public:
  PeerObject(const std::shared_ptr<fcl::CollisionGeometryd>& geometry, std::uint32_t index)
      : fcl::CollisionObjectd(geometry), part(index) {}
  void set(const Box& box) {
    aabb.min_ = box.lo;
    aabb.max_ = box.hi;
  }
  const std::uint32_t part;
};

enum class PeerWay { kOneTree, kTwoTrees, kTreeAgainstTree };

struct Collected {
  const std::vector<char>& moved;
  std::vector<IndexPair> pairs;
};

bool collect(fcl::CollisionObjectd* x, fcl::CollisionObjectd* y, void* data) {
  auto& collected = *static_cast<Collected*>(data);
  const std::uint32_t i = static_cast<PeerObject*>(x)->part, j = static_cast<PeerObject*>(y)->part;
  if (i == j || !(collected.moved[i] || collected.moved[j])) return false;
  // The tree keeps the larger box of an object that shrank.
  if (x->getAABB().overlap(y->getAABB()))
    collected.pairs.push_back({std::min(i, j), std::max(i, j)});
  return false;
}

Answer ask_fcl(const Crowd& crowd, PeerWay way) {
  const auto geometry = std::make_shared<fcl::Sphered>(1.0);
  std::vector<std::unique_ptr<PeerObject>> objects;
  std::vector<fcl::CollisionObjectd*> movers, fixed, changed;
  for (std::uint32_t i = 0; i < crowd.first.size(); ++i) {
    objects.push_back(std::make_unique<PeerObject>(geometry, i));
    objects.back()->set(crowd.first[i]);
    (i < crowd.movers ? movers : fixed).push_back(objects.back().get());
  }
  fcl::DynamicAABBTreeCollisionManagerd tree_of_all, tree_of_movers;
  if (way == PeerWay::kOneTree) fixed.insert(fixed.end(), movers.begin(), movers.end());
  tree_of_all.registerObjects(fixed);
  tree_of_all.setup();
  tree_of_movers.registerObjects(movers);
  tree_of_movers.setup();

  Answer answer;
  std::vector<char> moved(crowd.first.size(), 0);
  Collected collected{moved, {}};
  for (const Tick& tick : crowd.ticks) {
    collected.pairs.clear();
    for (const std::uint32_t i : tick.moved) moved[i] = 1;
    const Stopwatch watch;
    changed.clear();
    for (std::size_t k = 0; k < tick.moved.size(); ++k) {
      objects[tick.moved[k]]->set(tick.swept[k]);
      changed.push_back(objects[tick.moved[k]].get());
    }
    (way == PeerWay::kOneTree ? tree_of_all : tree_of_movers).update(changed);
    if (way == PeerWay::kTreeAgainstTree) {
      tree_of_movers.collide(&tree_of_all, &collected, collect);
      tree_of_movers.collide(&collected, collect);
    } else {
      for (fcl::CollisionObjectd* object : changed) {
        tree_of_all.collide(object, &collected, collect);
        if (way == PeerWay::kTwoTrees) tree_of_movers.collide(object, &collected, collect);
      }
    }
    answer.tick_us.push_back(1e6 * watch.elapsed_s());
    for (std::size_t k = 0; k < tick.moved.size(); ++k) {
      objects[tick.moved[k]]->set(tick.resting[k]);
      moved[tick.moved[k]] = 0;
    }
    // A pair of two movers may have been met from both.
    std::sort(collected.pairs.begin(), collected.pairs.end());
    collected.pairs.erase(std::unique(collected.pairs.begin(), collected.pairs.end()),
                          collected.pairs.end());
    for (const IndexPair pair : collected.pairs) answer.take(pair);
  }
  return answer;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Of every tick the least time seen: the same work again, without what disturbed it.
template <class Ask>
Answer least_of(int rounds, const Ask& ask) {
  Answer least = ask();
  for (int round = 1; round < rounds; ++round) {
    const Answer again = ask();
    for (std::size_t t = 0; t < least.tick_us.size(); ++t)
      least.tick_us[t] = std::min(least.tick_us[t], again.tick_us[t]);
  }
  return least;
}

}  // namespace

void broad_phase_rows(Report& report, bool quick) {
  const std::uint32_t movers = 200, fixed = 10'000;
  const int ticks = quick ? 60 : 240, rounds = quick ? 2 : 3;
  report.table(
      "Broad phase and pair filter, 200 movers among 10,000 static parts, us a tick (mean)",
      {"movers", "pairs a tick", "mortise", "p99", "FCL one tree", "FCL two trees",
       "FCL tree against tree", "dynamic grid", "share of the best FCL"});
  double worst = 0.0;
  for (const Workload& workload : kWorkloads) {
    const Crowd crowd = make_crowd(workload, movers, fixed, ticks);
    const Answer ours = least_of(rounds, [&] { return ask_ours(crowd, make_dynamic_tree()); });
    const Answer truth = ask_ours(crowd, make_brute_force());
    std::vector<double> peer_us;
    bool same = ours.pairs == truth.pairs && ours.checksum == truth.checksum;
    for (const PeerWay way : {PeerWay::kOneTree, PeerWay::kTwoTrees, PeerWay::kTreeAgainstTree}) {
      const Answer peer = least_of(rounds, [&] { return ask_fcl(crowd, way); });
      peer_us.push_back(mean(peer.tick_us));
      same = same && peer.pairs == truth.pairs && peer.checksum == truth.checksum;
    }
    const Answer grid =
        least_of(rounds, [&] { return ask_ours(crowd, make_grid_phase(kCell_mm)); });
    same = same && grid.pairs == truth.pairs && grid.checksum == truth.checksum;
    if (!same) report.note(std::string("NOT THE SAME PAIRS: ") + workload.name);
    const double share =
        same ? mean(ours.tick_us) / *std::min_element(peer_us.begin(), peer_us.end()) : 1e9;
    if (workload.asleep) worst = std::max(worst, share);
    report.row({std::string(workload.name), static_cast<double>(ours.pairs) / ticks,
                mean(ours.tick_us), quantile(ours.tick_us, 0.99), peer_us[0], peer_us[1],
                peer_us[2], mean(grid.tick_us), share});
  }
  report.bar("broad phase and pair filter, share of FCL's tree where most pairs sleep", worst,
             kBarRatio, BoundKind::kAtMost);
}

}  // namespace mortise::bench

#include "client/tools/check/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

#include "common/ccd/distance.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/messages/length_text.h"

namespace mortise {
namespace {

using PairIds = std::pair<PartId, PartId>;

// Exact volumes of clashes for which nothing depends on them: of the deepest.
constexpr std::size_t kMostVolumes = 20;
// Clashes of which the way out is told, and the processor time that may take: in a crowd of large
// parts one takes seconds.
constexpr std::size_t kMostWays = 60;
constexpr double kMostWays_s = 15.0;

// The sub-assembly that holds both paths: "arm/servo_1" of "arm/servo_1/horn" and
// "arm/servo_1/case"; with the product of it.
std::string inside_of(const Scenario::PartSpec& a, const Scenario::PartSpec& b) {
  const auto pieces = [](const std::string& text) {
    std::vector<std::string> list;
    for (std::size_t from = 0; from <= text.size();) {
      const std::size_t to = std::min(text.find('/', from), text.size());
      list.push_back(text.substr(from, to - from));
      from = to + 1;
    }
    return list;
  };
  const auto path_a = pieces(a.name), path_b = pieces(b.name);
  const auto products = pieces(a.products);
  std::size_t common = 0;
  while (common + 1 < path_a.size() && common + 1 < path_b.size() &&
         path_a[common] == path_b[common])
    ++common;
  // The products begin with the root, which a path leaves out where there is only one.
  const std::size_t offset = products.size() - std::min(products.size(), path_a.size());
  return common > 0 && common - 1 + offset < products.size() ? products[common - 1 + offset] : "";
}

// Corners of exact surfaces lie on edges, which a file allows to be off them.
double residual_of(const Part& part) {
  double most = 0.0;
  for (const Feature& feature : part.features) most = std::max(most, feature.residual_mm);
  return most;
}

bool states_tolerance(const Part& of, const std::string& face, const PairRule* rule, bool is_a) {
  const SurfaceBand* band = &of.band;
  if (rule != nullptr && (is_a ? rule->band_a : rule->band_b))
    band = (is_a ? rule->band_a : rule->band_b).get();
  return std::any_of(band->faces.begin(), band->faces.end(), [&](const SurfaceBand::Face& f) {
    return f.name == face && !(f.tolerance_mm == Interval{});
  });
}

double accuracy_of(const Part& a, const Part& b) {
  return std::min(kMostContact_mm, kLeastContact_mm + residual_of(a) + residual_of(b));
}

void judge_explanation(CheckedPair& pair) {
  const double most = (1.0 + kExplainedShare) * pair.mating.explained_mm3 + kExplainedSlack_mm3;
  pair.explained = pair.common_mm3 <= most;
  pair.reason = fmt::format("{}: {}; exact volume {:.3f} mm³, hole and shaft explain {:.3f} mm³",
                            name_of(pair.mating.relation), pair.mating.text, pair.common_mm3,
                            pair.mating.explained_mm3);
  if (!pair.explained)
    pair.reason +=
        fmt::format(": {:.3f} mm³ are a clash", pair.common_mm3 - pair.mating.explained_mm3);
}

// What could not be judged.
void say_bodies(const OpenedScene& opened, CheckReport& report) {
  const World& world = opened.scene.world;
  if (opened.scenario.assembly)
    for (const std::string& path : opened.scenario.assembly->not_solid)
      report.not_judged.push_back(path + ": not a solid (surfaces or wires only)");
  for (const std::string& lost : not_read_of(opened.scenario))
    report.not_judged.push_back("not examined: " + lost);
  for (const Part& p : world.parts)
    if (!p.solid->has_inside())
      report.not_judged.push_back(p.name + ": open, so that nothing of it is more than potential");
  for (const CheckedPair& pair : report.pairs)
    if (pair.not_examined && pair.verdicts.empty())
      report.not_judged.push_back(world.find(pair.a)->name + " × " + world.find(pair.b)->name +
                                  ": one may lie inside the other, which is open");
  std::erase_if(report.pairs,
                [](const CheckedPair& p) { return p.verdicts.empty() && !p.is_contact; });
}

// A hole and a shaft of one size on one axis touch, whether their facets do or not.
bool has_same_size(const MatingFinder& finder, const Part& a, const Part& b) {
  const Mating mating = finder.find(a, b);
  return std::any_of(mating.pairs.begin(), mating.pairs.end(), [](const CoaxialPair& pair) {
    return relation_of_sizes(pair.hole_mm, pair.shaft_mm).relation == MatingKind::kFitNotStated;
  });
}

class Checker {
 public:
  Checker(OpenedScene& opened, const CheckOptions& options)
      : opened_(opened), world_(opened.scene.world), options_(options), finder_(world_) {}

  CheckReport run() {
    Scratch scratch(options_.threads);
    const AssemblyJudgement judged =
        judge_assembly(world_, scratch, opened_.exact ? kFirstWork : kTellWork);
    report_.candidate_pairs = judged.report.counters.pairs.out;
    gather(judged.report);
    gather_touching(judged.without_verdict);
    report_.judged_pairs = report_.pairs.size();
    for (CheckedPair& pair : report_.pairs) relate(pair);
    ask_exact_solids();
    order_and_count(report_);  // the worst are told first
    tell_clashes(scratch);
    find_near();
    say_bodies(opened_, report_);
    std::set<const Solid*> solids;
    for (const Part& part : world_.parts) solids.insert(part.solid.get());
    report_.parts = world_.parts.size(), report_.products = solids.size();
    order_and_count(report_);
    return std::move(report_);
  }

 private:
  const Part& part(PartId id) const { return *world_.find(id); }
  const Scenario::PartSpec& spec(PartId id) const { return opened_.scenario.parts[id.value - 1]; }

  // 1. pairs that are alike become one

  void gather(const JudgeReport& judged) {
    std::map<PairIds, std::size_t> row_of;
    for (const PairVerdicts& pair : judged.pairs) {
      if (pair.excluded) {
        report_.notes.push_back("excluded: " + part(pair.a).name + " × " + part(pair.b).name);
        continue;
      }
      const bool own = pair.like_a == PartId{};
      const PairIds leader = own ? PairIds{pair.a, pair.b} : PairIds{pair.like_a, pair.like_b};
      const auto [row, fresh] = row_of.try_emplace(leader, report_.pairs.size());
      if (fresh) {
        report_.pairs.emplace_back();
        report_.pairs.back().a = pair.a;
        report_.pairs.back().b = pair.b;
        report_.pairs.back().verdicts = pair.verdicts;
        report_.pairs.back().not_examined = pair.not_examined;
      }
      report_.pairs[row->second].all.emplace_back(pair.a, pair.b);
    }
    for (CheckedPair& pair : report_.pairs) {
      if (!pair.verdicts.empty()) pair.collision_class = pair.verdicts.front().collision_class;
      name_inside(pair);
    }
  }

  std::string common_product(const CheckedPair& pair) const {
    std::string product = inside_of(spec(pair.a), spec(pair.b));
    for (const PairIds& ids : pair.all)
      if (inside_of(spec(ids.first), spec(ids.second)) != product) return {};
    return product;
  }

  // Pairs that have no verdict and yet touch: the surfaces are nearer than the file is accurate to.
  void gather_touching(const std::vector<IndexPair>& candidates) {
    struct Known {
      bool touches = false;
      std::size_t row = 0;
    };
    std::map<PairStanding, Known> known;
    CcdScratch scratch;
    for (const IndexPair& ids : candidates) {
      const Part &a = world_.parts[ids.a], &b = world_.parts[ids.b];
      const auto [entry, fresh] = known.try_emplace(standing_of(a, b));
      if (fresh) {
        entry->second.touches = touch(a, b, scratch);
        if (entry->second.touches) {
          entry->second.row = report_.pairs.size();
          report_.pairs.emplace_back();
          CheckedPair& pair = report_.pairs.back();
          pair.a = a.id;
          pair.b = b.id;
          pair.collision_class = CollisionClass::kFake;
          pair.is_contact = true;
        }
      }
      if (entry->second.touches) report_.pairs[entry->second.row].all.emplace_back(a.id, b.id);
    }
    for (CheckedPair& pair : report_.pairs)
      if (pair.is_contact) name_inside(pair);
  }

  bool touch(const Part& a, const Part& b, CcdScratch& scratch) const {
    return distance(*a.solid, a.X_WP, *b.solid, b.X_WP, scratch, accuracy_of(a, b)).within_limit ||
           has_same_size(finder_, a, b);
  }

  void name_inside(CheckedPair& pair) const {
    pair.inside = common_product(pair);
    pair.muted = !pair.inside.empty() &&
                 std::all_of(pair.all.begin(), pair.all.end(), [&](const PairIds& ids) {
                   return spec(ids.first).bought && spec(ids.second).bought;
                 });
  }

  // 2. contacts, and what the parts are to each other

  // Do the surfaces overlap by no more than the file can tell?
  bool touches(const CheckedPair& pair, const Verdict& v) const {
    if (v.collision_class == CollisionClass::kFake) return true;
    const PairRule* rule = world_.rule(pair.a, pair.b);
    if (states_tolerance(part(pair.a), v.face_a, rule, true) ||
        states_tolerance(part(pair.b), v.face_b, rule, false))
      return false;
    if (v.grade == DeviationGrade::kNominal || v.grade == DeviationGrade::kUnknown ||
        v.grade == DeviationGrade::kDeclaredChord)
      return false;
    // What the real surfaces overlap at most.
    return v.delta_mm.hi - v.fake_below_mm <= pair.accuracy_mm;
  }

  void relate(CheckedPair& pair) {
    pair.mating = finder_.find(part(pair.a), part(pair.b));
    pair.accuracy_mm = accuracy_of(part(pair.a), part(pair.b));
    if (pair.is_contact && pair.mating.relation == MatingKind::kUnknown)
      pair.mating.relation = MatingKind::kTouching;
    if (pair.verdicts.empty()) return;
    if (!std::all_of(pair.verdicts.begin(), pair.verdicts.end(),
                     [&](const Verdict& v) { return touches(pair, v); }))
      return;
    pair.collision_class = CollisionClass::kFake;
    pair.is_contact = std::any_of(
        pair.verdicts.begin(), pair.verdicts.end(),
        [&](const Verdict& v) { return v.delta_mm.hi - v.fake_below_mm >= -pair.accuracy_mm; });
    if (pair.mating.relation == MatingKind::kUnknown) pair.mating.relation = MatingKind::kTouching;
  }

  // 3. what the exact solids say: of what may be explained, of what the meshes leave open, and of
  // the deepest others

  bool may_explain(const CheckedPair& pair) const {
    return pair.collision_class >= CollisionClass::kPotential && pair.mating.explained_mm3 > 0.0 &&
           !options_.unexplained.contains(std::string(name_of(pair.mating.relation)));
  }

  bool is_exact(const CheckedPair& pair) const {
    return opened_.exact && spec(pair.a).mesh.given && spec(pair.b).mesh.given;
  }

  void ask_exact_solids() {
    std::vector<CheckedPair*> asked, others;
    for (CheckedPair& pair : report_.pairs) {
      if (pair.collision_class < CollisionClass::kPotential || explained_by_fit(pair)) continue;
      if (!is_exact(pair)) {
        if (may_explain(pair)) pair.reason = "its exact volume is not known: not explained";
        continue;
      }
      const bool needed = may_explain(pair) || pair.collision_class == CollisionClass::kPotential;
      (needed ? asked : others).push_back(&pair);
    }
    std::stable_sort(others.begin(), others.end(), [](const auto* x, const auto* y) {
      return x->verdicts.front().delta_mm.lo > y->verdicts.front().delta_mm.lo;
    });
    others.resize(std::min(others.size(), kMostVolumes));
    asked.insert(asked.end(), others.begin(), others.end());
    std::vector<StepCommonQuery> queries;
    for (const CheckedPair* pair : asked)
      queries.push_back({spec(pair->a).mesh.given_number, spec(pair->b).mesh.given_number,
                         part(pair->a).X_WP.inverse() * part(pair->b).X_WP});
    if (queries.empty()) return;
    const auto commons = opened_.exact->commons(queries);
    if (!commons) report_.notes.push_back("exact volumes: " + commons.error().text);
    for (std::size_t i = 0; i < asked.size(); ++i)
      hear(*asked[i], commons ? (*commons)[i] : StepCommon{});
  }

  void hear(CheckedPair& pair, const StepCommon& common) {
    if (common.volume_mm3 < 0.0) {
      if (may_explain(pair)) pair.reason = "its exact volume could not be computed: not explained";
      return;
    }
    pair.common_mm3 = common.volume_mm3;
    pair.thickness_mm = common.thickness_mm;
    if (pair.collision_class == CollisionClass::kPotential) decide(pair);
    if (may_explain(pair)) judge_explanation(pair);
  }

  // Where nothing is stated of the faces that meet, the exact solids decide what facets cannot.
  void decide(CheckedPair& pair) const {
    const PairRule* rule = world_.rule(pair.a, pair.b);
    const bool stated =
        std::any_of(pair.verdicts.begin(), pair.verdicts.end(), [&](const Verdict& v) {
          return v.collision_class == CollisionClass::kPotential &&
                 (states_tolerance(part(pair.a), v.face_a, rule, true) ||
                  states_tolerance(part(pair.b), v.face_b, rule, false));
        });
    if (stated) return;
    if (pair.thickness_mm <= pair.accuracy_mm) {
      pair.collision_class = CollisionClass::kFake;
      pair.is_contact = true;
      pair.reason = pair.common_mm3 > 0.0
                        ? fmt::format(
                              "the exact solids have {:.3g} mm³ in common, {} thick: less "
                              "than the file is accurate to",
                              pair.common_mm3, length_text(pair.thickness_mm))
                        : "the exact solids have nothing in common";
      if (pair.mating.relation == MatingKind::kUnknown)
        pair.mating.relation = MatingKind::kTouching;
    } else if (pair.thickness_mm > kMostContact_mm) {
      pair.collision_class = CollisionClass::kReal;
      pair.reason = fmt::format("the exact solids have {:.3f} mm³ in common, {} thick",
                                pair.common_mm3, length_text(pair.thickness_mm));
    }
  }

  bool explained_by_fit(CheckedPair& pair) const {
    if (pair.verdicts.empty() || pair.collision_class != CollisionClass::kReal) return false;
    const PairRule* rule = world_.rule(pair.a, pair.b);
    if (rule == nullptr || rule->fit.empty()) return false;
    const bool all = std::all_of(pair.verdicts.begin(), pair.verdicts.end(), [&](auto& v) {
      return v.collision_class != CollisionClass::kReal ||
             v.explanation.find(rule->fit) != std::string::npos;
    });
    if (!all) return false;
    pair.explained = true;
    pair.mating.relation = MatingKind::kFitStated;
    pair.reason = "the fit " + rule->fit + " that is stated asks for interference";
    return true;
  }

  // What is told as a clash is judged with more work, which may decide it, and has a way out.
  void tell_clashes(Scratch& scratch) {
    std::size_t told = 0, left_out = 0;
    const std::clock_t until =
        std::clock() + static_cast<std::clock_t>(kMostWays_s * CLOCKS_PER_SEC);
    for (CheckedPair& pair : report_.pairs) {
      if (pair.explained || pair.muted || pair.collision_class < CollisionClass::kPotential)
        continue;
      const bool is_open = pair.collision_class == CollisionClass::kPotential;
      if (!is_open && (told++ >= kMostWays || std::clock() > until)) {
        ++left_out;
        continue;
      }
      PairVerdicts again = tell_pair(world_, pair.a, pair.b, kTellWork, scratch);
      if (again.verdicts.empty()) {
        if (is_open) leave_apart(pair);
        continue;
      }
      const CollisionClass now = again.verdicts.front().collision_class;
      // What the exact solids said stays.
      if (!is_open && now != pair.verdicts.front().collision_class && now != CollisionClass::kReal)
        continue;
      pair.verdicts = std::move(again.verdicts);
      if (!is_open || now == CollisionClass::kPotential) continue;
      pair.collision_class = now;
      relate(pair);
      if (pair.common_mm3 >= 0.0 && may_explain(pair)) judge_explanation(pair);
    }
    std::erase_if(report_.pairs, [](const CheckedPair& pair) {
      return pair.collision_class == CollisionClass::kNone && !pair.not_examined;
    });
    if (left_out > 0)
      report_.notes.push_back("ways out are told of " + std::to_string(told - left_out) +
                              " clashes, not of " + std::to_string(left_out) + " more");
  }

  // With more work no verdict is left: the parts touch at most.
  void leave_apart(CheckedPair& pair) {
    CcdScratch scratch;
    pair.verdicts.clear();
    pair.is_contact = touch(part(pair.a), part(pair.b), scratch);
    pair.collision_class = pair.is_contact ? CollisionClass::kFake : CollisionClass::kNone;
    relate(pair);
  }

  // 4. clearances

  void find_near() {
    double& gap_mm = report_.min_gap_mm = options_.min_gap_mm;
    if (!(gap_mm > 0.0)) gap_mm = opened_.scenario.min_gap_mm;
    const std::map<PairIds, double>& of_pairs_mm = opened_.scene.min_gaps_mm;
    report_.asks_gaps = gap_mm > 0.0 || !of_pairs_mm.empty();
    if (!report_.asks_gaps) return;
    NearQuery query;
    query.required_mm = gap_mm;
    query.of_pairs_mm = of_pairs_mm;
    for (const CheckedPair& pair : report_.pairs)
      for (const PairIds& ids : pair.all)
        if (pair.collision_class != CollisionClass::kNone) query.left_out.insert(ids);
    report_.near = near_pairs(world_, query);
  }

  OpenedScene& opened_;
  World& world_;
  const CheckOptions& options_;
  MatingFinder finder_;
  CheckReport report_;
};

// What is read first: unexplained real, potential, explained, contacts, other fake ones.
int section_of(const CheckedPair& pair) {
  if (pair.muted) return 5;
  if (pair.explained) return 2;
  if (pair.collision_class == CollisionClass::kReal) return 0;
  if (pair.collision_class == CollisionClass::kPotential) return 1;
  return pair.is_contact ? 3 : 4;
}

}  // namespace

void order_and_count(CheckReport& report) {
  const auto depth = [](const CheckedPair& pair) {
    return pair.verdicts.empty() ? 0.0 : pair.verdicts.front().delta_mm.lo;
  };
  std::stable_sort(report.pairs.begin(), report.pairs.end(),
                   [&](const CheckedPair& x, const CheckedPair& y) {
                     if (section_of(x) != section_of(y)) return section_of(x) < section_of(y);
                     if (depth(x) != depth(y)) return depth(x) > depth(y);
                     return std::pair(x.a, x.b) < std::pair(y.a, y.b);
                   });
  CheckCounts counts;
  for (const CheckedPair& pair : report.pairs) {
    const std::size_t n = pair.all.size();
    switch (section_of(pair)) {
      case 0:
        counts.unexplained_real += n;
        break;
      case 1:
        counts.potential += n;
        break;
      case 2:
        (pair.collision_class == CollisionClass::kReal ? counts.explained_real
                                                       : counts.explained_potential) += n;
        break;
      case 3:
        counts.contacts += n;
        break;
      case 4:
        counts.fake += n;
        break;
      default:
        counts.muted += n;
    }
  }
  counts.near = report.near.size();
  counts.not_judged = report.not_judged.size();
  report.counts = counts;
}

CheckReport check_scene(OpenedScene& opened, const CheckOptions& options) {
  return Checker(opened, options).run();
}

}  // namespace mortise

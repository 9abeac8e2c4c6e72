#include <algorithm>
#include <cmath>

#include "client/api/convert.h"
#include "client/api/judgement.h"
#include "client/api/opened_parts.h"
#include "client/api/part_body.h"
#include "client/tools/judge/judge_report.h"
#include "common/base/json_text.h"
#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"

namespace mortise::api {
namespace {

// More than any machine has cores; a larger number is a mistake of the caller.
constexpr int kMostThreads = 256;

Error no_pose(const std::string& which) {
  return {Code::kInvalidInput, which + " is no finite rigid motion"};
}

bool is_length(double x) { return x >= 0.0 && x <= mortise::kLargestCoordinate_mm; }

}  // namespace

bool is_thread_count(int threads) { return threads >= 1 && threads <= kMostThreads; }

mortise::Result<mortise::OpenedScene> open_pair(const Part& a, const Part& b,
                                                const JudgeOptions& options) {
  const auto bad = [](const std::string& text) {
    return mortise::fail(mortise::Code::kInvalidInput, text);
  };
  if (!is_thread_count(options.threads)) return bad("threads must lie between 1 and 256");
  const auto X_WA = pose_in(options.X_WA), X_WB = pose_in(options.X_WB);
  if (!X_WA || !X_WB) return bad(no_pose(X_WA ? "X_WB" : "X_WA").text);
  std::vector<PlacedBody> parts{{a, a.name(), *X_WA, false}};
  parts.push_back({b, unlike(b.name(), parts), *X_WB, true});
  PairSayings sayings;
  if (!options.fit.empty()) sayings.fits.push_back({0, 1, "", "", options.fit});
  return open_parts(parts, sayings);
}

Judgement judgement_of(const mortise::OpenedScene& opened, const mortise::JudgeReport& report) {
  const mortise::World& world = opened.scene.world;
  Judgement judgement;
  for (const mortise::PairVerdicts& pair : report.pairs) {
    const std::string &a = world.find(pair.a)->name, &b = world.find(pair.b)->name;
    if (pair.not_examined)
      judgement.notes.push_back(a + " × " + b +
                                ": one may lie inside the other, of which the inside is not known");
    for (const mortise::Verdict& verdict : pair.verdicts) {
      const mortise::Part* blocker = world.find(verdict.separation_blocker);
      judgement.clashes.push_back(
          clash_of(verdict, {a, b, blocker != nullptr ? blocker->name : ""}));
    }
  }
  for (const mortise::Finding& finding : opened.findings) judgement.notes.push_back(finding.text);
  judgement.json = mortise::json_text(mortise::judge_json(opened, report)) + "\n";
  return judgement;
}

CollisionClass Judgement::worst() const {
  CollisionClass worst = CollisionClass::kNone;
  for (const Clash& clash : clashes) worst = std::max(worst, clash.collision_class);
  return worst;
}

Result<Judgement> judge(const Part& a, const Part& b, const JudgeOptions& options) {
  mortise::Result<mortise::OpenedScene> opened = open_pair(a, b, options);
  if (!opened) return error_of(opened.error());
  mortise::Scratch scratch(options.threads);
  return judgement_of(*opened, mortise::judge_world(opened->scene.world, scratch, options.full));
}

Result<Distance> distance(const Part& a, const Part& b, const Pose& X_WA, const Pose& X_WB,
                          double limit_mm) {
  const auto A = pose_in(X_WA), B = pose_in(X_WB);
  if (!A || !B) return no_pose(A ? "X_WB" : "X_WA");
  if (!(limit_mm >= 0.0)) return Error{Code::kInvalidInput, "limit_mm must be 0 or more"};
  mortise::CcdScratch scratch;
  const mortise::DistanceResult found =
      mortise::distance(*a.impl().body->solid, *A, *b.impl().body->solid, *B, scratch, limit_mm);
  return Distance{found.distance_mm, found.within_limit, found.point_a_W, found.point_b_W};
}

Result<FirstContact> first_contact(const Part& a, const Part& b, const Motion& motion,
                                   const ContactOptions& options) {
  const auto X_W0 = pose_in(motion.X_W0), X_W1 = pose_in(motion.X_W1), X_WB = pose_in(options.X_WB);
  if (!X_W0 || !X_W1) return no_pose(X_W0 ? "X_W1" : "X_W0");
  if (!X_WB) return no_pose("X_WB");
  if (!is_length(options.accuracy_mm) || !is_length(options.separation_mm))
    return Error{Code::kInvalidInput, "accuracy_mm and separation_mm must be 0 or more"};
  const mortise::Solid& solid = *a.impl().body->solid;
  const Vec3 reference_P = motion.reference_P.value_or(solid.sphere().center_mm);
  if (!is_within(reference_P, mortise::kLargestCoordinate_mm))
    return Error{Code::kInvalidInput, "reference_P is not finite"};
  mortise::ContactQuery query;
  query.a = &solid;
  query.b = b.impl().body->solid.get();
  query.motion_a = motion.path == Motion::Path::kScrew
                       ? mortise::screw_motion(*X_W0, *X_W1, reference_P)
                       : mortise::linear_motion(*X_W0, *X_W1, reference_P);
  query.motion_b = mortise::still_motion(*X_WB);
  query.accuracy_mm = options.accuracy_mm;
  query.separation_mm = options.separation_mm;
  mortise::CcdScratch scratch;
  const mortise::FirstContact found = mortise::first_contact(query, scratch);
  FirstContact answer;
  using In = mortise::ContactState;
  using Out = FirstContact::State;
  answer.state = found.state == In::kFree                 ? Out::kFree
                 : found.state == In::kContact            ? Out::kContact
                 : found.state == In::kTouchingAtStart    ? Out::kTouchingAtStart
                 : found.state == In::kOverlappingAtStart ? Out::kOverlappingAtStart
                                                          : Out::kUndecided;
  answer.t_clear = found.t_clear;
  answer.t_contact = found.t_contact;
  answer.distance_mm = found.distance_mm;
  answer.point_a_W = found.point_a_W;
  answer.point_b_W = found.point_b_W;
  return answer;
}

}  // namespace mortise::api

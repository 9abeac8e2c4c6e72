#pragma once
#include <algorithm>
#include <limits>

#include "common/ccd/distance.h"
#include "common/io/state/state_bytes.h"
#include "common/session/memory/session_state.h"
#include "common/session/tick/statistics.h"

/// The members of the state of a session between two ticks, each named once for writing and
/// reading. Every type is decomposed completely: after a new member the file does not compile until
/// the member is listed here.
namespace mortise {

template <class A>
void fields(A& a, Pose& x) {
  auto& [q, p] = x;
  a(q, p);
}
template <class A>
void fields(A& a, Interval& x) {
  auto& [lo, hi] = x;
  a(lo, hi);
}
template <class A>
void fields(A& a, IndexPair& x) {
  auto& [first, second] = x;
  a(first, second);
}

template <class A>
void fields(A& a, FeatureOf& x) {
  auto& [part, feature] = x;
  a(part, feature);
}
template <class A>
void fields(A& a, Constraint& x) {
  auto& [kind, held, other, distance_mm, snap] = x;
  a(kind, held, other, distance_mm, snap);
}
template <class A>
void fields(A& a, PartEdit& x) {
  auto& [name, mesh_hash, X_WP, moving, quantum_mm] = x;
  a(name, mesh_hash, X_WP, moving, quantum_mm);
}
template <class A>
void fields(A& a, Details& x) {
  auto& [parts, other_part, feature, other_feature, other_user, clash, status, text, constraint,
         constraint_id, edit] = x;
  a(parts, other_part, feature, other_feature, other_user, clash, status, text, constraint,
    constraint_id, edit);
}
template <class A>
void fields(A& a, Decision& x) {
  auto& [kind, user, part, user_name, role, details] = x;
  a(kind, user, part, user_name, role, details);
}
template <class A>
void fields(A& a, Review& x) {
  auto& [status, comment, user, tick] = x;
  a(status, comment, user, tick);
}

template <class A>
void fields(A& a, Remark& x) {
  auto& [clash, user, assignee, status, tick, text] = x;
  a(clash, user, assignee, status, tick, text);
}

template <class A>
void fields(A& a, Verdict& x) {
  auto& [collision_class, delta_mm, gpd_mm, fake_below_mm, real_above_mm, margin_mm, probability,
         travel_mm, normal_travel_mm, point_W, normal_W, area_mm2, has_witness, witness_W,
         separation_translation_mm, separation_rotation_rad, separation_about_W, separation_of_b,
         separation_way, separation_path, separation_blocker, shape_a, shape_b, grade, face_a,
         face_b, explanation] = x;
  a(collision_class, delta_mm, gpd_mm, fake_below_mm, real_above_mm, margin_mm, probability,
    travel_mm, normal_travel_mm, point_W, normal_W, area_mm2, has_witness, witness_W,
    separation_translation_mm, separation_rotation_rad, separation_about_W, separation_of_b,
    separation_way, separation_path, separation_blocker, shape_a, shape_b, grade, face_a, face_b,
    explanation);
}
template <class A>
void fields(A& a, ClashEvent& x) {
  auto& [kind, seq, tick, clash, part_a, part_b, user, verdict, t_contact, t_potential, t_real,
         begin_tick, worst_class, worst_delta_mm, cause, review, approval_lost] = x;
  a(kind, seq, tick, clash, part_a, part_b, user, verdict, t_contact, t_potential, t_real,
    begin_tick, worst_class, worst_delta_mm, cause, review, approval_lost);
}
template <class A>
void fields(A& a, OpenClash& x) {
  auto& [last, now, worst_class, worst_delta_mm, p_A, p_B, approved_class, approved_delta_mm,
         revised] = x;
  a(last, now, worst_class, worst_delta_mm, p_A, p_B, approved_class, approved_delta_mm, revised);
}

/// But for what was found in its mesh, which is for people alone, as that of a part is.
template <class A>
void fields(A& a, PartForm& x) {
  auto& [present, moving, mesh, notes] = x;
  a(present, moving, mesh);
}
template <class A>
void fields(A& a, MoveHistory::Done& x) {
  auto& [user, X_WP_before, number, form_before] = x;
  a(user, X_WP_before, number, form_before);
}
template <class A>
void fields(A& a, MoveHistory::Undone& x) {
  auto& [move, X_WP_after, below, form_after] = x;
  a(move, X_WP_after, below, form_after);
}
template <class A>
void fields(A& a, MoveHistory& x) {
  auto& [done, undone, moves, open] = x;
  a(done, undone, moves, open);
}
/// The members of a part that a session changes, without its band; the rest comes with the scene.
template <class A>
void fields(A& a, Part& x) {
  auto& [id, name, solid, band, features, moving, present, edits, X_WP_scenario, X_WP, holder,
         asked_by, history, notes, group, kind] = x;
  a(X_WP, holder, asked_by, history, group, moving, present, edits);
}
template <class A>
void fields(A& a, User& x) {
  auto& [id, name, present, last_seq, role] = x;
  a(id, name, present, last_seq, role);
}

template <class A>
void fields(A& a, Element& x) {
  auto& [kind, point, direction] = x;
  a(kind, point, direction);
}
template <class A>
void fields(A& a, Relation& x) {
  auto& [of_a, of_b, opposed, distance_mm] = x;
  a(of_a, of_b, opposed, distance_mm);
}
template <class A>
void fields(A& a, Guide& x) {
  auto& [id, user, constraint, relation, follows] = x;
  a(id, user, constraint, relation, follows);
}

template <class A>
void fields(A& a, CertainPlace& x) {
  auto& [role, triangle, point_S] = x;
  a(role, triangle, point_S);
}
template <class A>
void fields(A& a, DistanceResult& x) {
  auto& [distance_mm, triangle_a, triangle_b, point_a_W, point_b_W, within_limit] = x;
  a(distance_mm, triangle_a, triangle_b, point_a_W, point_b_W, within_limit);
}
template <class A>
void fields(A& a, PairMemo::Held& x) {
  auto& [X_WA, X_WB, place, gave_up] = x;
  a(X_WA, X_WB, place, gave_up);
}
template <class A>
void fields(A& a, PairMemo::Stalled& x) {
  auto& [X_WA, X_WB, shift, turn, in_full, judged, in_vain] = x;
  a(X_WA, X_WB, shift, turn, in_full, judged, in_vain);
}
template <class A>
void fields(A& a, PairMemo::Effort& x) {
  auto& [wanted, waited] = x;
  // A byte, as it is in all files; who has waited longer than that has the whole number behind it.
  constexpr std::uint8_t kLonger = std::numeric_limits<std::uint8_t>::max();
  auto few = static_cast<std::uint8_t>(std::min<std::uint32_t>(waited, kLonger));
  a(wanted, few);
  if (few == kLonger)
    a(waited);
  else if constexpr (A::reads())
    waited = few;
}
/// But for what is about copies of it.
template <class A>
void fields(A& a, PairMemo& x) {
  auto& [not_judged, not_seen, X_BA, apart_mm, placements, not_contained, pause, next_pause,
         nearest, allowed_depth_mm, held, stalled, effort, touched, touched_tick] = x;
  a(not_judged, not_seen, X_BA, apart_mm, placements, not_contained, pause, next_pause, nearest,
    allowed_depth_mm, held, stalled, effort);
}
template <class A>
void fields(A& a, PartState& x) {
  auto& [growth_mm, placements, last_tick, last_user, hash, cause, cause_user, cause_tick] = x;
  a(growth_mm, placements, last_tick, last_user, hash, cause, cause_user, cause_tick);
}
template <class A>
void fields(A& a, KeptPush& x) {
  auto& [part, user, X_WP, shift_mm, turn_rad] = x;
  a(part, user, X_WP, shift_mm, turn_rad);
}
/// But for the boxes, which follow from poses and growth, and the memos, which are written apart.
template <class A>
void fields(A& a, SessionState& x) {
  auto& [tick, event_seq, next_clash, present_parts, moving_parts, broad_phase, parts, placed, owed,
         kept, rehash, memos, touched, open, reviews, clashes_changed, edited, saved_work,
         saved_tests, parts_hash, clashes_hash] = x;
  a(tick, event_seq, next_clash, present_parts, moving_parts, parts, placed, owed, kept, rehash,
    open, reviews, clashes_changed, edited, saved_work, saved_tests, parts_hash, clashes_hash);
}

template <class A>
void fields(A& a, StageCount& x) {
  auto& [in, out] = x;
  a(in, out);
}
/// But for event_times_at_latest, which follows at the end of what files of before lack it in.
template <class A>
void fields(A& a, StepCounters& x) {
  auto& [increments, refused, moves, moves_below_rounding, pairs, pairs_static, pairs_still,
         pairs_excluded, pairs_boxes_apart, pairs_budget, contacts, contacts_clear,
         contacts_undecided, first_contact_queries, distance_queries, depth_queries,
         event_time_queries, event_times_at_latest, judged_with_bands, judged_plain,
         regions_decided_early, regions_refined, verdicts, verdicts_by_class, stopped_parts, rounds,
         slid_parts, slide_legs, slide_holds, slides_cut_short, box_tests, triangle_tests,
         depth_evaluations, parts_without_inside, pairs_waiting, pairs_held_again, pushes_cut,
         not_examined] = x;
  a(increments, refused, moves, moves_below_rounding, pairs, pairs_static, pairs_still,
    pairs_excluded, pairs_boxes_apart, pairs_budget, contacts, contacts_clear, contacts_undecided,
    first_contact_queries, distance_queries, depth_queries, event_time_queries, judged_with_bands,
    judged_plain, regions_decided_early, regions_refined, verdicts, verdicts_by_class,
    stopped_parts, rounds, slid_parts, slide_legs, slide_holds, slides_cut_short, box_tests,
    triangle_tests, depth_evaluations, parts_without_inside, pairs_waiting, pairs_held_again,
    pushes_cut, not_examined);
}
template <class A>
void fields(A& a, SessionStatistics::Row& x) {
  auto& [clashes, ticks, worst, first_tick, last_tick, worst_tick] = x;
  a(clashes, ticks, worst, first_tick, last_tick, worst_tick);
}
template <class A>
void fields(A& a, SessionStatistics::ClashRow& x) {
  auto& [clash, part_a, part_b, user, begin_tick, end_tick, worst_class, worst, ticks, now] = x;
  a(clash, part_a, part_b, user, begin_tick, end_tick, worst_class, worst, ticks, now);
}
template <class A>
void fields(A& a, SessionStatistics& x) {
  a(x.ticks_, x.counters_, x.by_pair_, x.by_part_, x.by_user_, x.clashes_, x.open_, x.ended_,
    x.total_, x.rows_left_out_);
  if constexpr (A::reads()) {
    if (a.at_end()) return;  // of a file of before
  }
  a(x.counters_.event_times_at_latest);
}

/// What a pair has of its own as far as it is not said again with the changes of tolerances.
struct PairStatement {
  PartId a, b;
  bool has_band_a = false, has_band_b = false, excluded = false;
  std::string fit, reason;
};
template <class A>
void fields(A& a, PairStatement& x) {
  auto& [part_a, part_b, has_band_a, has_band_b, excluded, fit, reason] = x;
  a(part_a, part_b, has_band_a, has_band_b, excluded, fit, reason);
}

}  // namespace mortise

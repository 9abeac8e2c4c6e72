// The door for what people say and what is decided: details of commands, decisions, reviews.
#include "idl/convert.h"
#include "idl/door.h"

namespace mortise {
namespace {

wire::Constraint to_wire(const Constraint& constraint) {
  wire::Constraint out;
  out.kind(static_cast<std::uint8_t>(constraint.kind));
  out.held_part(constraint.held.part.value);
  out.other_part(constraint.other.part.value);
  out.distance_mm(constraint.distance_mm);
  out.snap(constraint.snap);
  out.held_feature(clip(constraint.held.feature, kMaxName_bytes));
  out.other_feature(clip(constraint.other.feature, kMaxName_bytes));
  return out;
}

void check(const wire::Constraint& in, Door& door) {
  door.need(in.kind() < kConstraintKindCount, "constraint");
  door.need(std::abs(in.distance_mm()) <= kMaxCoordinate_mm, "distance_mm");
  door.name(in.held_feature(), "held_feature");
  door.name(in.other_feature(), "other_feature");
}

Constraint constraint_of(const wire::Constraint& in) {
  return {static_cast<ConstraintKind>(in.kind()),
          {PartId{in.held_part()}, in.held_feature()},
          {PartId{in.other_part()}, in.other_feature()},
          in.distance_mm(),
          in.snap()};
}

/// Details lie in Request and in Decision under the same names.
template <class Wire>
void put(const Details& details, Wire& out) {
  for (const PartId part : details.parts) out.parts().push_back(part.value);
  out.other_part(details.other_part.value);
  out.feature(clip(details.feature, kMaxName_bytes));
  out.other_feature(clip(details.other_feature, kMaxName_bytes));
  out.other_user(details.other_user.value);
  out.clash(details.clash.value);
  out.status(static_cast<std::uint8_t>(details.status));
  out.text(clip(details.text, kMaxText_bytes));
  out.constraint(to_wire(details.constraint));
  out.constraint_id(details.constraint_id.value);
}

template <class Wire>
void check_details(const Wire& in, Door& door) {
  door.need(in.parts().size() <= kMostGroupParts, "parts");
  for (const std::uint32_t part : in.parts()) door.need(part != 0, "parts");
  door.name(in.feature(), "feature");
  door.name(in.other_feature(), "other_feature");
  door.need(in.status() < kReviewStatusCount, "status");
  door.text(in.text(), "text");
  check(in.constraint(), door);
}

template <class Wire>
Details details_of(const Wire& in) {
  Details details;
  for (const std::uint32_t part : in.parts()) details.parts.push_back(PartId{part});
  details.other_part = PartId{in.other_part()};
  details.feature = in.feature();
  details.other_feature = in.other_feature();
  details.other_user = UserId{in.other_user()};
  details.clash = ClashId{in.clash()};
  details.status = static_cast<ReviewStatus>(in.status());
  details.text = in.text();
  details.constraint = constraint_of(in.constraint());
  details.constraint_id = ConstraintId{in.constraint_id()};
  return details;
}

}  // namespace

void details_to_wire(const Details& details, wire::Request& out) { put(details, out); }

Result<Details> details_from_wire(const wire::Request& in) {
  Door door("request");
  check_details(in, door);
  if (!door.open()) return door.refusal();
  return details_of(in);
}

wire::Decision to_wire(const Decision& decision) {
  wire::Decision out;
  out.kind(static_cast<std::uint8_t>(decision.kind));
  out.role(static_cast<std::uint8_t>(decision.role));
  out.user(decision.user.value);
  out.part(decision.part.value);
  out.user_name(clip(decision.user_name, kMaxName_bytes));
  put(decision.details, out);
  return out;
}

Result<Decision> from_wire(const wire::Decision& in) {
  Door door("decision");
  door.need(in.kind() != 0 && in.kind() < kDecisionKindCount, "kind");
  door.need(in.role() < kRoleCount, "role");
  door.name(in.user_name(), "user_name");
  check_details(in, door);
  if (!door.open()) return door.refusal();
  Decision decision;
  decision.kind = static_cast<Decision::Kind>(in.kind());
  decision.role = static_cast<Role>(in.role());
  decision.user = UserId{in.user()};
  decision.part = PartId{in.part()};
  decision.user_name = in.user_name();
  decision.details = details_of(in);
  return decision;
}

wire::EventNote note_to_wire(const ClashEvent& event) {
  wire::EventNote out;
  out.cause(static_cast<std::uint8_t>(event.cause));
  out.status(static_cast<std::uint8_t>(event.review.status));
  out.approval_lost(event.approval_lost);
  out.reviewer(event.review.user.value);
  out.review_tick(event.review.tick);
  out.comment(clip(event.review.comment, kMaxText_bytes));
  return out;
}

Status add_note(const wire::EventNote& in, ClashEvent& event) {
  Door door("event note");
  door.need(in.cause() < kDecisionKindCount, "cause");
  door.need(in.status() < kReviewStatusCount, "status");
  door.text(in.comment(), "comment");
  if (!door.open()) return door.refusal();
  event.cause = static_cast<Decision::Kind>(in.cause());
  event.approval_lost = in.approval_lost();
  event.review = {static_cast<ReviewStatus>(in.status()), in.comment(), UserId{in.reviewer()},
                  in.review_tick()};
  return ok();
}

std::vector<ClashEvent> events_from_wire(const wire::EventBatch& batch, std::uint64_t& malformed) {
  std::vector<ClashEvent> events;
  if (batch.notes().size() != batch.events().size() || batch.events().size() > kMaxSequence) {
    ++malformed;
    return events;
  }
  for (std::size_t i = 0; i < batch.events().size(); ++i) {
    Result<ClashEvent> event = from_wire(batch.events()[i]);
    if (event && add_note(batch.notes()[i], *event)) {
      events.push_back(std::move(*event));
    } else {
      ++malformed;
    }
  }
  return events;
}

}  // namespace mortise

// What a user may ask for, and what the server's decisions change in what a client knows.
#include <algorithm>
#include <utility>

#include "client/client.h"

namespace mortise {
namespace {

Details of_group(std::vector<PartId> parts) {
  Details details;
  details.parts = std::move(parts);
  return details;
}

Details of_pair(PartId other, const std::string& text) {
  Details details;
  details.other_part = other;
  details.text = text;
  return details;
}

Details of_text(const std::string& text) {
  Details details;
  details.text = text;
  return details;
}

}  // namespace

std::uint64_t Client::command(LocalUser index, CommandKind kind, PartId part, Details details) {
  LocalUserState& user = users_[index];
  if (user.state != JoinState::kJoined) {
    ++statistics_.not_joined;
    return 0;
  }
  // A release must not overtake the end of the drag: once more what is not acknowledged yet.
  if (!user.unacknowledged.empty()) channel_.send(user.unacknowledged.repeat(now_ns_));
  channel_.send(Command{user.id, part, ++user.command_seq, kind, std::move(details),
                        user.unacknowledged.newest()});
  return user.command_seq;
}

std::uint64_t Client::grab(LocalUser user, PartId part) {
  return command(user, CommandKind::kGrab, part);
}
std::uint64_t Client::grab(LocalUser user, std::vector<PartId> parts) {
  return command(user, CommandKind::kGrab, PartId{}, of_group(std::move(parts)));
}
std::uint64_t Client::release(LocalUser user, PartId part) {
  return command(user, CommandKind::kRelease, part);
}
std::uint64_t Client::release(LocalUser user, std::vector<PartId> parts) {
  return command(user, CommandKind::kRelease, PartId{}, of_group(std::move(parts)));
}
std::uint64_t Client::undo(LocalUser user, PartId part) {
  return command(user, CommandKind::kUndo, part);
}
std::uint64_t Client::redo(LocalUser user, PartId part) {
  return command(user, CommandKind::kRedo, part);
}
std::uint64_t Client::reset(LocalUser user, PartId part) {
  return command(user, CommandKind::kReset, part);
}
std::uint64_t Client::ask_hand_over(LocalUser user, PartId part) {
  return command(user, CommandKind::kAskHandOver, part);
}
std::uint64_t Client::consent(LocalUser user, PartId part) {
  return command(user, CommandKind::kConsent, part);
}
std::uint64_t Client::decline(LocalUser user, PartId part, const std::string& why) {
  return command(user, CommandKind::kDecline, part, of_text(why));
}
std::uint64_t Client::set_policy(LocalUser user, const std::string& policy) {
  return command(user, CommandKind::kSetPolicy, PartId{}, of_text(policy));
}
std::uint64_t Client::set_tolerance(LocalUser user, PartId part, const std::string& feature,
                                    const std::string& text) {
  Details details = of_text(text);
  details.feature = feature;
  return command(user, CommandKind::kSetTolerance, part, std::move(details));
}
std::uint64_t Client::set_fit(LocalUser user, const FeatureOf& a, const FeatureOf& b,
                              const std::string& text) {
  Details details = of_pair(b.part, text);
  details.feature = a.feature;
  details.other_feature = b.feature;
  return command(user, CommandKind::kSetTolerance, a.part, std::move(details));
}
std::uint64_t Client::exclude(LocalUser user, PartId a, PartId b, const std::string& reason) {
  return command(user, CommandKind::kSetExclusion, a, of_pair(b, reason));
}
std::uint64_t Client::include(LocalUser user, PartId a, PartId b) {
  return command(user, CommandKind::kDropExclusion, a, of_pair(b, ""));
}
std::uint64_t Client::review(LocalUser user, ClashId clash, ReviewStatus status,
                             const std::string& comment) {
  Details details = of_text(comment);
  details.clash = clash;
  details.status = status;
  return command(user, CommandKind::kReview, PartId{}, std::move(details));
}
std::uint64_t Client::add_constraint(LocalUser user, const Constraint& constraint) {
  Details details;
  details.constraint = constraint;
  return command(user, CommandKind::kAddConstraint, constraint.held.part, std::move(details));
}
std::uint64_t Client::snap(LocalUser user, PartId held, const FeatureOf& other,
                           const std::string& feature, ConstraintKind kind) {
  Details details;
  details.constraint = {kind, {held, feature}, other, 0.0, true};
  return command(user, CommandKind::kSnap, held, std::move(details));
}
std::uint64_t Client::drop_constraint(LocalUser user, PartId held, ConstraintId constraint) {
  Details details;
  details.constraint_id = constraint;
  return command(user, CommandKind::kDropConstraint, held, std::move(details));
}

UserInfo& Client::known_user(UserId id) {
  const auto found = std::find_if(session_users_.begin(), session_users_.end(),
                                  [id](const UserInfo& user) { return user.user == id; });
  if (found != session_users_.end()) return *found;
  session_users_.push_back({id, "", false, Role::kUnknown});
  return session_users_.back();
}

// Somebody else has the id now: what it stands for in clashes is nobody's.
void Client::forget_user(UserId id) {
  const auto forget = [id](UserId& by) {
    if (by == id) by = UserId{};
  };
  for (auto& [clash, event] : open_clashes_) {
    forget(event.user);
    forget(event.review.user);
  }
}

void Client::doubt(const UserInfo& who) {
  LocalUserState* user = own_user(who.user);
  if (user != nullptr && (!who.present || who.name != user->name)) user->in_doubt = true;
}

void Client::apply_decision(const Decision& decision, ClientUpdate& update) {
  switch (decision.kind) {
    case Decision::Kind::kJoin: {
      if (takes_over_id(decision)) forget_user(decision.user);
      UserInfo& user = known_user(decision.user);
      user.present = true;
      user.role = decision.role;
      user.name = decision.user_name;
      doubt(user);
      break;
    }
    case Decision::Kind::kLeave:
    case Decision::Kind::kLivelinessLost:
      known_user(decision.user).present = false;
      break;
    case Decision::Kind::kSetPolicy:
      policy_ = decision.details.text;
      break;
    default:
      break;
  }
  update.decisions.push_back(decision);
}

}  // namespace mortise

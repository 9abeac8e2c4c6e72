#include <mortise/session.h>

#include <algorithm>
#include <map>

#include "client/api/convert.h"
#include "client/api/judgement.h"
#include "client/api/opened_parts.h"
#include "client/api/part_body.h"
#include "common/messages/names.h"
#include "common/session/memory/session_state.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "common/session/world/rights.h"
#include "common/session/world/surface_rules.h"

namespace mortise::api {
namespace {

// Ticks that one push may take until nothing waits for work: far more than any has needed.
constexpr int kMostTicks = 10'000;

}  // namespace

struct Session::Impl {
  explicit Impl(const SessionOptions& wanted)
      : options(wanted), scratch(is_thread_count(wanted.threads) ? wanted.threads : 1) {}

  struct StatedTolerance {
    std::size_t part = 0;
    std::string feature, text;
  };

  SessionOptions options;
  mortise::Scratch scratch;
  std::vector<PlacedBody> parts;
  std::vector<std::string> holder;  // by part; empty: nobody
  PairSayings sayings;
  std::vector<StatedTolerance> tolerances;
  mortise::OpenedScene opened;
  bool ready = false;  // `opened` holds what is said above
  std::map<std::string, std::uint64_t> last_seq;
  Status status;

  mortise::World& world() { return opened.scene.world; }

  Status failed(const std::string& text, Code code = Code::kInvalidInput) {
    if (status) status = Error{code, text};
    return status;
  }
  bool knows(PartRef part) const { return part.value >= 1 && part.value <= parts.size(); }
  Status unknown_part() { return failed("there is no such part in the session"); }

  // What changes the scene itself: it is opened anew, with all parts where they stand.
  void touch() {
    if (ready)
      for (std::size_t i = 0; i < parts.size(); ++i) parts[i].X_WP = world().parts[i].X_WP;
    ready = false;
  }

  Status open() {
    if (!status || ready) return status;
    if (!is_thread_count(options.threads)) return failed("threads must lie between 1 and 256");
    const auto policy = mortise::policy_named(options.policy);
    if (!policy)
      return failed("policy '" + options.policy + "' is not known; write stop, slide or report");
    if (!(options.max_jump_mm > 0.0 && options.max_jump_mm <= mortise::kLargestCoordinate_mm))
      return failed("max_jump_mm must be greater than 0");
    if (parts.empty()) return failed("the session has no parts; add one");
    mortise::Result<mortise::OpenedScene> made = open_parts(parts, sayings);
    if (!made) return status = error_of(made.error());
    opened = std::move(*made);
    world().policy = *policy;
    world().max_jump_mm = options.max_jump_mm;
    ready = true;
    for (const StatedTolerance& stated : tolerances)
      if (const Status done = state(stated); !done) return done;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (!holder[i].empty())
        if (const Status done = grab(holder[i], i); !done) return done;
    return status;
  }

  Status state(const StatedTolerance& stated) {
    mortise::Decision decision;
    decision.kind = mortise::Decision::Kind::kSetTolerance;
    decision.part = world().parts[stated.part].id;
    decision.details.feature = stated.feature;
    decision.details.text = stated.text;
    const mortise::Status done = mortise::set_tolerance(world(), decision);
    return done ? status : (status = error_of(done.error()));
  }

  mortise::UserId user_of(const std::string& name) {
    for (const mortise::User& user : world().users)
      if (user.name == name) return user.id;
    mortise::Decision join;
    join.kind = mortise::Decision::Kind::kJoin;
    join.user_name = name;
    join.role = mortise::Role::kDesigner;
    mortise::apply_decision(world(), join);
    return world().users.back().id;
  }

  Status grab(const std::string& user, std::size_t index) {
    mortise::Command command;
    command.user = user_of(user);
    command.part = world().parts[index].id;
    command.kind = mortise::CommandKind::kGrab;
    mortise::Decision decision;
    const mortise::Reply reply = mortise::apply_command(world(), command, decision);
    if (reply.refusal != mortise::Refusal::kNone) return failed(reply.text);
    return status;
  }

  // One tick with the push, and further ones until all of it is carried out and judged.
  mortise::StepReport run(const mortise::Increment& increment) {
    mortise::StepReport report = mortise::step(world(), std::span(&increment, 1), scratch);
    const auto refused = report.refused;
    for (int tick = 0; tick < kMostTicks; ++tick) {
      const mortise::SessionState& state = mortise::session_state(world());
      if (state.owed.empty() && state.kept.empty()) break;
      report = mortise::step(world(), {}, scratch);
    }
    report.refused = refused;
    return report;
  }

  std::vector<Clash> open_clashes(mortise::PartId of) {
    std::vector<Clash> clashes;
    if (!ready) return clashes;
    for (const auto& [pair, open] : mortise::session_state(world()).open) {
      if (of && pair.first != of && pair.second != of) continue;
      for (const mortise::OpenClash& clash : open) {
        const mortise::Part* blocker = world().find(clash.now.separation_blocker);
        clashes.push_back(
            clash_of(clash.now, {world().find(pair.first)->name, world().find(pair.second)->name,
                                 blocker != nullptr ? blocker->name : ""}));
        clashes.back().id = clash.last.clash.value;
      }
    }
    std::stable_sort(clashes.begin(), clashes.end(), [](const Clash& x, const Clash& y) {
      if (x.collision_class != y.collision_class) return x.collision_class > y.collision_class;
      return x.depth_mm.lo > y.depth_mm.lo;
    });
    return clashes;
  }

  PartRef add(const Result<Part>& part, const Pose& X_WP, bool moving) {
    if (!status) return {};
    if (!part) {
      status = part.error();
      return {};
    }
    const auto X = pose_in(X_WP);
    if (!X) {
      (void)failed("part " + part->name() + ": X_WP is no finite rigid motion");
      return {};
    }
    touch();
    parts.push_back({*part, unlike(part->name(), parts), *X, moving});
    holder.emplace_back();
    return {static_cast<std::uint32_t>(parts.size())};
  }
};

Session::Session(const SessionOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;
Session::~Session() = default;

PartRef Session::add(const Result<Part>& part, const Pose& X_WP) {
  return impl_->add(part, X_WP, true);
}

PartRef Session::add_fixed(const Result<Part>& part, const Pose& X_WP) {
  return impl_->add(part, X_WP, false);
}

Status Session::fit(PartRef a, const std::string& feature_a, PartRef b,
                    const std::string& feature_b, const std::string& code) {
  if (!impl_->status) return impl_->status;
  if (!impl_->knows(a) || !impl_->knows(b)) return impl_->unknown_part();
  impl_->touch();
  impl_->sayings.fits.push_back({a.value - 1U, b.value - 1U, feature_a, feature_b, code});
  return impl_->status;
}

Status Session::tolerance(PartRef part, const std::string& feature, const std::string& text) {
  if (!impl_->status) return impl_->status;
  if (!impl_->knows(part)) return impl_->unknown_part();
  impl_->tolerances.push_back({part.value - 1U, feature, text});
  return impl_->ready ? impl_->state(impl_->tolerances.back()) : impl_->status;
}

Status Session::exclude(PartRef a, PartRef b, const std::string& reason) {
  if (!impl_->status) return impl_->status;
  if (!impl_->knows(a) || !impl_->knows(b)) return impl_->unknown_part();
  impl_->touch();
  impl_->sayings.exclusions.push_back({a.value - 1U, b.value - 1U, reason});
  return impl_->status;
}

Status Session::hold(const std::string& user, PartRef part) {
  if (!impl_->status) return impl_->status;
  if (!impl_->knows(part)) return impl_->unknown_part();
  if (user.empty()) return impl_->failed("a user needs a name");
  if (const Status open = impl_->open(); !open) return open;
  if (const Status done = impl_->grab(user, part.value - 1U); !done) return done;
  impl_->holder[part.value - 1U] = user;
  return impl_->status;
}

Status Session::release(PartRef part) {
  if (!impl_->status) return impl_->status;
  if (!impl_->knows(part)) return impl_->unknown_part();
  std::string& holder = impl_->holder[part.value - 1U];
  if (holder.empty() || !impl_->ready) {
    holder.clear();
    return impl_->status;
  }
  mortise::Command command;
  command.user = impl_->user_of(holder);
  command.part = {part.value};
  command.kind = mortise::CommandKind::kRelease;
  mortise::Decision decision;
  const mortise::Reply reply = mortise::apply_command(impl_->world(), command, decision);
  if (reply.refusal != mortise::Refusal::kNone) return impl_->failed(reply.text);
  holder.clear();
  return impl_->status;
}

Status Session::place(PartRef part, const Pose& X_WP) {
  if (!impl_->status) return impl_->status;
  if (!impl_->knows(part)) return impl_->unknown_part();
  const auto X = pose_in(X_WP);
  if (!X) return impl_->failed("X_WP is no finite rigid motion");
  impl_->touch();
  impl_->parts[part.value - 1U].X_WP = *X;
  return impl_->status;
}

Pushed Session::push(PartRef part, const Pose& dX_W) {
  Pushed pushed;
  const auto dX = pose_in(dX_W);
  if (!impl_->status)
    pushed.status = impl_->status;
  else if (!impl_->knows(part))
    pushed.status = impl_->unknown_part();
  else if (!dX)
    pushed.status = impl_->failed("dX_W is no finite rigid motion");
  else
    pushed.status = impl_->open();
  if (!pushed.status) return pushed;
  const std::string& user = impl_->holder[part.value - 1U];
  const mortise::Part& moved = impl_->world().parts[part.value - 1U];
  pushed.X_WP = pose_of(moved.X_WP);
  if (user.empty()) {
    pushed.status = impl_->failed("nobody holds '" + moved.name + "': hold() it first");
    return pushed;
  }
  const PushInPlace push = push_about(*dX, moved.X_WP * moved.solid->sphere().center_mm);
  mortise::Increment increment;
  increment.user = impl_->user_of(user);
  increment.part = moved.id;
  increment.seq = ++impl_->last_seq[user];
  increment.translation_mm = push.translation_mm;
  increment.rotation_rad = push.rotation_rad;
  const mortise::StepReport report = impl_->run(increment);
  // A push that is too long is a matter of this push alone.
  if (!report.refused.empty())
    pushed.status = Error{Code::kInvalidInput,
                          "push of '" + moved.name + "' refused: " +
                              std::string(mortise::name_of(report.refused.front().reason))};
  pushed.X_WP = pose_of(moved.X_WP);
  pushed.clashes = impl_->open_clashes(moved.id);
  pushed.state_hash = report.state_hash;
  return pushed;
}

Result<Judgement> Session::judge(bool full) {
  if (const Status open = impl_->open(); !open) return open.error();
  // A world of its own: what the session remembers stays as it is.
  mortise::OpenedScene scene = impl_->opened;
  scene.scene.world.state.reset();
  return judgement_of(scene, mortise::judge_world(scene.scene.world, impl_->scratch, full));
}

const Status& Session::status() const { return impl_->status; }
std::vector<Clash> Session::clashes() const { return impl_->open_clashes({}); }

Pose Session::pose(PartRef part) const {
  if (!impl_->knows(part)) return Pose::Identity();
  const std::size_t i = part.value - 1U;
  return pose_of(impl_->ready ? impl_->world().parts[i].X_WP : impl_->parts[i].X_WP);
}

std::string Session::name(PartRef part) const {
  return impl_->knows(part) ? impl_->parts[part.value - 1U].name : std::string();
}

PartRef Session::find(const std::string& name) const {
  for (std::size_t i = 0; i < impl_->parts.size(); ++i)
    if (impl_->parts[i].name == name) return {static_cast<std::uint32_t>(i + 1)};
  return {};
}

}  // namespace mortise::api

#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/session/world/world.h"
#include "server/inbox_tally.h"
#include "server/increment_admission.h"
#include "server/intake.h"
#include "server/leases.h"
#include "server/message_rates.h"
#include "server/sequence_window.h"

namespace mortise {

/// Applies the commands of all users in order. A release, undo, redo, reset or consent waits until
/// earlier increments of the same user and part were applied, because decisions are applied before
/// the increments of a tick. It also waits for increments that were sent before it and are still
/// under way (Command::after), for at most after_wait_s.
class CommandQueue {
 public:
  /// All must outlive this.
  CommandQueue(const InboxLimits& limits, InboxTally& tally, MessageRates& rates, Leases& leases,
               const IncrementAdmission& increments)
      : limits_(limits), tally_(tally), rates_(rates), leases_(leases), increments_(increments) {}

  /// A user has joined: its sequence numbers begin again.
  void begin(UserId user);
  /// A command of a user who has joined: applies it, or lets it wait.
  void receive(const Command& command, World& world, std::int64_t now_ns, Intake& intake);
  /// Answers user `tell` that a command is refused.
  void refuse(const Command& command, UserId tell, Refusal reason, std::string text,
              const World& world, Intake& intake);
  void carry_out_waiting(World& world, std::int64_t now_ns, Intake& intake);
  void drop(UserId user);  ///< a user who has left
  std::size_t waiting() const { return waiting_.size(); }

 private:
  /// Waits for increments with a sequence up to `after`, until until_ns also for increments that
  /// have not arrived.
  struct Waiting {
    Command command;
    std::uint64_t after = 0;
    std::int64_t until_ns = 0;
  };
  /// Counts commands that no longer wait.
  bool must_wait(const Waiting& waiting, std::int64_t now_ns);
  void carry_out(const Command& command, World& world, std::int64_t now_ns, Intake& intake);
  /// Does a grab, request or consent give a user more parts than the limit?
  bool hand_is_full(const World& world, const Command& command) const;
  /// Does a command about the same part wait already? Then this one waits behind it.
  static bool is_behind(const std::vector<Waiting>& waiting, const Command& command);

  const InboxLimits& limits_;
  InboxTally& tally_;
  MessageRates& rates_;
  Leases& leases_;
  const IncrementAdmission& increments_;
  std::vector<SequenceWindow> sequences_;  ///< by user index
  std::vector<Waiting> waiting_;           ///< in order of arrival
};

}  // namespace mortise

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
#include "server/uploads.h"

namespace mortise {

/// Applies the commands of all users in order. A release, undo, redo, reset or consent waits until
/// earlier increments of the same user and part were applied, because decisions are applied before
/// the increments of a tick. It also waits for increments that were sent before it and are still
/// under way (Command::after), for at most after_wait_s. One that names a mesh waits until it is
/// ready, and nothing waits behind it.
class CommandQueue {
 public:
  /// All must outlive this.
  CommandQueue(const InboxLimits& limits, InboxTally& tally, MessageRates& rates, Leases& leases,
               const IncrementAdmission& increments, Uploads& uploads)
      : limits_(limits),
        tally_(tally),
        rates_(rates),
        leases_(leases),
        increments_(increments),
        uploads_(uploads) {}

  /// A user has joined: its sequence numbers begin again, and its uploads.
  void begin(UserId user);
  /// A command of a user who has joined: applies it, or lets it wait.
  void receive(const Command& command, World& world, std::int64_t now_ns, Intake& intake);
  /// Answers user `tell` that a command is refused.
  void refuse(const Command& command, UserId tell, Refusal reason, std::string text,
              const World& world, Intake& intake);
  void carry_out_waiting(World& world, std::int64_t now_ns, Intake& intake);
  void drop(UserId user);  ///< a user who has left
  std::size_t waiting() const { return waiting_.size() + edits_.size(); }

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
  /// The same where no mesh is missing.
  void apply(const Command& command, World& world, std::int64_t now_ns, Intake& intake);
  /// Of an edit that needs a mesh: carries it out, lets it wait, or refuses it.
  void carry_out_edit(Command command, World& world, std::int64_t now_ns, Intake& intake);
  /// Is the mesh usable that an edit needs? If not, the edit waits or is refused.
  bool is_here(const Uploads::Mesh& mesh, Command& command, const World& world, Intake& intake);
  /// Until the mesh is ready.
  void wait_for_mesh(Command command, const World& world, Intake& intake);
  void answer_refused(const Command& command, Refusal reason, std::string text, const World& world,
                      Intake& intake);
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
  Uploads& uploads_;
  std::vector<Command> edits_;  ///< that wait for their meshes, in order of arrival
};

}  // namespace mortise

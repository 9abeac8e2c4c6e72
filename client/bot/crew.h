#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/bot/behaviour.h"
#include "client/bot/load_report.h"
#include "client/bot/options.h"
#include "client/bot/tally.h"
#include "client/bot/waiting_lines.h"
#include "client/client.h"
#include "common/base/result.h"

namespace mortise {

/// Asks all crews of this process to end in order; for signal handlers.
void ask_to_stop(int signal);
bool stop_is_asked();

/// All bots of one process: joins, acts, listens and reports. One thread, one channel.
class Crew {
 public:
  Crew(const BotOptions& options, ClientChannel& channel, std::optional<Play> play);

  /// Plays from the first join to the last goodbye. Prints what fails, else fills in `report`.
  int run(ProcessReport& report);

 private:
  void name_users();
  void add_users_due(double now_s);
  bool wait_until_joined();
  void say_why_not_joined() const;
  /// Until somebody is there who is no bot. False: it was stopped before.
  bool wait_for_people();
  Status find_parts();
  void poll(double wait_s);
  void listen(double seconds);
  void act();
  bool beat(double now_s, double beat_s);
  void carry_out(LocalUser user, const Wish& wish);
  void sent_command(std::uint64_t seq) { commands_sent_ += seq != 0 ? 1 : 0; }
  void release_all();
  nlohmann::ordered_json document() const;

  BotOptions options_;
  Client client_;
  std::optional<Play> play_;
  PartId part_;
  GuidedSettings guided_;
  std::vector<std::string> names_;  ///< of those who are in, and of those who come later
  std::vector<std::unique_ptr<Behaviour>> behaviours_;  ///< of those who are in
  std::vector<std::uint64_t> sent_seq_;                 ///< newest increment, by user
  Tally tally_;
  WaitingLines waiting_{options_.quiet};
  std::uint64_t commands_sent_ = 0;
  double acted_s_ = 0.0;
};

}  // namespace mortise

#include "client/replay/play_command.h"

#include "client/replay/output.h"
#include "client/replay/play.h"
#include "client/replay/progress.h"
#include "common/io/log/log_chain.h"
#include "idl/dds_channel.h"

namespace mortise {

int run_play(const PlayCommand& command) {
  const auto log = read_session(command.log);
  if (!log) return say(log.error(), kExitBadInput);
  print_notes(*log);
  DdsOptions network = command.network;
  network.meshes = network.features = false;
  const auto channel = open_client_channel(network);
  if (!channel) return say(channel.error(), exit_code_of(channel.error().code));
  Client client(**channel);
  PlayOptions options;
  options.speed = command.speed;
  options.from_s = command.from_s;
  if (command.to_s > 0.0) options.to_s = command.to_s;
  options.wait_s = command.wait_s;
  Progress progress("played, s of the log", 0.0);
  const auto outcome = play_log(*log, client, options, [&](double at_s) { progress.show(at_s); });
  progress.end();
  if (!outcome) return say(outcome.error(), exit_code_of(outcome.error().code));
  const Json document = {{"log", command.log.string()},
                         {"session", command.network.session},
                         {"speed", command.speed},
                         {"took_s", outcome->took_s},
                         {"waited_s", outcome->waited_s},
                         {"ticks", outcome->ticks},
                         {"increments", outcome->increments},
                         {"increments_sent", outcome->increments_sent},
                         {"increments_refused", outcome->increments_refused},
                         {"commands", outcome->commands},
                         {"commands_refused", outcome->commands_refused},
                         {"users_not_let_in", outcome->users_not_let_in},
                         {"not_playable", outcome->not_playable},
                         {"clash_events", outcome->events},
                         {"notes", outcome->notes}};
  if (command.json) {
    print(document);
    return kExitOk;
  }
  print_lines(document);
  return kExitOk;
}

}  // namespace mortise

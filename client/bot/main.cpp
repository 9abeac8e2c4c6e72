#include "client/bot/bot.h"
#include "client/bot/options.h"
#include "common/io/progress_log.h"

int main(int argc, char** argv) {
  const mortise::BotCommandLine line = mortise::read_bot_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;

  mortise::begin_progress_log("mortise-bot", line.options.quiet);
  return mortise::run_bot(line.options);
}

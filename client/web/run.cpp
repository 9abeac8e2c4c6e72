#include "client/web/run.h"

#include <fmt/format.h>
#include <pthread.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <thread>

#include "client/report/clash_picture.h"
#include "client/report/gap_answer.h"
#include "client/report/log_so_far.h"
#include "client/report/report.h"
#include "client/saved/saved_session.h"
#include "client/web/addresses.h"
#include "client/web/live_feed.h"
#include "client/web/replay_feed.h"
#include "client/web/step_reader.h"
#include "common/io/log/log_chain.h"
#include "common/io/progress_log.h"
#include "common/messages/names.h"
#include "idl/dds_channel.h"

namespace mortise::web {
namespace {

int fail_with(const Error& error) {
  log_error("{}", error.text);
  return error.code == Code::kNotFound ? kExitBadInput : exit_code_of(error.code);
}

/// Waits for SIGINT and SIGTERM in a thread of its own: every other thread has them blocked, so
/// that none is interrupted in the middle of something.
class StopSignal {
 public:
  StopSignal() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }
  void then_stop(Gateway& gateway) {
    std::thread([signals = signals_, &gateway] {
      int number = 0;
      sigwait(&signals, &number);
      gateway.stop();
    }).detach();
  }

 private:
  sigset_t signals_;
};

Result<Tokens> tokens_of(const WebOptions& options) {
  if (options.tokens.empty()) return make_tokens();
  return tokens_of_file(options.tokens);
}

void warn_without_three(const PageFiles& page) {
  if (!page.has_three()) {
    log_warning(
        "three.js is not installed: the page has no 3D view until `npm ci --omit=dev` was run in "
        "{}",
        page.folder().string());
  }
}

// A log as it is now, also while a server writes it.
Result<std::string> bytes_of(const std::string& log) try {
  constexpr std::uintmax_t kMost_bytes = std::uintmax_t{1} << 30;  // held while it is sent
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(log, error);
  if (error) return fail(Code::kRuntime, "the log cannot be read: " + error.message());
  if (size > kMost_bytes)
    return fail(Code::kRuntime, "the log has more than 1 GB: take it from " + log);
  std::string bytes(size, '\0');
  std::ifstream in(log, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!in) return fail(Code::kRuntime, "the log cannot be read");
  return bytes;
} catch (const std::exception& e) {  // memory
  return fail(Code::kRuntime, std::string("the log cannot be read: ") + e.what());
}

// A server writes what was decided to its log within a second: what was before this call is read.
void await_writing(const std::string& log) {
  // Half as long again as the second, for a busy disk; no look for the time of a file costs
  // anything at 50 a second.
  constexpr auto kWritten = std::chrono::milliseconds(1500), kTurn = std::chrono::milliseconds(20);
  const auto after = std::filesystem::file_time_type::clock::now() + kTurn;
  const auto until = std::chrono::steady_clock::now() + kWritten;
  std::error_code error;
  while (std::chrono::steady_clock::now() < until &&
         std::filesystem::last_write_time(log, error) < after)
    std::this_thread::sleep_for(kTurn);
}

Result<std::string> scenario_of(const std::string& log) try {
  const auto read = read_session(log, {.keep_checkpoints = 2});
  if (!read) return read.error();
  const auto saved = saved_session(*read, [](const ReplayedTick&) {});
  if (!saved) return saved.error();
  if (!saved->stopped_early.empty()) return fail(Code::kInvalidInput, saved->stopped_early);
  return zip_of(saved->scenario);
} catch (const std::exception& e) {  // memory
  return fail(Code::kRuntime, std::string("the session cannot be saved: ") + e.what());
}

Result<std::string> picture_of(LogSoFar& log, const WantedPicture& wanted) try {
  ClashMoment moment{ClashId{wanted.clash}};
  if (wanted.until_tick) moment.until_tick = *wanted.until_tick;
  return log.answer(moment.until_tick,
                    [&](const SessionLog& read) { return clash_picture(read, moment); });
} catch (const std::exception& e) {  // memory
  return fail(Code::kRuntime, std::string("the clash cannot be drawn: ") + e.what());
}

Result<std::string> gap_of(LogSoFar& log, const WantedGap& wanted) try {
  const GapMoment moment{PartId{wanted.a}, PartId{wanted.b},
                         wanted.tick.value_or(std::numeric_limits<std::uint64_t>::max())};
  return log.answer(moment.tick, [&](const SessionLog& read) { return gap_answer(read, moment); });
} catch (const std::exception& e) {  // memory
  return fail(Code::kRuntime, std::string("the gap cannot be computed: ") + e.what());
}

// Serves a feed until a signal comes.
int serve(const WebOptions& options, Feed& feed, StopSignal& stop_signal) {
  GatewayOptions gateway_options = options.gateway;
  if (const std::string& log = options.replay.empty() ? options.read_log : options.replay;
      !log.empty()) {
    gateway_options.report = [log] { return report_page(log); };
    const bool is_written = options.replay.empty();
    gateway_options.log = [log, is_written] {
      if (is_written) await_writing(log);
      return bytes_of(log);
    };
    const auto so_far = std::make_shared<LogSoFar>([log, is_written] {
      if (is_written) await_writing(log);
      return read_session(log);
    });
    gateway_options.picture = [so_far](const WantedPicture& wanted) {
      return picture_of(*so_far, wanted);
    };
    gateway_options.gap = [so_far](const WantedGap& wanted) { return gap_of(*so_far, wanted); };
    gateway_options.scenario = [log, is_written] {
      if (is_written) await_writing(log);
      return scenario_of(log);
    };
  }
  auto page = PageFiles::open(options.page);
  if (!page) return fail_with(page.error());
  auto tokens = tokens_of(options);
  if (!tokens) return fail_with(tokens.error());
  const auto say = [](const std::string& line) { log_warning("{}", line); };
  auto gateway = Gateway::open(gateway_options, *tokens, *page, feed, say);
  if (!gateway) return fail_with(gateway.error());
  if (Status said = say_addresses({options.addresses, options.tokens}, **gateway, *tokens); !said)
    return fail_with(said.error());
  warn_without_three(*page);
  stop_signal.then_stop(**gateway);
  (*gateway)->run();
  log_info("ended; {}", feed.statistics().dump());
  return kExitOk;
}

int serve_session(const WebOptions& options, StopSignal& stop_signal) {
  auto channel = open_client_channel(options.network);
  if (!channel) return fail_with(channel.error());
  Client client(**channel);
  LiveFeed feed(client, options.gateway.limits, read_brought_step);
  log_info("session '{}' on domain {} for browsers; Ctrl-C ends it", options.network.session,
           options.network.domain);
  return serve(options, feed, stop_signal);
}

int serve_log(const WebOptions& options, StopSignal& stop_signal) {
  log_info("computing {} again", options.replay);
  auto recording = read_recording(options.replay);
  if (!recording) return fail_with(recording.error());
  for (const std::string& note : recording->notes) log_warning("{}: {}", options.replay, note);
  log_info(
      "{:.1f} s of session '{}' for browsers; Ctrl-C ends it",
      static_cast<double>(recording->last_tick - recording->first_tick) / recording->tick_rate_hz,
      recording->session);
  ReplayFeed feed(std::move(*recording));
  return serve(options, feed, stop_signal);
}

}  // namespace

int run_web(const WebOptions& options) {
  StopSignal stop_signal;  // before any thread
  return options.replay.empty() ? serve_session(options, stop_signal)
                                : serve_log(options, stop_signal);
}

}  // namespace mortise::web

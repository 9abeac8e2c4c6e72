#include "client/web/run.h"

#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <iostream>
#include <thread>

#include "client/web/live_feed.h"
#include "idl/dds_channel.h"

namespace mortise::web {
namespace {

int fail_with(const Error& error) {
  spdlog::error("{}", error.text);
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

void say_addresses(const Gateway& gateway, const PageFiles& page) {
  std::cout << "designer " << gateway.address(Role::kDesigner) << "\nobserver "
            << gateway.address(Role::kObserver) << std::endl;
  if (!page.has_three()) {
    spdlog::warn(
        "three.js is not installed: the page has no 3D view until `npm ci --omit=dev` was run in "
        "{}",
        page.folder().string());
  }
}

}  // namespace

int run_web(const WebOptions& options) {
  StopSignal stop_signal;  // before any thread
  auto page = PageFiles::open(options.page);
  if (!page) return fail_with(page.error());
  auto tokens = tokens_of(options);
  if (!tokens) return fail_with(tokens.error());

  DdsOptions dds;
  dds.session = options.session;
  dds.domain = options.domain;
  dds.interface = options.interface;
  dds.server = options.server;
  dds.discovery_port = options.discovery_port;
  auto channel = open_client_channel(dds);
  if (!channel) return fail_with(channel.error());
  Client client(**channel);
  LiveFeed feed(client, options.gateway.limits);
  const auto say = [](const std::string& line) { spdlog::warn("{}", line); };
  auto gateway = Gateway::open(options.gateway, *tokens, *page, feed, say);
  if (!gateway) return fail_with(gateway.error());

  say_addresses(**gateway, *page);
  spdlog::info("session '{}' on domain {} for browsers; Ctrl-C ends it", options.session,
               options.domain);
  stop_signal.then_stop(**gateway);
  (*gateway)->run();
  spdlog::info("ended; {}", feed.statistics().dump());
  return kExitOk;
}

}  // namespace mortise::web

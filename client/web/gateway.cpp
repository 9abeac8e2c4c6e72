#include "client/web/gateway.h"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <utility>
#include <vector>

#include "client/web/browser.h"
#include "client/web/http_connection.h"

namespace mortise::web {
namespace {

using tcp = asio::ip::tcp;

constexpr double kQuietTurn_s = 0.020;  // nobody looks on; below the heartbeat of a client
// Between two looks for pages that are too slow or too quiet: far below their limits of seconds.
constexpr double kCheckEvery_s = 0.5;
constexpr double kGoodbye_s = 1.0;                       // for pages to hear that the gateway ends
constexpr double kLastTurns_s = 0.2;                     // for the session to hear who left
constexpr auto kPause = std::chrono::milliseconds(200);  // after an accept that failed

class AsioGateway final : public Gateway {
 public:
  AsioGateway(const GatewayOptions& options, const Tokens& tokens, PageFiles page, Feed& feed,
              Incidents::Say say)
      : state_(options, tokens, std::move(page), feed, std::move(say)) {}

  // Browsers know each other through the state, and their sockets need io_ to end.
  ~AsioGateway() override {
    state_.reports.finish();
    state_.browsers.clear();
  }

  Status start() {
    if (!state_.options.certificate.empty()) {
      if (Status loaded = load_certificate(); !loaded) return loaded;
    }
    boost::system::error_code error;
    const auto ip = asio::ip::make_address_v4(state_.options.address, error);
    const auto failed = [&](const char* doing) {
      return fail(Code::kRuntime, state_.options.address + ":" +
                                      std::to_string(state_.options.port) + ": cannot " + doing +
                                      ": " + error.message() +
                                      "; choose another with --http-port, --http-address");
    };
    if (error) return failed("read the address");
    acceptor_.open(tcp::v4(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind({ip, static_cast<std::uint16_t>(state_.options.port)}, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) return failed("listen");
    port_ = acceptor_.local_endpoint().port();
    return ok();
  }

  int port() const override { return port_; }

  std::string address(const std::string& token) const override {
    const GatewayOptions& o = state_.options;
    const std::string host = !o.names.empty()         ? o.names.front()
                             : o.address == "0.0.0.0" ? "localhost"
                                                      : o.address;
    return (o.certificate.empty() ? "http://" : "https://") + host + ":" + std::to_string(port_) +
           "/#token=" + token;
  }

  void run() override {
    accept();
    turn();
    io_.run();
  }

  void stop() override {
    asio::post(io_, [this] {
      if (state_.ending) return;
      state_.ending = true;
      end_at_s_ = state_.now_s() + kGoodbye_s;
      boost::system::error_code ignored;
      acceptor_.close(ignored);
      for (const auto& browser : all_browsers())
        browser->end(Browser::CloseCode::going_away, "the gateway ends");
    });
  }

 private:
  Status load_certificate() {
    const GatewayOptions& o = state_.options;
    boost::system::error_code error;
    state_.tls.emplace(asio::ssl::context::tls_server);
    using Context = asio::ssl::context;
    state_.tls->set_options(Context::default_workarounds | Context::no_tlsv1 | Context::no_tlsv1_1,
                            error);
    if (!error) state_.tls->use_certificate_chain_file(o.certificate, error);
    if (error)
      return fail(Code::kInvalidInput,
                  o.certificate + ": no certificate in PEM form: " + error.message());
    state_.tls->use_private_key_file(o.key, Context::pem, error);
    if (error)
      return fail(Code::kInvalidInput,
                  o.key + ": not the key of " + o.certificate + ": " + error.message());
    return ok();
  }

  void accept() {
    acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        make_room(socket);
        std::make_shared<HttpConnection>(state_, std::move(socket))->start();
        return accept();
      }
      // Out of descriptors, say: not at once again.
      pause_.expires_after(kPause);
      pause_.async_wait([this](beast::error_code) { accept(); });
    });
  }

  // Who opens connections and says nothing must not keep others out.
  void make_room(const tcp::socket& newest) {
    if (state_.connections < state_.options.limits.connections || state_.waiting.empty()) return;
    boost::system::error_code ignored;
    state_.incidents.note(Incident::kTooManyConnections,
                          newest.remote_endpoint(ignored).address().to_string(),
                          "too many connections; the oldest idle one gives way", state_.now_s());
    state_.waiting.front()->give_way();
  }

  // What is done with one may end others.
  std::vector<std::shared_ptr<Browser>> all_browsers() const {
    return {state_.browsers.begin(), state_.browsers.end()};
  }

  void turn() {
    const double now_s = state_.now_s();
    state_.feed.turn(now_s);
    if (now_s - checked_s_ > kCheckEvery_s) {
      checked_s_ = now_s;
      for (const auto& browser : all_browsers()) browser->check(now_s);
    }
    if (state_.ending && (state_.browsers.empty() || now_s > end_at_s_) && now_s > last_turn_s_) {
      if (last_turn_s_ > 0.0) return io_.stop();
      last_turn_s_ = now_s + kLastTurns_s;
      for (const auto& browser : all_browsers()) state_.feed.leave(*browser);
    }
    const double wait_s = state_.browsers.empty() ? kQuietTurn_s : state_.options.turn_s;
    turn_.expires_after(std::chrono::microseconds(static_cast<std::int64_t>(wait_s * 1e6)));
    turn_.async_wait([this](beast::error_code error) {
      if (!error) turn();
    });
  }

  GatewayState state_;  // outlives io_, whose end ends all connections
  asio::io_context io_{1};
  tcp::acceptor acceptor_{io_};
  asio::steady_timer pause_{io_}, turn_{io_};
  int port_ = 0;
  double checked_s_ = 0.0, end_at_s_ = 0.0, last_turn_s_ = 0.0;
};

}  // namespace

Result<std::unique_ptr<Gateway>> Gateway::open(const GatewayOptions& options, const Tokens& tokens,
                                               PageFiles page, Feed& feed, Incidents::Say say) {
  auto gateway =
      std::make_unique<AsioGateway>(options, tokens, std::move(page), feed, std::move(say));
  if (Status started = gateway->start(); !started) return started.error();
  return std::unique_ptr<Gateway>(std::move(gateway));
}

}  // namespace mortise::web

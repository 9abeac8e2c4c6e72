#include "server/metrics_endpoint.h"

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>

#include "server/scheduling.h"

namespace mortise {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostConnections = 32;             // a collector needs one
constexpr std::uint32_t kMostHeaderBytes = 8192;         // of a request
constexpr auto kPatience = std::chrono::seconds(5);      // for a request, an answer, a next request
constexpr auto kTickIsDueIn = std::chrono::seconds(2);   // a session ticks at least once a second
constexpr auto kPause = std::chrono::milliseconds(200);  // after an accept that failed
constexpr char kText[] = "text/plain; version=0.0.4; charset=utf-8";

using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

class Endpoint final : public MetricsEndpoint {
 public:
  Status start(const std::string& address, int port) {
    boost::system::error_code error;
    const auto ip = asio::ip::make_address_v4(address, error);
    const auto failed = [&](const char* doing) {
      return fail(Code::kRuntime, "metrics at " + address + ":" + std::to_string(port) +
                                      ": cannot " + doing + ": " + error.message() +
                                      "; choose another with --metrics-port, --metrics-address");
    };
    if (error) return failed("read the address");
    acceptor_.open(tcp::v4(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind({ip, static_cast<std::uint16_t>(port)}, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) return failed("listen");
    port_ = acceptor_.local_endpoint().port();
    beat();
    accept();
    thread_ = std::thread([this] {
      run_as_others();
      io_.run();
    });
    return ok();
  }
  ~Endpoint() override {
    io_.stop();
    if (thread_.joinable()) thread_.join();
  }

  int port() const override { return port_; }
  void beat() override { beat_at_ = Clock::now().time_since_epoch().count(); }
  void show(SessionFigures figures) override {
    auto shown = std::make_shared<const SessionFigures>(std::move(figures));
    const std::lock_guard lock(mutex_);  // held for a swap of pointers only
    figures_.swap(shown);
  }

  Response answer(const Request& request) const {
    Response response{http::status::ok, request.version()};
    response.keep_alive(request.keep_alive());
    response.set(http::field::content_type, kText);
    const std::size_t hosts = request.count(http::field::host);
    if (hosts > 1 || (hosts == 0 && request.version() >= 11)) {  // RFC 9112, section 3.2
      response.result(http::status::bad_request);
      response.body() = "one Host field is expected\n";
    } else if (request.method() != http::verb::get && request.method() != http::verb::head) {
      response.result(http::status::method_not_allowed);
      response.set(http::field::allow, "GET, HEAD");
      response.body() = "only GET and HEAD\n";
    } else if (request.target() == "/metrics") {
      const auto figures = shown();
      response.body() = figures ? metrics_text(*figures, resident_bytes()) : std::string();
    } else if (request.target() == "/healthz") {
      const auto silent = Clock::now() - Clock::time_point(Clock::duration(beat_at_.load()));
      const bool lives = silent <= kTickIsDueIn;
      if (!lives) response.result(http::status::service_unavailable);
      response.body() = lives ? "ok\n" : "no tick for more than 2 s\n";
    } else {
      response.result(http::status::not_found);
      response.body() = "there is /metrics and /healthz\n";
    }
    response.prepare_payload();
    if (request.method() == http::verb::head) response.body().clear();
    return response;
  }

 private:
  class Connection;
  std::shared_ptr<const SessionFigures> shown() const {
    const std::lock_guard lock(mutex_);
    return figures_;
  }
  void accept();

  std::size_t connections_ = 0;  // touched by the endpoint's thread only; outlives io_
  asio::io_context io_{1};
  tcp::acceptor acceptor_{io_};
  asio::steady_timer pause_{io_};
  int port_ = 0;
  std::atomic<Clock::rep> beat_at_{0};
  mutable std::mutex mutex_;
  std::shared_ptr<const SessionFigures> figures_;
  std::thread thread_;
};

/// One client: request, answer, again; gone when it is too slow for either.
class Endpoint::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Endpoint& endpoint, tcp::socket socket)
      : endpoint_(endpoint), stream_(std::move(socket)) {
    ++endpoint_.connections_;
  }
  ~Connection() { --endpoint_.connections_; }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMostHeaderBytes);
    parser_->body_limit(0);
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       if (!error) self->write();
                     });
  }

 private:
  void write() {
    response_.emplace(endpoint_.answer(parser_->get()));
    stream_.expires_after(kPatience);
    http::async_write(stream_, *response_,
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (!error && self->response_->keep_alive()) self->read();
                      });
  }

  Endpoint& endpoint_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<Response> response_;
};

void Endpoint::accept() {
  acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
    // Too many at once: the newest is closed unheard.
    if (!error && connections_ < kMostConnections) {
      std::make_shared<Connection>(*this, std::move(socket))->read();
    }
    if (!error) return accept();
    // Out of descriptors, say: not at once again.
    pause_.expires_after(kPause);
    pause_.async_wait([this](beast::error_code) { accept(); });
  });
}

}  // namespace

Result<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::open(const std::string& address,
                                                               int port) {
  auto endpoint = std::make_unique<Endpoint>();
  if (Status started = endpoint->start(address, port); !started) return started.error();
  return std::unique_ptr<MetricsEndpoint>(std::move(endpoint));
}

}  // namespace mortise

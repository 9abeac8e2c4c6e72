#include "server/discovery/discovery_server.h"

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <span>

#include "idl/datagram_guard.h"
#include "idl/introductions.h"
#include "idl/server_places.h"

namespace mortise {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using Outcome = Introductions::Outcome;

// Holds what hundreds announce at one time.
constexpr int kSocketBuffer_bytes = 1 << 22;
// Of a certificate's holder it has some 3 kB.
constexpr std::size_t kMost_bytes = 8192;
constexpr double kLinesPerSecond = 10.0, kWarnAgain_s = 10.0;

std::string shown(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return name;
}

class UdpDiscoveryServer final : public DiscoveryServer {
 public:
  Status open(const DiscoveryOptions& options) {
    const int port = options.port != 0 ? options.port : kDiscoveryServerPort;
    if (!is_ipv4(options.interface) || !is_own_address(options.interface))
      return fail(
          Code::kInvalidInput,
          "'" + options.interface +
              "' is not an IPv4 address of this machine: see `ip -4 addr` for those it has");
    own_ = udp::endpoint(asio::ip::make_address_v4(options.interface),
                         static_cast<std::uint16_t>(port));
    place_ = options.interface + ":" + std::to_string(port);
    boost::system::error_code error;
    socket_.open(udp::v4(), error);
    if (!error) socket_.bind(own_, error);
    if (error)
      return fail(Code::kRuntime, "UDP port " + std::to_string(port) + " of " + options.interface +
                                      ": " + error.message() +
                                      "; choose another with --discovery-port");
    // Whatever the system grants.
    socket_.set_option(asio::socket_base::receive_buffer_size(kSocketBuffer_bytes), error);
    socket_.set_option(asio::socket_base::send_buffer_size(kSocketBuffer_bytes), error);
    // A full buffer must not hold up the others; what is announced is announced again.
    socket_.non_blocking(true, error);
    receive();
    return ok();
  }

  void run_for(double seconds, const Tell& tell) override {
    tell_ = &tell;
    io_.run_for(std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(seconds)));
    const double now = now_s();
    lines_ = std::min(kLinesPerSecond, lines_ + (now - swept_s_) * kLinesPerSecond);
    swept_s_ = now;
    for (const auto& gone : introductions_.take_gone(now))
      if (gone.purpose.serves) say(gone, "gone");
    if (unsaid_ > 0 && lines_ >= 1.0) {
      tell(false, std::to_string(unsaid_) + " more servers came or went");
      unsaid_ = 0;
    }
    warn(now);
  }
  std::string place() const override { return place_; }
  DiscoveryCounts counts() const override {
    DiscoveryCounts counts = counts_;
    counts.participants = introductions_.size();
    counts.servers = introductions_.servers();
    counts.sessions = introductions_.sessions();
    return counts;
  }

 private:
  static double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
  void say(const Introductions::Participant& server, const char* what) {
    if (lines_ < 1.0) {
      ++unsaid_;
      return;
    }
    lines_ -= 1.0;
    (*tell_)(false, "session '" + shown(server.purpose.session) + "', domain " +
                        std::to_string(server.purpose.domain) + ": server at " +
                        to_text(server.place) + " " + what);
  }
  void warn(double now) {
    const std::uint64_t turned_away = counts_.full + counts_.too_often;
    if (turned_away == warned_of_ || now - warned_s_ < kWarnAgain_s) return;
    (*tell_)(
        true,
        std::to_string(turned_away - warned_of_) +
            " announcements dropped: too many participants or servers of one host or session, or "
            "too often; the last from " +
            turned_away_.to_string());
    warned_of_ = turned_away;
    warned_s_ = now;
  }
  void receive() {
    socket_.async_receive_from(asio::buffer(datagram_), from_,
                               [this](const boost::system::error_code& error, std::size_t size) {
                                 if (error == asio::error::operation_aborted) return;
                                 // An earlier datagram found nobody: told here, and no matter.
                                 if (!error) take(size);
                                 receive();
                               });
  }
  void take(std::size_t size) {
    const std::size_t length = admissible_length(std::as_bytes(std::span(datagram_.data(), size)));
    if (length == 0 || length > kMost_bytes || !from_.address().is_v4() || from_ == own_) {
      ++counts_.malformed;
      return;
    }
    const auto told = read_announcement(std::as_bytes(std::span(datagram_.data(), length)));
    if (!told) {
      ++counts_.no_announcement;
      return;
    }
    const Introductions::Answer answer =
        introductions_.take(*told, from_.address().to_v4().to_uint(), now_s());
    count(answer.outcome);
    counts_.most_participants = std::max(counts_.most_participants, introductions_.size());
    if (answer.is_new && told->purpose->serves) say({*told->purpose, answer.place}, "is here");
    for (const UdpPlace& to : answer.to) {
      const udp::endpoint other(asio::ip::address_v4(to.ipv4), to.port);
      if (other == own_) continue;
      boost::system::error_code error;
      socket_.send_to(asio::buffer(datagram_.data(), length), other, 0, error);
      ++(error ? counts_.not_sent : counts_.passed_on);
    }
  }
  void count(Outcome outcome) {
    switch (outcome) {
      case Outcome::kTaken:
        ++counts_.heard;
        return;
      case Outcome::kNoPurpose:
        ++counts_.no_purpose;
        return;
      case Outcome::kFromElsewhere:
        ++counts_.from_elsewhere;
        return;
      case Outcome::kOtherPurpose:
        ++counts_.other_purpose;
        return;
      case Outcome::kUnknown:
        ++counts_.unknown;
        return;
      case Outcome::kTooOften:
        ++counts_.too_often;
        break;
      case Outcome::kFull:
        ++counts_.full;
        break;
    }
    turned_away_ = from_.address();
  }

  asio::io_context io_{1};
  udp::socket socket_{io_};
  std::string place_;
  std::array<char, 65536> datagram_{};
  udp::endpoint own_, from_;
  Introductions introductions_;
  DiscoveryCounts counts_;
  const Tell* tell_ = nullptr;
  double lines_ = kLinesPerSecond, swept_s_ = now_s(), warned_s_ = -kWarnAgain_s;
  std::uint64_t unsaid_ = 0, warned_of_ = 0;
  asio::ip::address turned_away_;  ///< last of them
};

}  // namespace

Result<std::unique_ptr<DiscoveryServer>> DiscoveryServer::open(const DiscoveryOptions& options) {
  auto server = std::make_unique<UdpDiscoveryServer>();
  if (Status opened = server->open(options); !opened) return opened.error();
  return std::unique_ptr<DiscoveryServer>(std::move(server));
}

}  // namespace mortise

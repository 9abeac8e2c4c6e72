// The thread that keeps a lease, beside the ticks that ask it: against an etcd that this test
// plays.
#include "server/etcd_fencing.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>

namespace mortise {
namespace {

using Json = nlohmann::json;
constexpr auto kMost = std::chrono::seconds(20);

/// The JSON gateway of one node, as far as a fencing asks: leases never end, transactions compare
/// one revision. A request a connection.
class PlayedEtcd {
 public:
  PlayedEtcd() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof place;
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&place), size), 0);
    EXPECT_EQ(::listen(listener_, 8), 0);
    EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&place), &size), 0);
    port_ = ntohs(place.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~PlayedEtcd() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  EtcdClient client() const { return *EtcdClient::open("127.0.0.1:" + std::to_string(port_)); }

 private:
  void serve() {
    for (int peer = ::accept(listener_, nullptr, nullptr); peer >= 0;
         peer = ::accept(listener_, nullptr, nullptr)) {
      std::string text;
      char piece[4096];
      for (ssize_t n = 1; n > 0 && !is_whole(text);) {
        n = ::recv(peer, piece, sizeof piece, 0);
        if (n > 0) text.append(piece, static_cast<std::size_t>(n));
      }
      const std::string body = answer(text).dump();
      const std::string reply =
          "HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(body.size()) +
          "\r\nConnection: close\r\n\r\n" + body;
      (void)!::send(peer, reply.data(), reply.size(), MSG_NOSIGNAL);
      ::close(peer);
    }
  }
  static bool is_whole(const std::string& text) {
    const std::size_t head = text.find("\r\n\r\n"), length = text.find("Content-Length: ");
    return head != std::string::npos && length != std::string::npos &&
           text.size() >= head + 4 + std::stoul(text.substr(length + 16));
  }
  Json answer(const std::string& text) {
    const std::string what = text.substr(0, text.find(" HTTP"));
    const Json asked = Json::parse(text.substr(text.find("\r\n\r\n") + 4), nullptr, false);
    if (what.ends_with("lease/grant")) return {{"ID", "7"}, {"TTL", "6"}};
    if (what.ends_with("lease/keepalive")) return {{"result", {{"TTL", "6"}}}};
    if (what.ends_with("kv/range")) {
      const auto value = values_.find(asked["key"]);
      return value == values_.end() ? Json::object() : Json{{"kvs", {value->second}}};
    }
    if (!what.ends_with("kv/txn")) return Json::object();
    const Json& compare = asked["compare"][0];
    const auto known = values_.find(compare["key"]);
    const std::string since = known == values_.end() ? "0" : known->second["mod_revision"];
    if (since != compare["mod_revision"]) return {{"succeeded", false}};
    const std::string now = std::to_string(++revision_);
    for (const Json& one : asked["success"]) {
      const Json& put = one["request_put"];
      values_[put["key"]] = {{"value", put["value"]}, {"mod_revision", now}};
    }
    return {{"succeeded", true}, {"header", {{"revision", now}}}};
  }

  const int listener_;
  std::uint16_t port_ = 0;
  std::int64_t revision_ = 0;
  std::map<std::string, Json> values_;  // by key, both as they were sent
  std::thread thread_;
};

bool comes(const std::function<bool()>& what) {
  const auto until = std::chrono::steady_clock::now() + kMost;
  while (!what() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return what();
}

TEST(EtcdFencing, IsAskedByTicksWhileItsThreadChangesTheWord) {
  PlayedEtcd etcd;
  EtcdFencing fencing(etcd.client(), "hall", "one");
  ASSERT_TRUE(fencing.lead([] { return true; }));
  EXPECT_TRUE(fencing.may_say(""));
  fencing.ask("two");
  EXPECT_TRUE(fencing.may_say("two"));
  // Two may take over once the word says so; then nothing may be said that two does not have.
  EXPECT_TRUE(comes([&] { return !fencing.may_say(""); }));
  for (int i = 0; i < 100; ++i) fencing.ask(i % 2 == 0 ? "" : "two");
  fencing.ask("");
  EXPECT_TRUE(comes([&] { return fencing.may_say("") && fencing.may_say("three"); }));
  EXPECT_EQ(fencing.barred(), "");
}

TEST(EtcdFencing, EndsWhereAnotherServerTookOver) {
  PlayedEtcd etcd;
  EtcdFencing leads(etcd.client(), "hall", "one");
  ASSERT_TRUE(leads.lead([] { return true; }));
  leads.ask("two");
  ASSERT_TRUE(comes([&] { return !leads.may_say(""); }));
  EtcdFencing follows(etcd.client(), "hall", "two");
  // The first holds back before etcd has its word; until then the second is refused.
  bool took = false;
  ASSERT_TRUE(comes([&] { return took = took || follows.take_over([] { return true; }); }));
  EXPECT_TRUE(follows.may_say(""));
  EXPECT_TRUE(comes([&] { return !leads.barred().empty(); }));
  EXPECT_FALSE(leads.may_say("two"));
}

}  // namespace
}  // namespace mortise

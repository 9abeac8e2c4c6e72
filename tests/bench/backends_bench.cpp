// What this project would get of another DDS implementation: four topics of a session by Fast DDS,
// behind our guard, and by Cyclone DDS, in processes of their own on loopback. See README.md.
#include <fmt/format.h>
#include <sys/resource.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <iostream>
#include <random>
#include <sstream>

#include "tests/bench/backends_peer.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/session_load.h"
#include "tests/bench/statistics.h"
#include "tests/network/key_ring.h"
#include "tests/network/noise.h"
#include "tests/network/program.h"
#include "tests/network/wiretap.h"

namespace mortise::bench {
namespace {

constexpr int kDomain = 80, kReaders = 8;
constexpr double kMost_s = 60.0;
constexpr std::uint64_t kWriteNow = std::uint64_t{1} << 60;  // the seq that asks for meshes

struct Backend {
  const char* name;
  const char* word;  // of the command line
  std::unique_ptr<Peer> (*open)(const PeerOptions&, PeerHears);
};
constexpr Backend kBackends[] = {{"Fast DDS 2.9.1 behind the guard", "fast-dds", open_fast_dds},
                                 {"Cyclone DDS 0.10.2", "cyclone", open_cyclone}};

struct BackendsOptions : BenchOptions {
  int of(int whole) const { return quick ? std::max(whole / 4, 2) : whole; }
};

template <class Done>
bool until(Done done, double limit_s = kMost_s, double nap_s = 0.0005) {
  const double end_s = steady_s() + limit_s;
  while (!done()) {
    if (steady_s() > end_s) return false;
    sleep_s(nap_s);
  }
  return true;
}

// ---- processes of their own: `backends_bench --role BACKEND ROLE DOMAIN NUMBER`

/// What a role is told beside what it is.
struct RoleOptions {
  int domain = 0;
  double number = 0.0;
  std::string keys;  ///< of this role; empty: no security
};

/// Answers increments. Writes so many MB of meshes when it begins (below zero: when it is asked).
int serve(const Backend& backend, const RoleOptions& role) {
  const double mb = role.number;
  std::atomic<bool> write_now{mb > 0.0};
  std::unique_ptr<Peer> peer;
  std::atomic<Peer*> answers{nullptr};
  PeerHears hears;
  hears.increment = [&](std::uint64_t seq) {
    if (seq == kWriteNow) write_now = true;
    if (Peer* to = answers) to->say_acknowledged(seq);
  };
  peer = backend.open({.domain = role.domain, .is_server = true, .keys = role.keys}, hears);
  if (!peer) return 1;
  answers = peer.get();
  std::cout << "up" << std::endl;
  while (!write_now) sleep_s(0.001);
  const std::vector<std::uint8_t> bytes(kPieceBytes, 7);
  const double begin_s = steady_s();
  double longest_s = 0.0;
  std::uint64_t full = 0;
  const auto pieces = static_cast<std::uint32_t>(std::abs(mb) * 1e6 / kPieceBytes);
  for (std::uint32_t chunk = 0; chunk < pieces;) {
    const double before_s = steady_s();
    const bool said = peer->say_mesh(chunk, bytes);
    longest_s = std::max(longest_s, steady_s() - before_s);
    chunk += said;
    full += !said;
  }
  std::cout << fmt::format("written {:.6f} {:.6f} {:.6f} {}", begin_s, steady_s(), longest_s, full)
            << std::endl;
  for (;;) sleep_s(1.0);
}

/// Reads so many MB of meshes, says when it began and when it had all.
int take(const Backend& backend, const RoleOptions& role) {
  std::atomic<std::size_t> got{0};
  PeerHears hears;
  hears.mesh = [&](std::size_t bytes) { got += bytes; };
  const double begin_s = steady_s();
  const auto peer = backend.open({.domain = role.domain, .meshes = true, .keys = role.keys}, hears);
  if (!peer || !until([&] { return peer->has_met(); })) return 1;
  std::cout << "met" << std::endl;
  const auto all = static_cast<std::size_t>(role.number * 1e6 / kPieceBytes) * kPieceBytes;
  if (!until([&] { return got >= all; }, kMost_s, 0.002)) return 1;
  std::cout << fmt::format("whole {:.6f} {:.6f}", begin_s, steady_s()) << std::endl;
  return 0;
}

/// Says that it is there, four times a lease.
int be_present(const Backend& backend, const RoleOptions& role) {
  const double lease_s = role.number;
  const auto peer = backend.open({.domain = role.domain, .lease_s = lease_s}, {});
  if (!peer) return 1;
  for (;;) {
    peer->say_present();
    sleep_s(lease_s / 4.0);
  }
}

int play_role(const std::vector<std::string>& words) {
  if (words.size() != 5) return 2;
  const RoleOptions role{std::stoi(words[2]), std::stod(words[3]), words[4]};
  for (const Backend& backend : kBackends) {
    if (words[0] != backend.word) continue;
    if (words[1] == "serve") return serve(backend, role);
    if (words[1] == "take") return take(backend, role);
    if (words[1] == "present") return be_present(backend, role);
  }
  return 2;
}

class Roles {
 public:
  explicit Roles(const Backend& backend) : backend_(backend) {}
  std::unique_ptr<test::Program> start(const std::string& role, double number,
                                       const std::string& keys = "") {
    return std::make_unique<test::Program>(
        folder_.path(), "backends_bench",
        std::vector<std::string>{"--role", backend_.word, role, std::to_string(kDomain),
                                 std::to_string(number), keys});
  }
  std::unique_ptr<test::Program> server(double mb, const std::string& keys = "") {
    auto made = start("serve", mb, keys);
    until([&] { return made->out().find(mb > 0.0 ? "written" : "up") != std::string::npos; });
    return made;
  }

 private:
  const Backend& backend_;
  test::TestFolder folder_;
};

/// Keys of a server and of a designer; of nobody where there is no security. Cyclone takes no
/// domain above 230, so governance and permissions are signed again with that.
class Keys {
 public:
  explicit Keys(bool secure) {
    if (!secure) return;
    ring_ = std::make_unique<test::KeyRing>("site");
    ring_->issue("hall", "server");
    ring_->issue("anna", "designer");
    test::TestFolder folder;
    const std::string signs =
        "cd " + (*ring_)["."] +
        " && site=$(dirname $(find . -name ca.key)) && for file in hall/*.p7s anna/*.p7s; do"
        " openssl smime -verify -noverify -text -in $file | sed 's/>232</>230</' >all.xml &&"
        " openssl smime -sign -text -in all.xml -out $file -signer $site/ca.crt"
        " -inkey $site/ca.key || exit 1; done";
    test::Program shell(folder.path(), "/bin/sh", {"-c", signs});
    if (shell.wait(kMost_s) != 0) std::cerr << "keys: " << shell.errors();
  }
  std::string server() const { return ring_ ? (*ring_)["hall"] : ""; }
  std::string client() const { return ring_ ? (*ring_)["anna"] : ""; }

 private:
  std::unique_ptr<test::KeyRing> ring_;
};

std::string name_of(const Backend& backend, bool secure) {
  return std::string(backend.name) + (secure ? ", keys" : "");
}

/// The numbers behind a word of what a role said; none: it has not said it.
std::vector<double> said(const test::Program& program, const std::string& word) {
  const std::string out = program.out();
  const std::size_t at = out.find(word + " ");
  std::vector<double> numbers;
  if (at == std::string::npos) return numbers;
  std::istringstream words(out.substr(at + word.size() + 1));
  for (double number = 0.0; words >> number;) numbers.push_back(number);
  return numbers;
}

/// A client that asks, and how long an answer takes.
class Asker {
 public:
  explicit Asker(const Backend& backend, const std::string& keys = "") {
    PeerHears hears;
    hears.acknowledged = [this](std::uint64_t seq) {
      if (seq == seq_) answered_s_ = steady_s();
    };
    peer_ = backend.open({.domain = kDomain, .keys = keys}, hears);
  }
  bool has_met() const {
    return peer_ && until([&] { return peer_->has_met(); });
  }
  Peer& peer() { return *peer_; }
  /// Milliseconds of each of so many; best effort, one that is lost counts for a second.
  std::vector<double> trips_ms(int count) {
    std::vector<double> all;
    const auto more = [&] { return --count >= 0; };
    return trips_ms_while(more);
  }
  std::vector<double> trips_ms_while(const std::function<bool()>& more) {
    std::vector<double> all;
    while (more()) {
      answered_s_ = 0.0;
      ++seq_;
      const double begin_s = steady_s();
      peer_->say_increment(seq_);
      until([&] { return answered_s_ > 0.0; }, 1.0, 0.00002);
      all.push_back(1e3 * (answered_s_ > 0.0 ? answered_s_ - begin_s : 1.0));
      sleep_s(0.004);
    }
    return all;
  }

 private:
  std::atomic<double> answered_s_{0.0};
  std::atomic<std::uint64_t> seq_{0};
  std::unique_ptr<Peer> peer_;
};

// ---- sections

void section_discovery(Report& report, const BackendsOptions& options) {
  report.table("A client comes: from opening it until both ends have met, ms",
               {"backend", "times", "median", "p90", "most", "load average"});
  for (const bool secure : {false, true}) {
    const Keys keys(secure);
    for (const Backend& backend : kBackends) {
      Roles roles(backend);
      const auto server = roles.server(0.0, keys.server());
      std::vector<double> all_ms;
      for (int i = 0; i < options.of(40); ++i) {
        const double begin_s = steady_s();
        const Asker client(backend, keys.client());
        all_ms.push_back(client.has_met() ? 1e3 * (steady_s() - begin_s) : NAN);
      }
      report.row({name_of(backend, secure), static_cast<long long>(all_ms.size()),
                  quantile(all_ms, 0.5), quantile(all_ms, 0.9), largest(all_ms),
                  fmt::format("{:.1f}", load_average())});
    }
  }
}

void section_trip(Report& report, const BackendsOptions& options) {
  report.table("An increment of 100 bytes there and its acknowledgement back, ms",
               {"backend", "times", "p50", "p99", "most", "load average"});
  for (const bool secure : {false, true}) {
    const Keys keys(secure);
    for (const Backend& backend : kBackends) {
      Roles roles(backend);
      const auto server = roles.server(0.0, keys.server());
      Asker asker(backend, keys.client());
      std::vector<double> all_ms;
      if (asker.has_met()) {
        asker.trips_ms(200);
        all_ms = asker.trips_ms(options.of(4000));
      }
      report.row({name_of(backend, secure), static_cast<long long>(all_ms.size()),
                  quantile(all_ms, 0.5), quantile(all_ms, 0.99), largest(all_ms),
                  fmt::format("{:.1f}", load_average())});
    }
  }
}

/// Meshes for all readers, who come when all is written, or are there before.
void give_meshes(Report& report, const Backend& backend, double mb, bool before) {
  Roles roles(backend);
  const auto server = roles.server(before ? -mb : mb);
  Asker asker(backend);
  if (!asker.has_met()) return report.note(std::string(backend.name) + ": nobody meets the server");
  asker.trips_ms(100);
  const std::vector<double> undisturbed_ms = asker.trips_ms(500);
  std::vector<std::unique_ptr<test::Program>> readers;
  for (int i = 0; i < kReaders; ++i) readers.push_back(roles.start("take", mb));
  if (before) {
    for (const auto& reader : readers)
      until([&] { return reader->out().find("met") != std::string::npos; });
    sleep_s(1.0);  // their readers of meshes, too
    asker.peer().say_increment(kWriteNow);
  }
  const double end_s = steady_s() + kMost_s;
  const std::vector<double> trips_ms = asker.trips_ms_while([&] {
    if (steady_s() > end_s) return false;
    for (const auto& reader : readers)
      if (reader->running()) return true;
    return false;
  });
  until([&] { return !said(*server, "written").empty(); }, 10.0);
  const std::vector<double> written = said(*server, "written");
  long long whole = 0;
  double slowest_s = 0.0;
  for (const auto& reader : readers) {
    const std::vector<double> took = said(*reader, "whole");
    if (took.size() < 2) continue;
    ++whole;
    slowest_s = std::max(slowest_s, took[1] - (before ? written.at(0) : took[0]));
  }
  const bool has = written.size() == 4;
  report.row({std::string(backend.name),
              std::string(before ? "there before" : "come when it is written"), whole, slowest_s,
              has ? 1e3 * written[2] : NAN, has ? static_cast<long long>(written[3]) : -1LL,
              quantile(undisturbed_ms, 0.99), quantile(trips_ms, 0.5), quantile(trips_ms, 0.99),
              largest(trips_ms), fmt::format("{:.1f}", load_average())});
}

void section_meshes(Report& report, const BackendsOptions& options) {
  report.table(
      "50 MB in pieces of 59 kB, reliable, for eight readers; trips of increments beside",
      {"backend", "readers", "got all", "slowest s", "longest write ms", "writes refused",
       "undisturbed trip p99 ms", "trip p50 ms", "trip p99 ms", "longest trip ms", "load average"});
  for (int run = 0; run < (options.quick ? 1 : 3); ++run)
    for (const bool before : {false, true})
      for (const Backend& backend : kBackends) give_meshes(report, backend, 50.0, before);
}

void section_liveliness(Report& report, const BackendsOptions& options) {
  report.table(
      "A process is killed: from then until its presence is told as gone, ms",
      {"backend", "lease ms", "times", "median", "most", "told too early", "load average"});
  std::mt19937 random(7);
  for (const double lease_s : {0.15, 0.8})
    for (const Backend& backend : kBackends) {
      Roles roles(backend);
      std::atomic<bool> alive{false};
      std::atomic<int> changes{0};
      PeerHears hears;
      hears.presence = [&](bool now) {
        alive = now;
        ++changes;
      };
      const auto server =
          backend.open({.domain = kDomain, .is_server = true, .lease_s = lease_s}, hears);
      std::vector<double> all_ms;
      long long early = 0;
      for (int i = 0; i < options.of(20) && server; ++i) {
        const auto client = roles.start("present", lease_s);
        if (!until([&] { return alive.load(); })) break;
        changes = 0;
        sleep_s(1.0 + std::uniform_real_distribution<double>(0.0, lease_s)(random));
        early += changes;
        client->signal(SIGKILL);
        const double killed_s = steady_s();
        if (until([&] { return !alive; })) all_ms.push_back(1e3 * (steady_s() - killed_s));
      }
      report.row({std::string(backend.name), 1e3 * lease_s, static_cast<long long>(all_ms.size()),
                  quantile(all_ms, 0.5), largest(all_ms), early,
                  fmt::format("{:.1f}", load_average())});
    }
}

/// In a process of its own.
bool meets_anew(Roles& roles, const Keys& keys) {
  const auto client = roles.start("take", 0.0, keys.client());
  return client->wait(kMost_s + 5.0) == 0;
}

/// Mutations of all that a client says to a server, from the first word on.
void make_noise(Report& report, const Backend& backend, bool secure, int datagrams) {
  constexpr int kPort = 7402 + 250 * kDomain;
  const Keys keys(secure);
  test::Wiretap tap(kPort);
  if (!tap.works()) return report.note("not root: no raw sockets, nothing can be recorded");
  Roles roles(backend);
  const auto server = roles.server(0.0, keys.server());
  Asker asker(backend, keys.client());
  if (asker.has_met()) asker.trips_ms(50);
  const auto seeds = tap.take();
  std::mt19937_64 random(11);
  test::Socket mouth(0);
  int said = 0;
  for (; said < datagrams && !seeds.empty() && server->running(); ++said) {
    const auto& heard = seeds[random() % seeds.size()];
    mouth.send(test::mutate({heard.bytes.begin(), heard.bytes.end()}, random), heard.port);
    if (said % 100 == 0) sleep_s(0.002);
  }
  sleep_s(3.0);
  const bool lives = server->running();
  report.row({name_of(backend, secure), static_cast<long long>(seeds.size()),
              static_cast<long long>(said),
              lives ? std::string("lives") : fmt::format("ended: {}", server->wait(0.0)),
              std::string(!lives                    ? "-"
                          : meets_anew(roles, keys) ? "yes"
                                                    : "no")});
}

void section_noise(Report& report, const BackendsOptions& options) {
  report.table("Mutations of what a client says to a server, from its first word on, in its name",
               {"backend", "seeds", "mutations", "server", "a new client meets it"});
  for (const bool secure : {false, true})
    for (const Backend& backend : kBackends)
      make_noise(report, backend, secure, options.of(400'000));
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) {
  using namespace mortise::bench;
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "--role") return play_role({words.begin() + 1, words.end()});
  static const std::vector<BenchSection<BackendsOptions>> sections = {
      {"discovery", "how soon a client and the server have met", section_discovery},
      {"trip", "an increment there and its acknowledgement back", section_trip},
      {"meshes", "50 MB for eight readers, and trips beside", section_meshes},
      {"liveliness", "how soon a killed client is told", section_liveliness},
      {"noise", "mutated datagrams", section_noise},
  };
  return run_bench(argc, argv, "Fast DDS and Cyclone DDS below a session, on loopback", sections);
}

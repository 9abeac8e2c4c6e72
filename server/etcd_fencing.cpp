#include "server/etcd_fencing.h"

#include <time.h>

#include <algorithm>
#include <chrono>

#include "server/scheduling.h"

namespace mortise {
namespace {

// A lease is renewed six times in its length. Who waits for another looks ten times a second.
constexpr double kRenew_s = 1.0, kAgain_s = 0.1;

// Of a clock that goes on while the machine sleeps.
double boot_s() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void wait_a_moment() { std::this_thread::sleep_for(std::chrono::duration<double>(kAgain_s)); }

}  // namespace

EtcdFencing::EtcdFencing(EtcdClient etcd, const std::string& session, ClientKey own)
    : etcd_(std::move(etcd)),
      word_key_("/mortise/" + session + "/word"),
      lease_key_("/mortise/" + session + "/lease"),
      own_(std::move(own)) {}

EtcdFencing::~EtcdFencing() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wakes_.notify_one();
  if (thread_.joinable()) thread_.join();
  if (lease_ != 0) (void)etcd_.ask("lease/revoke", {{"ID", std::to_string(lease_)}});
}

bool EtcdFencing::grant_lease() {
  const auto granted = etcd_.ask("lease/grant", {{"TTL", std::to_string(kLease_s)}});
  if (!granted || EtcdClient::number(*granted, "ID") == 0) return false;
  lease_ = EtcdClient::number(*granted, "ID");
  return true;
}

std::optional<std::int64_t> EtcdFencing::change(const std::string& key, std::int64_t since,
                                                const nlohmann::json& puts) {
  const auto compare = nlohmann::json::array({EtcdClient::unchanged_since(key, since)});
  const auto done = etcd_.ask("kv/txn", {{"compare", compare}, {"success", puts}});
  if (!done) return std::nullopt;
  if (EtcdClient::member(*done, "succeeded") != true) return 0;
  return EtcdClient::number(EtcdClient::member(*done, "header"), "revision");
}

nlohmann::json EtcdFencing::lease_and_word() const {
  return nlohmann::json::array(
      {EtcdClient::put(lease_key_, own_, lease_), EtcdClient::put(word_key_, word({}))});
}

Status EtcdFencing::lead(const std::function<bool()>& goes_on) {
  std::string other = "none of its nodes answers";
  for (const double end_s = boot_s() + 2.0 * kLease_s + 3.0; boot_s() < end_s && goes_on();
       wait_a_moment()) {
    const auto holder = etcd_.read(lease_key_);
    if (!holder) continue;
    if (holder->revision != 0) other = "the server " + holder->text + " leads";
    // Of a try of ours of which nobody knew.
    if (holder->text == own_) (void)etcd_.ask("lease/revoke", {{"ID", std::to_string(lease_)}});
    if (holder->revision != 0) continue;
    const double asked_s = boot_s();
    if (!grant_lease()) continue;
    const auto begun = change(lease_key_, 0, lease_and_word());
    if (begun && *begun != 0) return begin(*begun, asked_s), ok();
  }
  return fail(Code::kRuntime, "the etcd of this site does not let this server lead: " + other);
}

Status EtcdFencing::take_over(const std::function<bool()>& goes_on) {
  for (; goes_on(); wait_a_moment()) {
    const auto now = etcd_.read(word_key_);
    if (!now) continue;
    const std::size_t bar = now->text.find('|');
    const bool is_ours = now->text == word({});  // by a try of which nobody knew
    if (!is_ours && (bar == std::string::npos || now->text.substr(bar + 1) != own_))
      return fail(Code::kRuntime,
                  "the server that leads went on without this one, says the etcd of this site: "
                  "start it again");
    const double asked_s = boot_s();
    if (!grant_lease()) continue;
    const auto taken = change(word_key_, now->revision, lease_and_word());
    if (taken && *taken != 0) return begin(*taken, asked_s), ok();
  }
  return fail(Code::kRuntime, "stopped before it led");
}

void EtcdFencing::begin(std::int64_t revision, double lease_from_s) {
  revision_ = revision;
  is_placed_ = true;
  hold_from(lease_from_s);
  possible_ = {ClientKey{}};
  thread_ = std::thread([this] {
    run_as_others();
    run();
  });
}

bool EtcdFencing::may_say(const ClientKey& has_it) const {
  if (lost_ || boot_s() >= leased_s_ + kLease_s) return false;
  const std::lock_guard lock(mutex_);
  return std::ranges::all_of(possible_,
                             [&](const ClientKey& who) { return who.empty() || who == has_it; });
}

std::string EtcdFencing::barred() const {
  if (lost_) return "another server leads this session, says the etcd of this site";
  if (boot_s() < leased_s_ + kWithoutLease_s) return {};
  return "no lease of the etcd of this site for 60 s: nothing was acknowledged since";
}

void EtcdFencing::ask(const ClientKey& who) {
  {
    const std::lock_guard lock(mutex_);
    const bool is_so = !wanted_ && possible_.size() == 1 && possible_.contains(who);
    if (is_so || wanted_ == who) return;
    wanted_ = who;
    possible_.insert(who);  // from now on it may come true
  }
  wakes_.notify_one();
}

void EtcdFencing::run() {
  for (double renew_s = boot_s() + kRenew_s; !lost_;) {
    std::optional<ClientKey> who;
    {
      std::unique_lock lock(mutex_);
      wakes_.wait_for(lock, std::chrono::duration<double>(kAgain_s),
                      [this] { return stop_ || wanted_; });
      if (stop_) return;
      who = wanted_;
    }
    if (who) settle(*who);
    if (boot_s() < renew_s) continue;
    renew();
    renew_s = boot_s() + kRenew_s;
  }
}

void EtcdFencing::settle(const ClientKey& who) {
  const auto done =
      change(word_key_, revision_, nlohmann::json::array({EtcdClient::put(word_key_, word(who))}));
  if (!done) return;  // whether or not it took effect, it is tried again
  if (*done == 0) return look_who_leads();
  revision_ = *done;
  const std::lock_guard lock(mutex_);
  // Whatever of before is still under way compares an older revision, and fails.
  possible_ = {who};
  if (wanted_ == who) wanted_.reset();
  if (wanted_) possible_.insert(*wanted_);
}

// The word has another revision: by a try of ours of which nobody knew, or by another server.
void EtcdFencing::look_who_leads() {
  const auto now = etcd_.read(word_key_);
  if (!now) return;
  if (now->text.starts_with(own_ + "|"))
    revision_ = now->revision;
  else
    lost_ = true;
}

void EtcdFencing::renew() {
  if (is_placed_) {
    const double asked_s = boot_s();
    const auto renewed = etcd_.ask("lease/keepalive", {{"ID", std::to_string(lease_)}});
    if (!renewed) return;
    is_placed_ = EtcdClient::number(EtcdClient::member(*renewed, "result"), "TTL") > 0;
    if (is_placed_) hold_from(asked_s);
  }
  look_who_leads();
  if (is_placed_ || lost_) return;
  // It has ended: a new one, if nobody has led since.
  const double asked_s = boot_s();
  if (!grant_lease()) return;
  const auto done = change(word_key_, revision_,
                           nlohmann::json::array({EtcdClient::put(lease_key_, own_, lease_)}));
  is_placed_ = done && *done != 0;
  if (is_placed_) hold_from(asked_s);
}

}  // namespace mortise

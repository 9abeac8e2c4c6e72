#pragma once
#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "server/etcd_client.h"
#include "server/fencing.h"

namespace mortise {

/// The word of a site's etcd, in two keys of a session: /mortise/SESSION/word holds
/// LEADER|WHO-MAY-TAKE-OVER and is changed by comparing its revision alone;
/// /mortise/SESSION/lease exists while the one that leads renews its lease. Who begins needs that
/// no lease is there; who takes over, that the word names it. A thread of its own asks.
class EtcdFencing final : public Fencing {
 public:
  /// Whole seconds, as etcd counts. While its nodes elect a leader they are silent, up to 2 s by
  /// its own defaults: three times that.
  static constexpr int kLease_s = 6;
  /// Without a lease for so long this server ends: what is not said grows.
  static constexpr double kWithoutLease_s = 60.0;

  /// `own` names this server among all of the session.
  EtcdFencing(EtcdClient etcd, const std::string& session, ClientKey own);
  ~EtcdFencing() override;  ///< gives the lease back, where an etcd answers

  /// Waits until nobody leads, for at most twice a lease, then leads. `goes_on` is asked each turn.
  Status lead(const std::function<bool()>& goes_on);
  /// The same of one that stands by; fails (kRuntime) where the word does not name it. While no
  /// etcd answers it waits.
  Status take_over(const std::function<bool()>& goes_on);

  bool may_say(const ClientKey& has_it) const override;
  void ask(const ClientKey& who_may_take_over) override;
  std::string barred() const override;

 private:
  std::string word(const ClientKey& who) const { return own_ + "|" + who; }
  void begin(std::int64_t revision, double lease_from_s);
  void run();
  bool grant_lease();
  void hold_from(double asked_s) { leased_s_ = asked_s; }
  void renew();
  /// One try to make the word what was asked for.
  void settle(const ClientKey& who);
  /// A change that holds only while the key has this revision; the new one. 0: not done; none:
  /// nobody knows.
  std::optional<std::int64_t> change(const std::string& key, std::int64_t since,
                                     const nlohmann::json& puts);
  nlohmann::json lease_and_word() const;
  void look_who_leads();

  EtcdClient etcd_;
  const std::string word_key_, lease_key_;
  const ClientKey own_;
  std::int64_t lease_ = 0, revision_ = 0;  ///< of the word, as this server wrote it last
  bool is_placed_ = false;                 ///< the lease, at its key
  std::atomic<double> leased_s_{0.0};      ///< when the lease was asked for last that was given
  std::atomic<bool> lost_{false};

  mutable std::mutex mutex_;
  std::condition_variable wakes_;
  std::optional<ClientKey> wanted_;  ///< none: the word is as it was asked to be
  std::set<ClientKey> possible_;     ///< who may take over, as far as is known
  bool stop_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace mortise

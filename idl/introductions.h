#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "idl/announcement.h"

namespace mortise {

/// Who is to hear of whom, as a discovery server decides: servers and clients of one session, and
/// servers of one session among themselves. Clients never hear of each other. No network, no clock:
/// the caller tells the time, s, never less than before.
///
/// An announcement is passed on a few times to whom it is new, and then seldom: who is introduced
/// hears the other directly, and is to notice when it does not (what is passed on counts as a sign
/// of life).
///
/// Announcements are proven by nothing, so they are bound to where they come from: a participant
/// hears of others at the host that it speaks from only, and whoever calls itself by the name of
/// another from elsewhere is not heard while that one speaks. What one host may cost is bound.
class Introductions {
 public:
  static constexpr double kSilence_s = 3.0;             ///< then a participant is forgotten
  static constexpr std::size_t kMost = 20'000;          ///< participants
  static constexpr std::size_t kMostOfHost = 4'000;     ///< of them, of one host
  static constexpr std::size_t kMostServers = 8;        ///< of one session
  static constexpr std::size_t kMostServersOfHost = 3;  ///< of them, of one host
  static constexpr double kPerSecond = 20.0;            ///< announcements of one participant
  static constexpr double kAtOnce = 40.0;               ///< of them, after a silence
  static constexpr double kHostPerSecond = 20'000.0;    ///< passed on for one host
  static constexpr int kWhileNew = 4;                   ///< announcements to one that is new
  static constexpr double kAgain_s = 4.0;               ///< then one each so often

  enum class Outcome {
    kTaken,
    kNoPurpose,      ///< tells no discovery server: a program of before, or none of ours
    kFromElsewhere,  ///< names places of other hosts, or is another's
    kOtherPurpose,   ///< was here for something else
    kUnknown,        ///< takes leave, and was not here
    kTooOften,
    kFull,
  };
  struct Answer {
    Outcome outcome = Outcome::kTaken;
    bool is_new = false;       ///< it was not here before
    UdpPlace place;            ///< where it hears of others
    std::vector<UdpPlace> to;  ///< whom the announcement is to be passed on to
  };
  /// O(log n + all that are of its session).
  Answer take(const Announcement& told, std::uint32_t from_ipv4, double now_s);

  struct Participant {
    Purpose purpose;
    UdpPlace place;
  };
  /// Who has been silent for too long, or has taken leave, since the last call. O(n).
  std::vector<Participant> take_gone(double now_s);

  std::size_t size() const { return here_.size() - left_; }
  std::size_t servers() const { return servers_; }
  std::size_t sessions() const { return sessions_.size(); }

 private:
  using Key = std::array<std::byte, 12>;
  using Session = std::pair<int, std::string>;  ///< domain and name
  struct Told {
    int times = 0;
    double last_s = 0.0;
  };
  struct Here {
    Participant participant;
    double heard_s = 0.0;
    double credit = kAtOnce;   ///< announcements that it may make now
    bool left = false;         ///< has taken leave; its credit is kept, lest it comes and goes
    std::map<Key, Told> told;  ///< whom it was made known to
  };
  struct Members {
    std::set<Key> servers, clients;
  };
  struct Host {
    std::size_t participants = 0;
    double credit = kHostPerSecond;  ///< datagrams that may be passed on for it now
    double asked_s = 0.0;
  };
  static Session session_of(const Purpose& purpose) { return {purpose.domain, purpose.session}; }
  bool is_room_for(const Purpose& purpose, std::uint32_t from_ipv4) const;
  void enter(const Key& key, const Purpose& purpose);
  void leave(const Key& key, const Purpose& purpose);
  /// All that are to know of it.
  std::vector<Key> circle(const Key& key, const Purpose& purpose) const;
  Answer take_leave(const Key& key, Here& here);
  /// Within what the host may still have passed on.
  bool pass_on(const Key& key, Here& here, double now_s, std::vector<UdpPlace>& to);

  std::map<Key, Here> here_;
  std::map<Session, Members> sessions_;
  std::map<std::uint32_t, Host> hosts_;
  std::vector<Participant> gone_;
  std::size_t servers_ = 0, left_ = 0;
};

}  // namespace mortise

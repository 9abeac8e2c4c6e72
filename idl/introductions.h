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
/// Announcements are proven by nothing, so they are bound to where they come from: a participant is
/// told of others at that host only, and whoever calls itself by the name of another from elsewhere
/// is not heard while that one speaks.
class Introductions {
 public:
  static constexpr double kSilence_s = 3.0;       ///< then a participant is forgotten
  static constexpr std::size_t kMost = 20'000;    ///< participants
  static constexpr std::size_t kMostServers = 8;  ///< of one session
  static constexpr double kPerSecond = 20.0;      ///< announcements of one participant
  static constexpr double kAtOnce = 40.0;         ///< of them, after a silence

  enum class Outcome {
    kTaken,
    kNoPurpose,      ///< a program of before, or none of ours
    kFromElsewhere,  ///< names no place of the host that it comes from, or is another's
    kTooOften,
    kFull,
  };
  struct Answer {
    Outcome outcome = Outcome::kTaken;
    bool is_new = false;       ///< it was not here before
    UdpPlace place;            ///< where it hears of others
    std::vector<UdpPlace> to;  ///< whom the announcement is to be passed on to
  };
  /// O(log n + whom it is passed on to).
  Answer take(const Announcement& told, std::uint32_t from_ipv4, double now_s);

  struct Participant {
    Purpose purpose;
    UdpPlace place;
  };
  /// Who has been silent for too long, or has taken leave, since the last call. O(n).
  std::vector<Participant> take_gone(double now_s);

  std::size_t size() const { return here_.size(); }
  std::size_t servers() const { return servers_; }
  std::size_t sessions() const { return sessions_.size(); }

 private:
  using Key = std::array<std::byte, 12>;
  using Session = std::pair<int, std::string>;  ///< domain and name
  struct Here {
    Participant participant;
    double heard_s = 0.0;
    double credit = kAtOnce;  ///< announcements that it may make now
  };
  struct Members {
    std::set<Key> servers, clients;
  };
  static Session session_of(const Purpose& purpose) { return {purpose.domain, purpose.session}; }
  void enter(const Key& key, const Purpose& purpose);
  void leave(const Key& key, const Purpose& purpose);
  void add_places(const std::set<Key>& keys, const Key& but, std::vector<UdpPlace>& to) const;

  std::map<Key, Here> here_;
  std::map<Session, Members> sessions_;
  std::vector<Participant> left_;
  std::size_t servers_ = 0;
};

}  // namespace mortise

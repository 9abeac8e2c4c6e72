#include "idl/introductions.h"

#include <algorithm>

#include "idl/directory.h"

namespace mortise {
namespace {

Introductions::Answer refused(Introductions::Outcome outcome) {
  Introductions::Answer answer;
  answer.outcome = outcome;
  return answer;
}

}  // namespace

bool Introductions::is_room_for(const Purpose& purpose, std::uint32_t from_ipv4) const {
  const auto host = hosts_.find(from_ipv4);
  if (here_.size() >= kMost || (host != hosts_.end() && host->second.participants >= kMostOfHost))
    return false;
  const auto session = sessions_.find(session_of(purpose));
  if (!purpose.serves || session == sessions_.end()) return true;
  const std::set<Key>& servers = session->second.servers;
  const auto of_host = std::count_if(servers.begin(), servers.end(), [&](const Key& key) {
    return here_.at(key).participant.place.ipv4 == from_ipv4;
  });
  return servers.size() < kMostServers && static_cast<std::size_t>(of_host) < kMostServersOfHost;
}

void Introductions::enter(const Key& key, const Purpose& purpose) {
  Members& members = sessions_[session_of(purpose)];
  (purpose.serves ? members.servers : members.clients).insert(key);
  if (purpose.serves) ++servers_;
}

void Introductions::leave(const Key& key, const Purpose& purpose) {
  const auto found = sessions_.find(session_of(purpose));
  (purpose.serves ? found->second.servers : found->second.clients).erase(key);
  if (purpose.serves) --servers_;
  if (found->second.servers.empty() && found->second.clients.empty()) sessions_.erase(found);
}

std::vector<Introductions::Key> Introductions::circle(const Key& key,
                                                      const Purpose& purpose) const {
  std::vector<Key> all;
  const auto add = [&](const std::set<Key>& keys) {
    for (const Key& other : keys)
      if (other != key) all.push_back(other);
  };
  if (!purpose.serves && purpose.session == kEverySession) {
    for (auto at = sessions_.lower_bound({purpose.domain, ""});
         at != sessions_.end() && at->first.first == purpose.domain; ++at)
      add(at->second.servers);
    return all;
  }
  const auto session = sessions_.find(session_of(purpose));
  if (session != sessions_.end()) {
    add(session->second.servers);
    if (purpose.serves) add(session->second.clients);
  }
  const auto lookers = sessions_.find({purpose.domain, kEverySession});
  if (purpose.serves && lookers != sessions_.end()) add(lookers->second.clients);
  return all;
}

Introductions::Answer Introductions::take_leave(const Key& key, Here& here) {
  Answer answer;
  answer.place = here.participant.place;
  // Behind what was passed on of it, lest that brings it back.
  for (const auto& [other, told] : here.told) {
    const auto found = here_.find(other);
    if (found != here_.end() && !found->second.left)
      answer.to.push_back(found->second.participant.place);
  }
  leave(key, here.participant.purpose);
  gone_.push_back(here.participant);
  here.left = true;
  here.told.clear();
  ++left_;
  return answer;
}

bool Introductions::pass_on(const Key& key, Here& here, double now_s, std::vector<UdpPlace>& to) {
  std::vector<Key> due;
  for (const Key& other : circle(key, here.participant.purpose)) {
    const auto found = here.told.find(other);
    if (found == here.told.end() || found->second.times < kWhileNew ||
        now_s - found->second.last_s >= kAgain_s)
      due.push_back(other);
  }
  Host& host = hosts_[here.participant.place.ipv4];
  host.credit = std::min(kHostPerSecond, host.credit + (now_s - host.asked_s) * kHostPerSecond);
  host.asked_s = now_s;
  if (host.credit < static_cast<double>(due.size())) return false;
  host.credit -= static_cast<double>(due.size());
  for (const Key& other : due) {
    Told& told = here.told[other];
    ++told.times;
    told.last_s = now_s;
    to.push_back(here_.at(other).participant.place);
  }
  return true;
}

Introductions::Answer Introductions::take(const Announcement& told, std::uint32_t from_ipv4,
                                          double now_s) {
  const Key& key = told.participant;
  auto known = here_.find(key);
  if (known != here_.end() && known->second.participant.place.ipv4 != from_ipv4)
    return refused(Outcome::kFromElsewhere);
  if (told.leaves) {
    if (known == here_.end() || known->second.left) return refused(Outcome::kUnknown);
    return take_leave(key, known->second);
  }
  if (!told.purpose) return refused(Outcome::kNoPurpose);
  const Purpose& purpose = *told.purpose;
  const auto all_there = [from_ipv4](const std::vector<UdpPlace>& places) {
    return std::all_of(places.begin(), places.end(),
                       [from_ipv4](const UdpPlace& place) { return place.ipv4 == from_ipv4; });
  };
  if (told.places.empty() || told.hears_otherwise || !all_there(told.places) ||
      !all_there(told.inboxes) || (purpose.serves && purpose.session == kEverySession))
    return refused(Outcome::kFromElsewhere);
  if (known != here_.end() && known->second.participant.purpose != purpose)
    return refused(Outcome::kOtherPurpose);

  Answer answer;
  answer.place = told.places.front();
  answer.is_new = known == here_.end() || known->second.left;
  if (answer.is_new && !is_room_for(purpose, from_ipv4)) return refused(Outcome::kFull);
  if (known == here_.end()) {
    known = here_.emplace(key, Here{{purpose, answer.place}, now_s, kAtOnce, true, {}}).first;
    ++hosts_[from_ipv4].participants;
    ++left_;
  }
  Here& here = known->second;
  here.credit = std::min(kAtOnce, here.credit + (now_s - here.heard_s) * kPerSecond);
  here.heard_s = now_s;
  if (here.credit < 1.0) return refused(Outcome::kTooOften);
  here.credit -= 1.0;
  if (here.left) {
    here.left = false;
    --left_;
    enter(key, purpose);
  }
  here.participant.place = answer.place;
  if (!pass_on(key, here, now_s, answer.to)) answer.outcome = Outcome::kTooOften;
  return answer;
}

std::vector<Introductions::Participant> Introductions::take_gone(double now_s) {
  std::vector<Participant> gone = std::move(gone_);
  gone_.clear();
  std::set<Key> forgotten;
  for (auto at = here_.begin(); at != here_.end();) {
    Here& here = at->second;
    if (now_s - here.heard_s <= kSilence_s) {
      ++at;
      continue;
    }
    if (here.left) {
      --left_;
    } else {
      leave(at->first, here.participant.purpose);
      gone.push_back(here.participant);
    }
    const auto host = hosts_.find(here.participant.place.ipv4);
    if (--host->second.participants == 0) hosts_.erase(host);
    forgotten.insert(at->first);
    at = here_.erase(at);
  }
  if (!forgotten.empty())
    for (auto& [key, here] : here_)
      std::erase_if(here.told, [&](const auto& told) { return forgotten.contains(told.first); });
  return gone;
}

}  // namespace mortise

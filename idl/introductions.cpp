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

void Introductions::add_places(const std::set<Key>& keys, const Key& but,
                               std::vector<UdpPlace>& to) const {
  for (const Key& key : keys)
    if (key != but) to.push_back(here_.at(key).participant.place);
}

Introductions::Answer Introductions::take(const Announcement& told, std::uint32_t from_ipv4,
                                          double now_s) {
  const auto known = here_.find(told.participant);
  if (known != here_.end() && known->second.participant.place.ipv4 != from_ipv4)
    return refused(Outcome::kFromElsewhere);
  if (told.leaves) {
    if (known == here_.end()) return refused(Outcome::kNoPurpose);
    leave(known->first, known->second.participant.purpose);
    left_.push_back(known->second.participant);
    here_.erase(known);
    return {};  // it says so itself to all that it has met
  }
  if (!told.purpose) return refused(Outcome::kNoPurpose);
  const Purpose& purpose = *told.purpose;
  const auto place = std::find_if(told.places.begin(), told.places.end(),
                                  [&](const UdpPlace& at) { return at.ipv4 == from_ipv4; });
  if (place == told.places.end() || (purpose.serves && purpose.session == kEverySession))
    return refused(Outcome::kFromElsewhere);

  Answer answer;
  if (known == here_.end()) {
    const auto members = sessions_.find(session_of(purpose));
    if (here_.size() >= kMost || (purpose.serves && members != sessions_.end() &&
                                  members->second.servers.size() >= kMostServers))
      return refused(Outcome::kFull);
    answer.is_new = true;
    here_[told.participant] = {{purpose, *place}, now_s, kAtOnce};
    enter(told.participant, purpose);
  }
  Here& here = here_[told.participant];
  if (here.participant.purpose != purpose) return refused(Outcome::kFromElsewhere);
  here.credit = std::min(kAtOnce, here.credit + (now_s - here.heard_s) * kPerSecond);
  here.heard_s = now_s;
  if (here.credit < 1.0) return refused(Outcome::kTooOften);
  here.credit -= 1.0;
  here.participant.place = answer.place = *place;

  if (!purpose.serves && purpose.session == kEverySession) {
    for (auto at = sessions_.lower_bound({purpose.domain, ""});
         at != sessions_.end() && at->first.first == purpose.domain; ++at)
      add_places(at->second.servers, told.participant, answer.to);
    return answer;
  }
  const Members& members = sessions_[session_of(purpose)];
  add_places(members.servers, told.participant, answer.to);
  if (!purpose.serves) return answer;
  add_places(members.clients, told.participant, answer.to);
  const auto lookers = sessions_.find({purpose.domain, kEverySession});
  if (lookers != sessions_.end()) add_places(lookers->second.clients, told.participant, answer.to);
  return answer;
}

std::vector<Introductions::Participant> Introductions::take_gone(double now_s) {
  std::vector<Participant> gone = std::move(left_);
  left_.clear();
  for (auto at = here_.begin(); at != here_.end();) {
    if (now_s - at->second.heard_s <= kSilence_s) {
      ++at;
      continue;
    }
    leave(at->first, at->second.participant.purpose);
    gone.push_back(at->second.participant);
    at = here_.erase(at);
  }
  return gone;
}

}  // namespace mortise

#include "client/web/away_users.h"

#include <algorithm>
#include <utility>

namespace mortise::web {

bool AwayUsers::keep(Away away) {
  if (away.page.empty() || !holds_parts(away.user)) return false;
  client_.set_away(away.user, true);
  away_.push_back(std::move(away));
  return true;
}

std::optional<LocalUser> AwayUsers::take_up(const Away& back) {
  const auto found = std::find_if(away_.begin(), away_.end(), [&](const Away& away) {
    return away.page == back.page && away.name == back.name && away.role == back.role;
  });
  if (found == away_.end()) return std::nullopt;
  const LocalUser user = found->user;
  away_.erase(found);
  client_.set_away(user, false);
  return user;
}

std::vector<AwayUsers::Away> AwayUsers::take_ended(const std::function<bool(const Away&)>& ends) {
  // Who has to join again, because the server is another one, is told soon what it holds.
  const auto stays = [&](const Away& away) {
    return !ends(away) &&
           (client_.join_state(away.user) == JoinState::kJoining || holds_parts(away.user));
  };
  const auto ended = std::stable_partition(away_.begin(), away_.end(), stays);
  std::vector<Away> gone(std::make_move_iterator(ended), std::make_move_iterator(away_.end()));
  away_.erase(ended, away_.end());
  return gone;
}

bool AwayUsers::holds_parts(LocalUser user) const {
  const UserId id = client_.user_id(user);
  const auto& parts = client_.parts();
  return id && std::any_of(parts.begin(), parts.end(),
                           [id](const auto& row) { return row.second.info.holder == id; });
}

}  // namespace mortise::web

#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/client.h"
#include "common/messages/role.h"

namespace mortise::web {

/// Users whose page has lost its line while they hold parts. They stay in the session, unheard, so
/// that its leases decide how long they keep what they hold; their page may come back by then.
class AwayUsers {
 public:
  struct Away {
    LocalUser user = 0;
    std::string name, page;  ///< page: see JoinWish
    Role role = Role::kUnknown;
  };

  /// The client must outlive this.
  explicit AwayUsers(Client& client) : client_(client) {}

  /// Fails for a user that holds nothing, and for a page that could not say who it is.
  bool keep(Away away);
  /// The user that this page had. It is heard again.
  std::optional<LocalUser> take_up(const Away& back);
  /// Takes out whom `ends` says, and those whose leases are over or who gave away all they held.
  std::vector<Away> take_ended(const std::function<bool(const Away&)>& ends);

 private:
  bool holds_parts(LocalUser user) const;

  Client& client_;
  std::vector<Away> away_;
};

}  // namespace mortise::web

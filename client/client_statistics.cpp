#include "client/client.h"

namespace mortise {

ClientStatistics Client::statistics() const {
  ClientStatistics statistics = statistics_;
  for (const LocalUserState& user : users_) {
    statistics.increments_repeated += user.unacknowledged.repeated();
    statistics.increments_given_up += user.unacknowledged.given_up();
  }
  return statistics;
}

}  // namespace mortise

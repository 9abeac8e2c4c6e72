#include "idl/server_readers.h"

#include <type_traits>
#include <utility>

#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

// A beat says that its user is there, and comes five times a second. Several are taken at once,
// half a beat late at most, so that most ticks need not look for them.
constexpr std::chrono::milliseconds kPresencePeriod{100};

}  // namespace

void ServerReaders::know(std::unique_ptr<PeerIdentities> identities) {
  identities_ = std::move(identities);
  doorman_.know(identities_.get());
}

void ServerReaders::open(Participant& participant, Status& status) {
  participant_ = &participant;
  participant.open_reader<wire::PresencePubSubType>(Topic::kPresence, &doorman_, presence_, status);
  participant.open_reader<wire::RequestPubSubType>(Topic::kRequest, nullptr, requests_, status);
  participant.open_reader<wire::IncrementBatchPubSubType>(Topic::kIncrement, nullptr, increments_,
                                                          status);
}

// Fast DDS reads revocations once, when it begins: who is revoked later it lets stay, and come
// back. Here they go.
void ServerReaders::turn_away(const Participant& participant, ServerInput& input) {
  if (!identities_) return;
  for (const ClientKey& key : identities_->newly_revoked()) {
    input.turned_away.push_back(identities_->whose(key) +
                                (present_.erase(key) > 0
                                     ? " has been revoked: what comes from there is dropped"
                                     : " was not let in: it has been revoked"));
    input.lost.push_back({UserId{}, key, false});
  }
  for (std::string& text : doorman_.take_turned_away())
    input.turned_away.push_back(std::move(text));
  counters_.turned_away += input.turned_away.size();
  doorman_.tell_repeats(participant.repeated(), input.turned_away);
}

void ServerReaders::take(ServerInput& input) {
  take_requests(input);
  take_presence(input);
  take_increments(input);
  take_departures(input);
}

template <class Sample, class Action>
void ServerReaders::take_each(dds::DataReader& reader, Action action) {
  take_all<Sample>(reader, [&](const Sample& sample,
                               const eprosima::fastrtps::rtps::GUID_t& writer) {
    ++counters_.received;
    const ClientKey key = client_key(writer);
    participant_->note_spoke(writer);
    if (!identities_ || !identities_->is_revoked(key)) return action(sample, key);
    ++counters_.foreign;
    // Who asks to come in is told. Of anything else nobody can be: whose user it names, is not
    // known.
    if constexpr (std::is_same_v<Sample, wire::Request>)
      refuse(sample, key,
             identities_->whose(key) + " has been revoked; ask for a new one (mortise keys issue)");
  });
}

void ServerReaders::take_requests(ServerInput& input) {
  take_each<wire::Request>(*requests_, [&](const wire::Request& sample, const ClientKey& key) {
    take_request(sample, key, input);
  });
}

void ServerReaders::take_request(const wire::Request& sample, const ClientKey& key,
                                 ServerInput& input) {
  Result<Request> request = from_wire(sample);
  if (!request) {
    ++counters_.malformed;
    return refuse(sample, key, request.error().text);
  }
  switch (request->kind) {
    case Request::Kind::kJoin:
      present_.insert(key);
      input.joins.push_back({key, request->nonce, request->name, request->role,
                             identities_ ? identities_->identity_of(key) : std::nullopt});
      break;
    case Request::Kind::kLeave:
      if (owns(key, request->command.user))
        input.lost.push_back({request->command.user, key, true});
      break;
    case Request::Kind::kCommand:
      input.commands.push_back({key, request->command});
      break;
    case Request::Kind::kUpload:
      input.pieces.push_back({key, std::move(request->piece)});
      break;
    case Request::Kind::kSnapshot:
      input.snapshot_requests.push_back(key);
      break;
    case Request::Kind::kUnknown:
      break;
  }
}

void ServerReaders::take_presence(ServerInput& input) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_presence_) return;
  next_presence_ = now + kPresencePeriod;
  take_each<wire::Presence>(*presence_, [&](const wire::Presence& sample, const ClientKey& key) {
    const UserId user{sample.user()};
    if (user && owns(key, user)) input.heartbeats.push_back(user);
  });
}

void ServerReaders::take_increments(ServerInput& input) {
  take_each<wire::IncrementBatch>(
      *increments_, [&](const wire::IncrementBatch& sample, const ClientKey& key) {
        Result<std::vector<ReceivedIncrement>> read = from_wire(sample);
        if (!read) {
          ++counters_.malformed;
          return;
        }
        for (ReceivedIncrement& received : read.value()) {
          counters_.malformed += received.at_door != Refusal::kNone && !received.repeated;
          received.client = key;
          input.increments.push_back(std::move(received));
        }
      });
}

// Last: who asked to join and is gone already does not get in, or would stay for ever. (One that
// lives after all asks again.)
void ServerReaders::take_departures(ServerInput& input) {
  for (const ClientKey& key : doorman_.take()) {
    // Only who has joined, and once: liveliness ends first, the participant's lease later.
    if (present_.erase(key) == 0) continue;
    std::erase_if(input.joins, [&](const JoinRequest& join) { return join.client == key; });
    input.lost.push_back({UserId{}, key, false});
  }
}

void ServerReaders::refuse(const wire::Request& sample, const ClientKey& key,
                           const std::string& text) {
  if (sample.join().size() != 1) return;
  writers_.say(JoinReply{key, sample.join()[0].nonce(), UserId{}, Refusal::kNotAllowed, text});
}

bool ServerReaders::owns(const ClientKey& client, UserId user) {
  const auto found = joined_.find(user);
  if (found != joined_.end() && found->second == client) return true;
  ++counters_.foreign;
  return false;
}

}  // namespace mortise

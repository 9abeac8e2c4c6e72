#include "common/messages/memory_channel.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <thread>
#include <utility>

namespace mortise {
namespace {

/// A queue whose messages may be lost, doubled, overtaken or late. Time is counted in take() calls
/// of the receiver.
template <class T>
class FaultyQueue {
 public:
  void push(const T& message, const MemoryFaults& faults, std::mt19937_64& random) {
    const auto chance = [&random](double p) {
      constexpr double kScale = 0x1p-53;  // 53 random bits to [0, 1)
      return p > 0.0 && static_cast<double>(random() >> 11) * kScale < p;
    };
    if (chance(faults.loss)) {
      ++lost_;
      return;
    }
    const int copies = chance(faults.duplicate) ? 2 : 1;
    for (int copy = 0; copy < copies; ++copy) {
      std::uint64_t due = takes_;
      if (faults.delay_takes > 0) {
        due += random() % (static_cast<std::uint64_t>(faults.delay_takes) + 1);
      }
      queue_.push_back({due, message});
      if (queue_.size() > 1 && chance(faults.reorder)) {
        std::swap(queue_.back(), queue_[queue_.size() - 2]);
      }
    }
  }

  std::vector<T> take() {
    std::vector<T> due;
    std::vector<Entry> later;
    for (Entry& entry : queue_) {
      if (entry.due <= takes_) {
        due.push_back(std::move(entry.message));
      } else {
        later.push_back(std::move(entry));
      }
    }
    queue_ = std::move(later);
    ++takes_;
    return due;
  }

  void clear() { queue_.clear(); }
  std::uint64_t lost() const { return lost_; }

 private:
  struct Entry {
    std::uint64_t due = 0;
    T message;
  };
  std::vector<Entry> queue_;
  std::uint64_t takes_ = 0, lost_ = 0;
};

struct ClientBox {
  ClientInput reliable;
  FaultyQueue<PoseBatch> poses;
  FaultyQueue<ClashEvent> events;
  ChannelCounters counters;
  bool alive = true;
};

}  // namespace

struct MemoryHub::State {
  std::mutex mutex;
  MemoryFaults up, down;
  std::mt19937_64 random_up, random_down;
  std::uint64_t incarnation = 0;  ///< of the server; 0: none yet
  bool server_present = false;
  ServerInput reliable;
  FaultyQueue<std::vector<ReceivedIncrement>> increments;  ///< by datagram
  ChannelCounters counters;
  std::map<UserId, ClientKey> joined;
  std::optional<Snapshot> snapshot;
  std::vector<MeshBytes> meshes;
  std::optional<FeatureTable> features;
  std::map<ClientKey, ClientBox> clients;
  std::uint64_t clients_opened = 0;

  void lose_server() {
    server_present = false;
    reliable = {};
    increments.clear();
    joined.clear();
    snapshot.reset();
    meshes.clear();
    features.reset();
    for (auto& [key, box] : clients) {
      box.reliable = {};
      box.poses.clear();
      box.events.clear();
      box.reliable.server_lost = true;
    }
  }

  void greet(ClientBox& box) const {
    if (snapshot) box.reliable.snapshots = {*snapshot};
    box.reliable.meshes = meshes;
    if (features) box.reliable.features = {*features};
  }

  /// Null when the client was killed: what it sends goes nowhere.
  ClientBox* living(const ClientKey& key) {
    const auto found = clients.find(key);
    return found != clients.end() && found->second.alive ? &found->second : nullptr;
  }

  bool owns(const ClientKey& key, UserId user) {
    const auto found = joined.find(user);
    if (found != joined.end() && found->second == key) return true;
    ++counters.foreign;
    return false;
  }
};

namespace {

using StatePtr = std::shared_ptr<MemoryHub::State>;

class MemoryServer final : public ServerChannel {
 public:
  explicit MemoryServer(StatePtr state) : state_(std::move(state)) {
    const std::lock_guard lock(state_->mutex);
    if (state_->incarnation != 0) state_->lose_server();
    incarnation_ = ++state_->incarnation;
    state_->server_present = true;
  }
  ~MemoryServer() override {
    const std::lock_guard lock(state_->mutex);
    if (current()) state_->lose_server();
  }

  ServerInput take() override {
    const std::lock_guard lock(state_->mutex);
    if (!current()) return {};
    ServerInput input = std::exchange(state_->reliable, {});
    for (std::vector<ReceivedIncrement>& datagram : state_->increments.take()) {
      std::move(datagram.begin(), datagram.end(), std::back_inserter(input.increments));
    }
    state_->counters.received += input.increments.size() + input.commands.size() +
                                 input.joins.size() + input.heartbeats.size();
    state_->counters.lost = state_->increments.lost();
    return input;
  }

  void publish_join_reply(const JoinReply& reply) override {
    const std::lock_guard lock(state_->mutex);
    if (!current()) return;
    if (reply.user && reply.refusal == Refusal::kNone) state_->joined[reply.user] = reply.client;
    if (ClientBox* box = state_->living(reply.client)) box->reliable.join_replies.push_back(reply);
  }
  void publish_replies(std::span<const Reply> replies) override {
    each([&](ClientBox& box) {
      box.reliable.replies.insert(box.reliable.replies.end(), replies.begin(), replies.end());
    });
  }
  void publish_decisions(std::span<const Decision> decisions) override {
    each([&](ClientBox& box) {
      box.reliable.decisions.insert(box.reliable.decisions.end(), decisions.begin(),
                                    decisions.end());
    });
  }
  void publish_standing(std::span<const StandingChange> changes) override {
    each([&](ClientBox& box) {
      box.reliable.standing.insert(box.reliable.standing.end(), changes.begin(), changes.end());
    });
  }
  void publish_refusals(std::span<const RefusedIncrement> refused) override {
    each([&](ClientBox& box) {
      box.reliable.refused.insert(box.reliable.refused.end(), refused.begin(), refused.end());
    });
  }
  void publish_uploads(std::span<const UploadState> uploads) override {
    each([&](ClientBox& box) {
      box.reliable.uploads.insert(box.reliable.uploads.end(), uploads.begin(), uploads.end());
    });
  }
  void publish_poses(const PoseBatch& batch) override {
    each([&](ClientBox& box) {
      const std::uint64_t lost = box.poses.lost();
      box.poses.push(batch, state_->down, state_->random_down);
      box.reliable.poses_missed += box.poses.lost() - lost;
    });
  }
  void publish_events(std::span<const ClashEvent> events) override {
    each([&](ClientBox& box) {
      for (const ClashEvent& event : events) {
        box.events.push(event, state_->down, state_->random_down);
      }
    });
  }
  void publish_snapshot(Snapshot snapshot) override {
    each([&](ClientBox& box) { box.reliable.snapshots = {snapshot}; });
    const std::lock_guard lock(state_->mutex);
    if (current()) state_->snapshot = std::move(snapshot);
  }
  void publish_mesh(const std::string& hash, std::span<const std::byte> bytes) override {
    const MeshBytes mesh{hash, {bytes.begin(), bytes.end()}};
    each([&](ClientBox& box) { box.reliable.meshes.push_back(mesh); });
    const std::lock_guard lock(state_->mutex);
    if (current()) state_->meshes.push_back(mesh);
  }
  void publish_coming_mesh(const std::string& hash, std::span<const std::byte> bytes) override {
    publish_mesh(hash, bytes);
  }
  void publish_features(const FeatureTable& table) override {
    each([&](ClientBox& box) { box.reliable.features = {table}; });
    const std::lock_guard lock(state_->mutex);
    if (current()) state_->features = table;
  }
  void publish_pulse(const SessionPulse& pulse) override {
    each([&](ClientBox& box) { box.reliable.pulses = {pulse}; });
  }
  bool has_readers() const override {
    const std::lock_guard lock(state_->mutex);
    return current() && std::any_of(state_->clients.begin(), state_->clients.end(),
                                    [](const auto& entry) { return entry.second.alive; });
  }
  ChannelCounters counters() const override {
    const std::lock_guard lock(state_->mutex);
    return state_->counters;
  }

 private:
  bool current() const { return state_->incarnation == incarnation_; }

  template <class Action>
  void each(Action action) {
    const std::lock_guard lock(state_->mutex);
    if (!current()) return;
    for (auto& [key, box] : state_->clients) {
      if (box.alive) action(box);
    }
  }

  StatePtr state_;
  std::uint64_t incarnation_ = 0;
};

class MemoryClient final : public ClientChannel {
 public:
  MemoryClient(StatePtr state, ClientKey key) : state_(std::move(state)), key_(std::move(key)) {}
  ~MemoryClient() override {
    const std::lock_guard lock(state_->mutex);
    if (state_->living(key_)) state_->reliable.lost.push_back({UserId{}, key_, false});
    state_->clients.erase(key_);
  }

  void join(std::uint64_t nonce, const std::string& name, const std::string& role) override {
    up([&](ServerInput& input) { input.joins.push_back({key_, nonce, name, role}); });
  }
  void leave(UserId user) override {
    up([&](ServerInput& input) {
      if (state_->owns(key_, user)) input.lost.push_back({user, key_, true});
    });
  }
  void heartbeat(UserId user) override {
    up([&](ServerInput& input) {
      if (state_->owns(key_, user)) input.heartbeats.push_back(user);
    });
  }
  void send(const IncrementBatch& batch) override {
    std::vector<ReceivedIncrement> datagram;
    for (const auto& [increment, sent_ns] : batch.increments) {
      datagram.push_back({key_, increment, sent_ns, batch.kept_from,
                          increment.seq < batch.fresh_from, Refusal::kNone});
    }
    up([&](ServerInput&) { state_->increments.push(datagram, state_->up, state_->random_up); });
  }
  void send(const Command& command) override {
    up([&](ServerInput& input) { input.commands.push_back({key_, command}); });
  }
  void send(const UploadPiece& piece) override {
    up([&](ServerInput& input) { input.pieces.push_back({key_, piece}); });
  }
  void request_snapshot() override {
    up([&](ServerInput& input) { input.snapshot_requests.push_back(key_); });
  }
  ClientInput take() override {
    const std::lock_guard lock(state_->mutex);
    ClientBox* box = state_->living(key_);
    if (box == nullptr) return {};
    ClientInput input = std::exchange(box->reliable, {});
    input.poses = box->poses.take();
    input.events = box->events.take();
    input.server_present = state_->server_present;
    box->counters.received += input.poses.size() + input.events.size() + input.replies.size() +
                              input.snapshots.size() + input.join_replies.size();
    box->counters.lost = box->poses.lost() + box->events.lost();
    return input;
  }
  /// There is none to ring: whoever waits looks once a millisecond.
  void await_input(std::int64_t at_most_ns) override {
    constexpr std::int64_t kLook_ns = 1'000'000;  // far below a tick of 60 Hz
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(at_most_ns, kLook_ns)));
  }
  ChannelCounters counters() const override {
    const std::lock_guard lock(state_->mutex);
    const ClientBox* box = state_->living(key_);
    return box == nullptr ? ChannelCounters{} : box->counters;
  }

 private:
  template <class Action>
  void up(Action action) {
    const std::lock_guard lock(state_->mutex);
    if (state_->server_present && state_->living(key_) != nullptr) action(state_->reliable);
  }

  StatePtr state_;
  ClientKey key_;
};

}  // namespace

MemoryHub::MemoryHub(const MemoryFaults& up, const MemoryFaults& down)
    : state_(std::make_shared<State>()) {
  state_->up = up;
  state_->down = down;
  state_->random_up.seed(up.seed);
  state_->random_down.seed(down.seed ^ 0x9e3779b97f4a7c15u);  // another stream than up
}

std::unique_ptr<ServerChannel> MemoryHub::open_server() {
  return std::make_unique<MemoryServer>(state_);
}

std::unique_ptr<ClientChannel> MemoryHub::open_client() {
  const std::lock_guard lock(state_->mutex);
  const ClientKey key = "memory-" + std::to_string(++state_->clients_opened);
  state_->greet(state_->clients[key]);
  return std::make_unique<MemoryClient>(state_, key);
}

void MemoryHub::kill(const ClientKey& client) {
  const std::lock_guard lock(state_->mutex);
  if (ClientBox* box = state_->living(client)) {
    box->alive = false;
    state_->reliable.lost.push_back({UserId{}, client, false});
  }
}

ClientKey MemoryHub::last_client() const {
  const std::lock_guard lock(state_->mutex);
  return "memory-" + std::to_string(state_->clients_opened);
}

}  // namespace mortise

#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "common/messages/channel.h"

namespace mortise::test {

/// All that a client was told of poses, with the changes of servers between.
class Overheard final : public ClientChannel {
 public:
  struct Word {
    int server = 0;  ///< how often it was changed before
    std::uint64_t tick = 0;
    PartId part;
    Pose X_WP;
  };
  explicit Overheard(std::unique_ptr<ClientChannel> inner) : inner_(std::move(inner)) {}
  const std::vector<Word>& words() const { return words_; }
  int servers() const { return server_ + 1; }

  ClientInput take() override {
    ClientInput input = inner_->take();
    server_ += input.server_lost;
    for (const Snapshot& snapshot : input.snapshots)
      for (const PartInfo& part : snapshot.parts)
        words_.push_back({server_, snapshot.tick, part.part, part.X_WP});
    for (const PoseBatch& batch : input.poses)
      for (const PartPose& part : batch.parts)
        words_.push_back({server_, batch.tick, part.part, part.X_WP});
    return input;
  }
  void join(std::uint64_t nonce, const std::string& name, const std::string& role) override {
    inner_->join(nonce, name, role);
  }
  void leave(UserId user) override { inner_->leave(user); }
  void heartbeat(UserId user) override { inner_->heartbeat(user); }
  void send(const IncrementBatch& batch) override { inner_->send(batch); }
  void send(const Command& command) override { inner_->send(command); }
  void send(const UploadPiece& piece) override { inner_->send(piece); }
  void request_snapshot() override { inner_->request_snapshot(); }
  void await_input(std::int64_t at_most_ns) override { inner_->await_input(at_most_ns); }
  ChannelCounters counters() const override { return inner_->counters(); }

 private:
  std::unique_ptr<ClientChannel> inner_;
  std::vector<Word> words_;
  int server_ = 0;
};

}  // namespace mortise::test

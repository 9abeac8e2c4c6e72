#include "client/bot/people.h"

#include <algorithm>
#include <utility>

namespace mortise {
namespace {

constexpr double kAnswer_s = 0.5;  // an answer takes a tick and a round trip; then ask again
// After a stall a hand goes on from where it was, not from where it would have been.
constexpr double kLongestBeat_s = 0.05;

std::vector<PartId> moving_parts(const View& view) {
  std::vector<PartId> moving;
  for (const auto& [id, part] : *view.parts)
    if (part.info.moving) moving.push_back(id);
  return moving;
}

/// Leads a held part along a path.
class Hand {
 public:
  explicit Hand(std::unique_ptr<Path> path) : path_(std::move(path)) {}
  void take(const View& view, PartId part) {
    held_s_ = 0.0;
    path_->begin(view, *view.find(part));
    last_ = path_->at(0.0);
  }
  void lead(const View& view, PartId part, Wish& wish) {
    held_s_ += std::min(view.beat_s, kLongestBeat_s);
    const Offset next = path_->at(held_s_);
    wish.move = part;
    wish.translation_mm = next.translation_mm - last_.translation_mm;
    wish.rotation_rad = next.rotation_rad - last_.rotation_rad;
    last_ = next;
  }
  double held_s() const { return held_s_; }

 private:
  std::unique_ptr<Path> path_;
  double held_s_ = 0.0;
  Offset last_;
};

class Share : public Behaviour {
 public:
  Share(const ShareSettings& settings, std::unique_ptr<Path> path)
      : settings_(settings), hand_(std::move(path)) {}

  Wish beat(const View& view) override {
    Wish wish;
    const std::vector<PartId> moving = moving_parts(view);
    if (moving.empty()) return wish;
    const PartId part = settings_.only ? settings_.only : moving.front();
    if (!view.holds(part)) {
      holding_ = false;
      want(view, part, wish);
      return wish;
    }
    if (!std::exchange(holding_, true)) {
      hand_.take(view, part);
      declines_ = settings_.hesitates ? 1 : 0;
      return wish;
    }
    hand_.lead(view, part, wish);
    if (hand_.held_s() >= settings_.hold_s) answer(view, part, wish);
    return wish;
  }

 private:
  void want(const View& view, PartId part, Wish& wish) {
    if (view.time_s - asked_s_ < kAnswer_s) return;
    asked_s_ = view.time_s;
    const KnownPart* known = view.find(part);
    if (known != nullptr && known->info.holder)
      wish.asks.push_back({CommandKind::kAskHandOver, part});
    else
      wish.grab = part;
  }
  void answer(const View& view, PartId part, Wish& wish) {
    const bool asked =
        view.standing != nullptr &&
        std::any_of(view.standing->begin(), view.standing->end(), [part](const Decision& ask) {
          return ask.kind == Decision::Kind::kAskHandOver && ask.part == part;
        });
    if (!asked || view.time_s - answered_s_ < kAnswer_s) return;
    answered_s_ = view.time_s;
    const bool declines = declines_ > 0;
    if (declines) --declines_;
    wish.asks.push_back({declines ? CommandKind::kDecline : CommandKind::kConsent, part});
  }

  ShareSettings settings_;
  Hand hand_;
  double asked_s_ = -1e9, answered_s_ = -1e9;
  bool holding_ = false;
  int declines_ = 0;
};

class Revise : public Behaviour {
 public:
  Revise(std::size_t first, PartId only, std::unique_ptr<Path> path)
      : first_(first), only_(only), hand_(std::move(path)) {}

  Wish beat(const View& view) override {
    // Long enough for a part to be moved, short enough that all get a turn within a test of
    // seconds.
    constexpr double kLead_s = 1.0;
    Wish wish;
    const std::vector<PartId> moving = moving_parts(view);
    if (moving.empty()) return wish;
    const PartId part = only_ ? only_ : moving[first_ % moving.size()];
    switch (stage_) {
      case Stage::kGrab:
        if (view.holds(part)) {
          hand_.take(view, part);
          stage_ = Stage::kLead;
        } else if (is_time(view)) {
          wish.grab = part;
        }
        break;
      case Stage::kLead:
        if (!view.holds(part)) {
          stage_ = Stage::kGrab;
          break;
        }
        hand_.lead(view, part, wish);
        if (hand_.held_s() < kLead_s) break;
        wish.release = part;
        done_s_ = view.time_s;
        stage_ = Stage::kUndo;
        break;
      case Stage::kUndo:
      case Stage::kRedo:
        if (!is_time(view)) break;
        wish.asks.push_back(
            {stage_ == Stage::kUndo ? CommandKind::kUndo : CommandKind::kRedo, part});
        stage_ = stage_ == Stage::kUndo ? Stage::kRedo : Stage::kGrab;
        break;
    }
    return wish;
  }

 private:
  enum class Stage { kGrab, kLead, kUndo, kRedo };
  bool is_time(const View& view) {
    if (view.time_s - done_s_ < kAnswer_s) return false;
    done_s_ = view.time_s;
    return true;
  }

  std::size_t first_;
  PartId only_;
  Hand hand_;
  Stage stage_ = Stage::kGrab;
  double done_s_ = -1e9;
};

class Reviewer : public Behaviour {
 public:
  explicit Reviewer(std::unique_ptr<Behaviour> hands) : hands_(std::move(hands)) {}

  Wish beat(const View& view) override {
    // A review a second, as a person who reads it.
    constexpr double kPause_s = 1.0;
    Wish wish = hands_->beat(view);
    if (view.clashes == nullptr || view.clashes->empty()) return wish;
    if (view.time_s - reviewed_s_ < kPause_s) return wish;
    reviewed_s_ = view.time_s;
    const auto clash = std::next(view.clashes->begin(),
                                 static_cast<std::ptrdiff_t>(turn_++ % view.clashes->size()));
    const auto now = static_cast<std::uint8_t>(clash->second.review.status);
    Details details;
    details.clash = clash->first;
    details.status = static_cast<ReviewStatus>((now + 1) % kReviewStatusCount);
    wish.asks.push_back({CommandKind::kReview, PartId{}, std::move(details)});
    return wish;
  }
  const std::vector<std::string>& troubles() const override { return hands_->troubles(); }

 private:
  std::unique_ptr<Behaviour> hands_;
  double reviewed_s_ = 0.0;
  std::size_t turn_ = 0;
};

}  // namespace

std::unique_ptr<Behaviour> make_share(const ShareSettings& settings, std::unique_ptr<Path> path) {
  return std::make_unique<Share>(settings, std::move(path));
}

std::unique_ptr<Behaviour> make_revise(std::size_t first, PartId only, std::unique_ptr<Path> path) {
  return std::make_unique<Revise>(first, only, std::move(path));
}

std::unique_ptr<Behaviour> make_reviewer(std::unique_ptr<Behaviour> hands) {
  return std::make_unique<Reviewer>(std::move(hands));
}

}  // namespace mortise

#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "client/web/feed.h"
#include "client/web/recording.h"

namespace mortise::web {

/// A logged session, for any number of pages; each has a timeline of its own and can jump in it.
class ReplayFeed final : public Feed {
 public:
  explicit ReplayFeed(Recording recording) : recording_(std::move(recording)) {}

  const char* mode() const override { return "replay"; }
  void enter(Viewer& viewer) override;
  void leave(Viewer& viewer) override { cursors_.erase(&viewer); }
  Status take(Viewer& viewer, const PageMessage& message) override;
  void turn(double now_s) override;
  SharedBytes frame(const Viewer& viewer, const std::vector<PartId>& parts) const override;
  MeshAnswer mesh(const std::string& hash) const override;
  std::string trouble() const override { return {}; }
  Json statistics() const override;

 private:
  /// Where a page is.
  struct Cursor {
    std::uint64_t tick = 0;
    double ahead = 0.0;  ///< played beyond `tick`, in ticks
    double speed = 1.0;
    bool playing = false;
    double told_s = 0.0;
    std::vector<ClashEvent> open;  ///< clashes, as after `tick`
    ClassBits classes;
  };
  void steer(Viewer& viewer, Cursor& cursor, const ReplayWish& wish);
  void show(Viewer& viewer, Cursor& cursor, std::uint64_t tick);
  void play_to(Viewer& viewer, Cursor& cursor, std::uint64_t tick);
  std::vector<PartId> take_events(Viewer& viewer, Cursor& cursor, std::uint64_t to);
  void tell_decisions(Viewer& viewer, std::uint64_t from, std::uint64_t to) const;
  void tell(Viewer& viewer, Cursor& cursor) const;
  SharedBytes frame_at(const Cursor& cursor, const std::vector<PartId>& parts) const;

  Recording recording_;
  std::map<Viewer*, Cursor, std::less<>> cursors_;
  double now_s_ = 0.0;
};

}  // namespace mortise::web

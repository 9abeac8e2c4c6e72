#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/client.h"
#include "client/web/away_users.h"
#include "client/web/feed.h"
#include "client/web/limits.h"
#include "client/web/page_uploads.h"

namespace mortise::web {

/// The pages of a running session, each with the user that it has joined as: what a page asks for
/// goes to the client, and each page hears the answers to its own requests.
class PageSeats {
 public:
  /// The client must outlive this.
  PageSeats(Client& client, const Limits& limits, ReadAssembly read_step)
      : client_(client), limits_(limits), uploads_(client, limits, std::move(read_step)) {}

  void enter(Viewer& viewer) { seats_[&viewer]; }
  void leave(Viewer& viewer);  ///< its user leaves as well
  /// Its line broke: its user keeps what it holds while its leases last, for the page to come back.
  void lose(Viewer& viewer);
  /// Fails with a sentence for the page when this cannot be meant.
  Status take(Viewer& viewer, const PageMessage& message);

  /// At the begin of a turn, by a clock that never goes back.
  void begin_turn(double now_s);
  void tell_joins(const ClientUpdate& update);
  void tell_replies(const ClientUpdate& update);
  /// At the end of a turn: refused increments, the pulse, and where people look from.
  void end_turn(const ClientUpdate& update);
  /// The server is gone: open commands get no answer.
  void forget_answers();
  void tell_all(const Json& json);

  template <class Action>
  void each(Action action) {
    for (auto& [viewer, seat] : seats_) action(*viewer);
  }
  PageUploads& uploads() { return uploads_; }
  const PageUploads& uploads() const { return uploads_; }
  bool empty() const { return seats_.empty(); }
  std::uint64_t foreign_names() const { return foreign_names_; }

 private:
  struct Seat {
    std::optional<LocalUser> user;
    std::string name;
    std::string page;        ///< see JoinWish
    double rejoin_s = 0.0;   ///< a join was refused: time of the next attempt; 0: none
    double give_up_s = 0.0;  ///< end of these attempts
    std::map<std::uint64_t, std::uint64_t> asked;  ///< sequence of a command to the page's id
    std::map<std::pair<PartId, Refusal>, std::uint64_t> refused;  ///< increments, not said yet
    std::vector<double> latency_ms;                               ///< since the last pulse
    std::optional<Json> view;                                     ///< not told on yet
    double refused_said_s = 0.0;
  };

  using Row = std::pair<Viewer* const, Seat>;

  void join(Viewer& viewer, Seat& seat, const JoinWish& wish);
  void move(Viewer& viewer, Seat& seat, const MoveWish& wish);
  void upload(Viewer& viewer, Seat& seat, const UploadWish& wish);
  void command(Viewer& viewer, Seat& seat, const CommandWish& wish);
  static void refuse(Viewer& viewer, const CommandWish& wish, Refusal refusal,
                     const std::string& text);
  bool take_up(Viewer& viewer, Seat& seat);
  void set_aside(const Viewer& viewer, Seat& seat);
  void end_away(const std::string& name);
  void go(LocalUser user, const std::string& name);
  void tell_refusals();
  void tell_pulse(const ClientUpdate& update);
  void tell_views();
  Row* seat_of(LocalUser user);
  Row* seat_of(UserId user);

  Client& client_;
  Limits limits_;
  PageUploads uploads_;
  AwayUsers away_{client_};
  std::map<Viewer*, Seat> seats_;
  std::uint64_t foreign_names_ = 0;       ///< joins under another name than that of the token
  std::map<std::string, double> left_s_;  ///< names that left lately, and when
  double now_s_ = 0.0, views_said_s_ = 0.0;
};

}  // namespace mortise::web

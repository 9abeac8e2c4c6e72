#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/web/feed.h"
#include "client/web/limits.h"
#include "client/web/mesh_store.h"

namespace mortise::web {

/// A running session, for any number of pages. One client of the session with a user for each page
/// that joined: the server sends everything once, however many look on, and a page that goes away
/// leaves at once, without waiting for a lease.
class LiveFeed final : public Feed {
 public:
  /// The client must outlive the feed; nobody else polls it.
  LiveFeed(Client& client, const Limits& limits) : client_(client), limits_(limits) {}

  const char* mode() const override { return "live"; }
  void enter(Viewer& viewer) override;
  void leave(Viewer& viewer) override;
  Status take(Viewer& viewer, const PageMessage& message) override;
  void turn(double now_s) override;
  SharedBytes frame(const Viewer& viewer, const std::vector<PartId>& parts) const override;
  MeshAnswer mesh(const std::string& hash) const override { return meshes_.find(hash); }
  std::string trouble() const override;
  Json statistics() const override;

 private:
  /// The state of a page.
  struct Seat {
    std::optional<LocalUser> user;
    std::string name;
    double rejoin_s = 0.0;   ///< a join was refused: time of the next attempt; 0: none
    double give_up_s = 0.0;  ///< end of these attempts
    std::map<std::uint64_t, std::uint64_t> asked;  ///< sequence of a command to the page's id
    std::map<std::pair<PartId, Refusal>, std::uint64_t> refused;  ///< increments, not said yet
    std::vector<double> latency_ms;                               ///< since the last pulse
    std::optional<Json> view;                                     ///< not told on yet
    double refused_said_s = 0.0;
  };

  void join(Viewer& viewer, Seat& seat, const JoinWish& wish);
  void move(Viewer& viewer, Seat& seat, const MoveWish& wish);
  void command(Viewer& viewer, Seat& seat, const CommandWish& wish);
  void refuse(Viewer& viewer, const CommandWish& wish, Refusal refusal, const std::string& text);
  void tell_all(const Json& json);
  void tell_server();
  void tell_joins(const ClientUpdate& update);
  void tell_replies(const ClientUpdate& update);
  void tell_decisions(const ClientUpdate& update);
  void tell_changes(const ClientUpdate& update);
  void tell_refusals();
  void tell_pulse(const ClientUpdate& update);
  void tell_views();
  void forget_answers();
  void take_meshes(const ClientUpdate& update);
  SharedBytes scene();
  std::vector<PartId> with_changed_classes(const ClientUpdate& update);
  SharedBytes frame_of(const std::vector<PartId>& parts) const;
  std::pair<Viewer* const, Seat>* seat_of(LocalUser user);
  std::pair<Viewer* const, Seat>* seat_of(UserId user);

  Client& client_;
  Limits limits_;
  std::map<Viewer*, Seat> seats_;
  std::uint64_t foreign_names_ = 0;  ///< joins under another name than the token is bound to
  MeshStore meshes_;
  ClassBits classes_;
  std::map<std::string, double> left_s_;  ///< names that left lately, and when
  bool present_ = false;                  ///< the server, as last told
  bool has_scene_ = false;
  double now_s_ = 0.0, views_said_s_ = 0.0;
};

}  // namespace mortise::web

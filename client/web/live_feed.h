#pragma once
#include <string>
#include <vector>

#include "client/client.h"
#include "client/web/feed.h"
#include "client/web/limits.h"
#include "client/web/mesh_store.h"
#include "client/web/page_seats.h"

namespace mortise::web {

/// A running session, for any number of pages. One client of the session with a user for each page
/// that joined: the server sends everything once, however many look on, and a page that goes away
/// leaves at once, without waiting for a lease.
class LiveFeed final : public Feed {
 public:
  /// The client must outlive the feed; nobody else polls it. `read_step` may be empty: no STEP
  /// files are taken.
  LiveFeed(Client& client, const Limits& limits, ReadAssembly read_step = {})
      : client_(client), seats_(client, limits, std::move(read_step)) {}

  const char* mode() const override { return "live"; }
  void enter(Viewer& viewer) override;
  void leave(Viewer& viewer) override { seats_.leave(viewer); }
  void lose(Viewer& viewer) override { seats_.lose(viewer); }
  Status take(Viewer& viewer, const PageMessage& message) override {
    return seats_.take(viewer, message);
  }
  void turn(double now_s) override;
  std::optional<std::size_t> begin_file(const std::string& ticket) override {
    return seats_.uploads().begin_file(ticket);
  }
  bool awaits_file(const std::string& ticket) const override {
    return seats_.uploads().awaits_file(ticket);
  }
  Status take_file(const std::string& ticket, std::vector<std::byte> bytes) override {
    return seats_.uploads().take_file(ticket, std::move(bytes));
  }
  void drop_file(const std::string& ticket) override { seats_.uploads().drop_file(ticket); }
  SharedBytes frame(const Viewer& viewer, const std::vector<PartId>& parts) const override;
  MeshAnswer mesh(const std::string& hash) const override { return meshes_.find(hash); }
  std::string trouble() const override;
  Json statistics() const override;

 private:
  void tell_server();
  void tell_decisions(const ClientUpdate& update);
  void tell_changes(const ClientUpdate& update);
  void take_meshes(const ClientUpdate& update);
  SharedBytes scene();
  std::vector<PartId> with_changed_classes(const ClientUpdate& update);
  SharedBytes frame_of(const std::vector<PartId>& parts) const;

  Client& client_;
  PageSeats seats_;
  MeshStore meshes_;
  ClassBits classes_;
  bool present_ = false;  ///< the server, as last told
  bool has_scene_ = false;
};

}  // namespace mortise::web

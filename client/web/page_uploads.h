#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/client.h"
#include "client/web/feed.h"
#include "client/web/limits.h"
#include "client/web/step_uploads.h"

namespace mortise::web {

/// Mesh and STEP files of pages. A page asks over its WebSocket, gets a ticket that counts once,
/// and sends the bytes by HTTP under that ticket; from here they go to the server as its user's
/// upload.
class PageUploads {
 public:
  /// The client must outlive this.
  PageUploads(Client& client, const Limits& limits, ReadAssembly read_step)
      : client_(client), limits_(limits), step_(client, std::move(read_step)) {}

  /// Answers the page with a ticket or a refusal.
  void ask(Viewer& viewer, LocalUser user, const UploadWish& wish, double now_s);
  static void refuse(Viewer& viewer, std::uint64_t id, Refusal refusal, const std::string& text);
  void leave(Viewer& viewer);
  /// Drops what did not come in time, and goes on with STEP files.
  void turn(double now_s);

  /// See Feed.
  std::optional<std::size_t> begin_file(const std::string& ticket);
  bool awaits_file(const std::string& ticket) const { return tickets_.contains(ticket); }
  Status take_file(const std::string& ticket, std::vector<std::byte> bytes);
  void drop_file(const std::string& ticket);

  void tell(const std::vector<UploadState>& states);

 private:
  struct Ticket {
    Viewer* viewer = nullptr;
    LocalUser user = 0;
    UploadWish wish;
    double until_s = 0.0;
    bool begun = false;  ///< its bytes are on their way
  };
  struct Sent {
    Viewer* viewer = nullptr;
    std::uint64_t id = 0;
  };

  Client& client_;
  Limits limits_;
  StepUploads step_;
  std::map<std::string, Ticket> tickets_;
  std::map<std::uint64_t, Sent> sent_;  ///< by the client's number of the upload
};

}  // namespace mortise::web

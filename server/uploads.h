#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/channel.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/world.h"
#include "server/intake.h"
#include "server/part_maker.h"
#include "server/tick_bytes.h"

namespace mortise {

/// Mesh files that users send, until parts can be made of them. On the tick thread pieces are only
/// collected; PartMaker does the rest.
class Uploads {
 public:
  explicit Uploads(const InboxLimits& limits) : limits_(limits) {}

  /// How meshes get to clients, and how many threads judge the parts; see PartMaker.
  void publish_with(PartMaker::Publish publish, int threads) {
    publish_ = std::move(publish);
    threads_ = threads;
  }
  /// Is there a server that stands by, and has one just come? It gets each mesh before the decision
  /// that names it.
  void note_follower(bool is_there, bool has_come);

  /// A piece of a user who is present.
  void receive(UploadPiece piece, World& world);
  void drop(UserId user);  ///< a user who has left
  /// Puts what was made at the world's disposal, and tells how far everybody is.
  void settle(World& world, Intake& intake);

  /// The mesh that an edit names.
  struct Mesh {
    enum class Is : std::uint8_t { kUnknown = 0, kComing, kHere, kUnusable };
    Is is = Is::kUnknown;
    std::string hash;  ///< kHere: of the mesh
    std::string text;  ///< kHere: what was found in its file; kUnusable: why
  };
  /// `name`: of the bytes of a file that the user has sent, or of a mesh of the session. One that
  /// can be made usable is, from now on.
  Mesh find(UserId user, const std::string& name, World& world);
  /// The same of a mesh of the session that is to be that part.
  Mesh find(const std::string& mesh_hash, const PartShapes::AsPart& as, World& world);
  /// A decision has named the mesh: it is in the log from now on.
  void note_used(const std::string& mesh_hash);

  /// What the one that stands by is told in this tick; none: nothing.
  std::optional<MeshPiece> next_piece();

 private:
  using Key = std::pair<UserId, std::uint64_t>;  ///< user and number of an upload
  struct Upload {
    UploadPiece head;                            ///< name, unit, hash, length
    std::vector<std::vector<std::byte>> pieces;  ///< of the file, in order
    std::uint64_t received = 0;
    std::uint64_t tick_bytes = 0;  ///< received in this tick
    bool is_new = true;            ///< its state, since it was told
    UploadState state;
    bool is_open() const { return state.refusal == Refusal::kNone && !state.ready; }
  };
  /// A mesh on its way to the one that stands by.
  struct Telling {
    std::string hash;
    double quantum_mm = 0.0;
    std::shared_ptr<const std::vector<std::byte>> bytes;
    std::uint64_t told = 0;
  };

  Upload* begin(const UploadPiece& piece, const World& world);
  std::string why_not(const UploadPiece& piece, const World& world, Refusal& refusal) const;
  void end(Upload& upload, Refusal refusal, std::string text);
  void finish(const Key& key, Upload& upload, World& world);
  void take_made(PartMaker::Made& made, World& world);
  PartMaker& maker(const World& world);
  void drop_file(Upload& upload);
  /// Does the one that stands by have it, or need it?
  bool is_told(const std::string& mesh_hash);

  const InboxLimits& limits_;
  PartMaker::Publish publish_;
  int threads_ = 1;
  std::unique_ptr<PartMaker> maker_;  ///< once it is needed
  std::map<Key, Upload> uploads_;
  std::map<UserId, std::uint64_t> bytes_of_;   ///< that each user has sent or announced
  std::set<std::string> making_;               ///< keys of wishes: meshes of the session
  std::map<std::string, std::string> failed_;  ///< why, by key of the wish
  bool has_follower_ = false;
  std::set<std::string> used_, told_;      ///< meshes: in the log; with the one that stands by
  std::map<std::string, Telling> unused_;  ///< meshes that no decision has named yet
  std::deque<Telling> telling_;
};

}  // namespace mortise

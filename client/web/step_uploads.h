#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/web/feed.h"
#include "common/math/pose.h"

namespace mortise::web {

/// The parts of a STEP file.
struct BroughtAssembly {
  std::vector<std::vector<std::byte>> meshes;  ///< brought_part.h; of each distinct part
  struct Place {
    std::string name;
    std::size_t mesh = 0;  ///< index of `meshes`
    Pose X_WP;
  };
  std::vector<Place> places;
  std::vector<std::string> notes;
};

/// Reads a STEP file of this name. Takes as long as it takes: called in a thread of its own.
using ReadAssembly = std::function<Result<BroughtAssembly>(const std::string& name,
                                                           const std::vector<std::byte>& bytes)>;

/// STEP files of pages: read one after another beside all else, then the meshes of their parts go
/// to the server one by one, as uploads of the page's user.
class StepUploads {
 public:
  /// `read` may be empty: no such file is taken. The client must outlive this.
  StepUploads(Client& client, ReadAssembly read) : client_(client), read_(std::move(read)) {}

  bool takes(const std::string& name) const;
  struct Sender {
    Viewer* viewer = nullptr;
    LocalUser user = 0;
    std::uint64_t id = 0;  ///< the page's own
  };
  void begin(const Sender& sender, const std::string& name, std::vector<std::byte> bytes);
  void leave(Viewer& viewer);
  /// Begins to read, and to send what was read.
  void turn();
  /// False: it is not of these.
  bool tell(const UploadState& state);

 private:
  struct Reading;
  struct File {
    Sender sender;
    std::string name;
    std::vector<std::byte> bytes;
    std::shared_ptr<Reading> reading;         ///< once it is its turn
    std::optional<BroughtAssembly> assembly;  ///< once it was read
    std::vector<std::string> hashes;          ///< of its meshes that the server has
    std::uint64_t upload = 0;                 ///< the client's number of the one under way
    bool ended = false;
  };

  void begin_to_read(File& file);
  void send_next(File& file);
  void refuse(File& file, const std::string& text);
  void tell_parts(const File& file);

  Client& client_;
  ReadAssembly read_;
  std::deque<File> files_;  ///< the first is read or sent
};

}  // namespace mortise::web

#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/messages/command.h"
#include "common/session/world/part_shapes.h"

namespace mortise {

/// Reads uploaded mesh files and makes all that a session needs of them, one after another, in a
/// thread of ordinary priority: no tick waits for it. A file is read in the confined
/// importer, as any other.
class PartMaker {
 public:
  struct Wish {
    std::string key;  ///< told back
    // A file with the hash that was announced, in pieces as it came,
    std::string name, hash;
    double unit_mm = 1.0;
    std::vector<std::vector<std::byte>> pieces;
    // or a mesh.
    SolidPtr solid;
    double quantum_mm = 0.0;
    std::optional<PartShapes::AsPart> as = {};  ///< what it is to be; nothing: a part of its own
  };
  struct Made {
    std::string key;
    PartShapePtr shape;  ///< null: it could not be made, and `text` says why
    double quantum_mm = 0.0;
    std::optional<PartShapes::AsPart> as = {};
    std::string text;  ///< else what was found in the file; may be empty
    std::shared_ptr<const std::vector<Feature>> recognized;  ///< null: not searched
    /// Of a file: see mesh_bytes.h and, where something is stated of it, brought_part.h.
    std::shared_ptr<const std::vector<std::byte>> mesh_bytes;
  };
  /// Called by the thread for each mesh of a file, before it is told as made.
  using Publish = std::function<void(const std::string& hash, std::span<const std::byte> bytes)>;

  /// threads: that judge the parts.
  PartMaker(PartShapes::Make make, int threads, Publish publish);
  ~PartMaker();  ///< does not wait: the thread ends after its present file
  PartMaker(const PartMaker&) = delete;
  PartMaker& operator=(const PartMaker&) = delete;

  void make(Wish wish);
  /// Lets go of it in the thread: to free what was made of a large part takes a tick. Null:
  /// nothing.
  void discard(std::shared_ptr<const void> what);
  /// What was made since the last call. Never blocks for longer than a move.
  std::vector<Made> take();

 private:
  struct Work;
  std::shared_ptr<Work> work_;
};

}  // namespace mortise

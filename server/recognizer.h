#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/solid.h"

namespace mortise {

/// Searches meshes for features, one after another, in a thread of lowest priority. A scene of many
/// meshes is done seconds after the session begins, and no tick waits for it.
class Recognizer {
 public:
  using Shown = std::pair<std::string, std::shared_ptr<const std::vector<Feature>>>;

  explicit Recognizer(std::vector<SolidPtr> meshes);
  ~Recognizer();  ///< does not wait: the thread ends after its present mesh
  Recognizer(const Recognizer&) = delete;
  Recognizer& operator=(const Recognizer&) = delete;

  /// What was found since the last call, by mesh hash. Never blocks for longer than a copy.
  std::vector<Shown> take();
  bool done() const;  ///< what take() gives after this is the last

 private:
  struct Work;
  std::shared_ptr<Work> work_;
};

}  // namespace mortise

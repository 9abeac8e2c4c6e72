#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/solid.h"

namespace mortise {

/// Looks for features in meshes, one after another, in a thread of its own that only takes what
/// the machine has left: some 10 to 100 us a triangle, so that a scene of many meshes is known
/// seconds after a session began, and no tick waits for it.
class Recognizer {
 public:
  using Shown = std::pair<std::string, std::shared_ptr<const std::vector<Feature>>>;

  explicit Recognizer(std::vector<SolidPtr> meshes);
  ~Recognizer();  ///< does not wait: the thread ends by itself behind the mesh at hand
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

#include "common/geometry/recognition/recognized.h"

#include <list>
#include <mutex>
#include <string>
#include <tuple>

namespace mortise {
namespace {

using Key = std::tuple<std::string, double, bool>;

class Memory {
 public:
  std::shared_ptr<const Recognition> of(const Key& key) {
    const std::lock_guard lock(mutex_);
    for (auto kept = kept_.begin(); kept != kept_.end(); ++kept)
      if (kept->key == key) {
        kept_.splice(kept_.begin(), kept_, kept);
        return kept->found;
      }
    return nullptr;
  }

  // Gives what is kept: that of another thread where it came first.
  std::shared_ptr<const Recognition> keep(Key key, std::shared_ptr<const Recognition> found,
                                          std::size_t triangles) {
    if (auto known = of(key)) return known;
    const std::lock_guard lock(mutex_);
    kept_.push_front({std::move(key), found, triangles});
    triangles_ += triangles;
    for (; triangles_ > kRecognizedTriangles && kept_.size() > 1; kept_.pop_back())
      triangles_ -= kept_.back().triangles;
    return found;
  }

 private:
  struct Kept {
    Key key;
    std::shared_ptr<const Recognition> found;
    std::size_t triangles = 0;
  };

  std::mutex mutex_;
  std::list<Kept> kept_;  // the last one asked for first
  std::size_t triangles_ = 0;
};

}  // namespace

std::shared_ptr<const Recognition> recognized(const Solid& solid,
                                              const RecognitionOptions& options) {
  // Never destroyed: a background search may still ask when the process ends.
  static Memory& memory = *new Memory;
  Key key(solid.hash(), options.quantum_mm, options.planes);
  if (auto known = memory.of(key)) return known;
  auto found = std::make_shared<const Recognition>(recognize_features(solid, options));
  return memory.keep(std::move(key), std::move(found), solid.mesh().triangles.size());
}

}  // namespace mortise

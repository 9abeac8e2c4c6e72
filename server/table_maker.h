#pragma once
#include <future>
#include <optional>

#include "common/session/guide/feature_table.h"

namespace mortise {

/// Makes tables of features beside the ticks: that of a part of a million triangles takes longer
/// than a tick has. Whoever goes while one is made waits for it.
class TableMaker {
 public:
  /// Begins one. Only while none is under way.
  void make(FeatureSources sources);
  bool is_busy() const { return table_.valid(); }  ///< until take() has given the table
  /// The table, once it is made. Does not wait.
  std::optional<FeatureTable> take();

 private:
  std::future<FeatureTable> table_;
};

}  // namespace mortise

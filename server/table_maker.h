#pragma once
#include <memory>
#include <optional>

#include "common/session/guide/feature_table.h"

namespace mortise {

/// Makes tables of features in a thread that gives way to the ticks: that of a part of a million
/// triangles takes longer than a tick has.
class TableMaker {
 public:
  TableMaker();
  ~TableMaker();  ///< does not wait: the thread ends with its present table
  TableMaker(const TableMaker&) = delete;
  TableMaker& operator=(const TableMaker&) = delete;

  /// Begins one. Only while none is under way.
  void make(FeatureSources sources);
  bool is_busy() const { return is_busy_; }  ///< until take() has given the table
  /// The table, once it is made. Never blocks for longer than a move.
  std::optional<FeatureTable> take();

 private:
  struct Work;
  std::shared_ptr<Work> work_;
  bool is_busy_ = false;
};

}  // namespace mortise

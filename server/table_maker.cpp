#include "server/table_maker.h"

#include <mutex>
#include <thread>
#include <utility>

#include "common/base/check.h"
#include "server/scheduling.h"

namespace mortise {

struct TableMaker::Work {
  std::mutex mutex;
  std::optional<FeatureTable> made;
};

TableMaker::TableMaker() : work_(std::make_shared<Work>()) {}
TableMaker::~TableMaker() = default;

void TableMaker::make(FeatureSources sources) {
  MORTISE_CHECK(!is_busy_, "one table at a time");
  is_busy_ = true;
  std::thread([work = work_, sources = std::move(sources)] {
    run_as_others();
    FeatureTable table = feature_table(sources);
    const std::lock_guard lock(work->mutex);
    work->made = std::move(table);
  }).detach();
}

std::optional<FeatureTable> TableMaker::take() {
  if (!is_busy_) return std::nullopt;
  const std::lock_guard lock(work_->mutex);
  is_busy_ = !work_->made;
  return std::exchange(work_->made, std::nullopt);
}

}  // namespace mortise

#include "server/table_maker.h"

#include <chrono>
#include <utility>

#include "common/base/check.h"
#include "server/scheduling.h"

namespace mortise {

void TableMaker::make(FeatureSources sources) {
  MORTISE_CHECK(!is_busy(), "one table at a time");
  table_ = std::async(std::launch::async, [sources = std::move(sources)] {
    run_as_others();
    return feature_table(sources);
  });
}

std::optional<FeatureTable> TableMaker::take() {
  if (!is_busy() || table_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  return table_.get();
}

}  // namespace mortise

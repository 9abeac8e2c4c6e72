#include "client/replay/sweep.h"

#include <atomic>
#include <mutex>
#include <thread>

namespace mortise {
namespace {

Result<std::vector<Change>> read_changes(const std::vector<std::string>& texts) {
  std::vector<Change> changes;
  for (const std::string& text : texts) {
    auto change = read_change(text);
    if (!change) return change.error();
    changes.push_back(std::move(*change));
  }
  return changes;
}

void compute(const SessionLog& log, Variant& variant) {
  const auto changes = read_changes(variant.changes);
  auto clashes = changes ? clashes_with(log, *changes) : Result<Clashes>(changes.error());
  if (clashes)
    variant.clashes = std::move(*clashes);
  else
    variant.error = clashes.error().text;
}

// Calls work(i) for each below count, by so many threads.
template <class Work>
void for_each(std::size_t count, int jobs, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> threads;
  for (int i = 1; i < jobs && static_cast<std::size_t>(i) < count; ++i) threads.emplace_back(run);
  run();
}

}  // namespace

Result<std::vector<std::vector<std::string>>> combinations(const std::vector<std::string>& set,
                                                           const std::vector<std::string>& sweeps) {
  std::vector<std::vector<std::string>> all{set};
  for (const std::string& sweep : sweeps) {
    const auto variants = variants_of(sweep);
    if (!variants) return variants.error();
    std::vector<std::vector<std::string>> grown;
    for (const auto& changes : all)
      for (const std::string& variant : *variants) {
        grown.push_back(changes);
        grown.back().push_back(variant);
      }
    all = std::move(grown);
  }
  return all;
}

Status check_variants(const SessionLog& log, const std::vector<Variant>& variants, int jobs) {
  std::vector<Status> found(variants.size(), ok());
  for_each(variants.size(), jobs, [&](std::size_t i) {
    const auto changes = read_changes(variants[i].changes);
    found[i] = changes ? check_changes(log, *changes) : Status(changes.error());
  });
  for (const Status& status : found)
    if (!status) return status;
  return ok();
}

void compute_variants(const SessionLog& log, std::vector<Variant>& variants, int jobs,
                      const std::function<void(std::size_t)>& on_done) {
  std::mutex mutex;
  std::size_t done = 0;
  for_each(variants.size(), jobs, [&](std::size_t i) {
    compute(log, variants[i]);
    const std::lock_guard lock(mutex);
    if (on_done) on_done(++done);
  });
}

std::vector<WhatIfRow> rows_of(const Clashes& before, const std::vector<Variant>& variants) {
  const auto row_of = [&](const Clashes& clashes, const std::string& changes) {
    const auto count = by_class(clashes);
    return WhatIfRow{changes,
                     count[static_cast<std::size_t>(CollisionClass::kReal)],
                     count[static_cast<std::size_t>(CollisionClass::kPotential)],
                     count[static_cast<std::size_t>(CollisionClass::kFake)],
                     changed_clashes(before, clashes).size(),
                     ""};
  };
  std::vector<WhatIfRow> rows{row_of(before, "as it was")};
  for (const Variant& variant : variants) {
    std::string text;
    for (const std::string& change : variant.changes) text += (text.empty() ? "" : "; ") + change;
    rows.push_back(variant.error.empty() ? row_of(variant.clashes, text)
                                         : WhatIfRow{text, 0, 0, 0, 0, variant.error});
  }
  return rows;
}

}  // namespace mortise

#pragma once
#include <functional>
#include <string>
#include <vector>

#include "client/replay/what_if.h"

namespace mortise {

/// Every combination of the sweeps (changes with brackets), each behind the fixed changes.
Result<std::vector<std::vector<std::string>>> combinations(const std::vector<std::string>& set,
                                                           const std::vector<std::string>& sweeps);

/// Is every change of every variant understood, and can it hold in the session as it begins? The
/// first that cannot fails, before anything is computed. Cost: loading the scene for each variant.
Status check_variants(const SessionLog& log, const std::vector<Variant>& variants, int jobs);

/// Computes them, `jobs` at a time; the result does not depend on it. on_done(how many) is called
/// from one thread at a time.
void compute_variants(const SessionLog& log, std::vector<Variant>& variants, int jobs,
                      const std::function<void(std::size_t)>& on_done);

/// {variant, real, potential, fake, changed, error}: a row a variant, the session as it was first.
struct WhatIfRow {
  std::string changes;
  std::uint64_t real = 0, potential = 0, fake = 0;
  std::size_t changed = 0;  ///< clashes of another class, begun or gone
  std::string error;
};
std::vector<WhatIfRow> rows_of(const Clashes& before, const std::vector<Variant>& variants);

}  // namespace mortise

#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace mortise {

/// What the session would have been with changes (client/replay/change.h).
struct WhatIfOptions {
  std::filesystem::path log;
  std::vector<std::string> set;    ///< changes of every variant
  std::vector<std::string> sweep;  ///< changes with brackets: each value with each is a variant
  int jobs = 1;                    ///< variants computed at a time
  int shard = 1, shards = 1;       ///< of all variants every shards-th, from the shard-th on
  bool json = false;
};
int run_what_if(const WhatIfOptions& options);

/// Puts the documents of all shards of one sweep together.
struct MergeOptions {
  std::vector<std::filesystem::path> files;
};
int run_merge(const MergeOptions& options);

}  // namespace mortise

#include "client/replay/what_if_command.h"

#include <algorithm>
#include <iostream>

#include "client/replay/output.h"
#include "client/replay/progress.h"
#include "client/replay/sweep.h"
#include "common/base/file_text.h"
#include "common/io/build_info.h"
#include "common/io/log/log_chain.h"

namespace mortise {
namespace {

Json document_of(const WhatIfOptions& options, const SessionLog& log, const Clashes& before,
                 const std::vector<Variant>& variants, std::size_t all) {
  Json document = {{"log", options.log.string()},
                   {"session", log.session},
                   {"engine_version", log.engine_version},
                   {"build_fingerprint", build_fingerprint()},
                   {"set", options.set},
                   {"sweep", options.sweep},
                   {"variants_in_all", all},
                   {"before", json_of(Variant{0, {}, before, ""}, before)},
                   {"variants", Json::array()}};
  document["before"].erase("index");
  document["before"].erase("changed");
  for (const Variant& variant : variants) document["variants"].push_back(json_of(variant, before));
  return document;
}

}  // namespace

int run_what_if(const WhatIfOptions& options) {
  const auto all = combinations(options.set, options.sweep);
  if (!all) return say(all.error(), kExitUsage);
  const auto log = read_session(options.log);
  if (!log) return say(log.error(), kExitBadInput);
  print_notes(*log);
  std::vector<Variant> variants;
  for (std::size_t i = 0; i < all->size(); ++i)
    if (i % static_cast<std::size_t>(options.shards) == static_cast<std::size_t>(options.shard - 1))
      variants.push_back({i, (*all)[i], {}, ""});
  // A slip of the pen is said at once, not after the session was computed.
  if (const Status status = check_variants(*log, variants, options.jobs); !status)
    return say(status.error(), kExitUsage);
  // Before is what this program computes, so that no difference is one of builds.
  const auto before = clashes_with(*log, {});
  if (!before) return say(before.error(), kExitBadInput);
  Progress progress("variants", static_cast<double>(variants.size()));
  compute_variants(*log, variants, options.jobs,
                   [&](std::size_t done) { progress.show(static_cast<double>(done)); });
  progress.end();
  if (options.json)
    print(document_of(options, *log, *before, variants, all->size()));
  else
    for (const Variant& variant : variants) std::cout << text_of(variant, *before);
  for (const Variant& variant : variants)
    if (!variant.error.empty()) return say(fail(Code::kInvalidInput, variant.error), kExitUsage);
  return kExitOk;
}

int run_merge(const MergeOptions& options) {
  Json merged;
  std::vector<Json> variants;
  for (const auto& file : options.files) {
    const Result<std::string> text = file_text(file);
    if (!text) return say(text.error(), kExitBadInput);
    const Json shard = Json::parse(*text, nullptr, false);
    if (shard.is_discarded() || !shard.is_object() || !shard.contains("variants"))
      return say(fail(Code::kInvalidInput, file.string() + ": not the --json of a whatif"),
                 kExitBadInput);
    if (merged.is_null()) merged = shard;
    for (const char* key : {"session", "build_fingerprint", "set", "sweep", "before"})
      if (merged[key] != shard[key])
        return say(fail(Code::kInvalidInput, file.string() + ": another " + key + " than in " +
                                                 options.files.front().string()),
                   kExitBadInput);
    for (const Json& variant : shard["variants"]) variants.push_back(variant);
  }
  std::sort(variants.begin(), variants.end(),
            [](const Json& x, const Json& y) { return x["index"] < y["index"]; });
  const auto wanted = merged["variants_in_all"].get<std::size_t>();
  for (std::size_t i = 0; i < std::max(wanted, variants.size()); ++i)
    if (i >= variants.size() || variants[i]["index"] != i)
      return say(fail(Code::kInvalidInput, "variant " + std::to_string(i) + " of " +
                                               std::to_string(wanted) +
                                               " is missing or there twice: are all shards here?"),
                 kExitBadInput);
  merged["variants"] = variants;
  print(merged);
  return kExitOk;
}

}  // namespace mortise

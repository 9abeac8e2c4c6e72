#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "idl/dds_channel.h"

namespace mortise {

/// Each command prints its result on stdout (people's text, or one JSON document), everything else
/// on stderr, and returns the exit code of the program.
struct VerifyOptions {
  std::filesystem::path log;
  std::vector<std::filesystem::path> more;  ///< further files of the session; empty: its chain
  int threads = 1;
  bool json = false;
};
int run_verify(const VerifyOptions& options);

/// Statistics of a session, computed again from its log; fails like verify when they do not agree.
int run_report(const VerifyOptions& options);

struct InfoOptions {
  std::filesystem::path log;
  std::vector<std::filesystem::path> more;
  bool json = false;
};
int run_info(const InfoOptions& options);

struct RecoverOptions {
  std::filesystem::path log, out;
  bool json = false;
};
int run_recover(const RecoverOptions& options);

/// The whole chain of one clash (client/replay/explain.h).
struct ExplainOptions {
  std::filesystem::path log;
  std::uint32_t clash = 0;
  std::uint64_t tick = 0;  ///< 0: its worst moment
  bool json = false;
};
int run_explain(const ExplainOptions& options);

/// Plays a log to a live session (client/replay/play.h).
struct PlayCommand {
  std::filesystem::path log;
  DdsOptions network;
  double speed = 1.0, from_s = 0.0, to_s = 0.0, wait_s = 10.0;  ///< to_s 0: to the end
  bool json = false;
};
int run_play(const PlayCommand& command);

/// The session as tables (client/report/session_tables.h); what is empty is not written.
struct ExportOptions {
  std::filesystem::path log;
  std::vector<std::filesystem::path> more;
  std::filesystem::path csv;  ///< a folder
  std::filesystem::path sqlite, html, json, bcf;
  std::vector<std::string> sweep;  ///< what-if of the page; see WhatIfOptions
  bool recompute = false;          ///< for coverage
};
int run_export(const ExportOptions& options);

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

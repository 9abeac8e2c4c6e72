#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace mortise {

/// Each command prints its result on stdout (people's text, or one JSON document), everything else
/// on stderr, and returns the exit code of the program.
struct VerifyOptions {
  std::filesystem::path log;
  std::vector<std::filesystem::path> more;  ///< further files of the session; empty: its chain
  int threads = 1;
  std::filesystem::path signed_by;  ///< folder of the site that is to have signed it; empty: any
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

/// recover: nothing of the session can be played again.
inline constexpr int kExitNotReplayable = 7;
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

}  // namespace mortise

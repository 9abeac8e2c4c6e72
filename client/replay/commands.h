#pragma once
#include <filesystem>

namespace mortise {

/// Each command prints its result on stdout (people's text, or one JSON document), everything else
/// on stderr, and returns the exit code of the program.
struct VerifyOptions {
  std::filesystem::path log;
  int threads = 1;
  bool json = false;
};
int run_verify(const VerifyOptions& options);

/// Statistics of a session, computed again from its log; fails like verify when they do not agree.
int run_report(const VerifyOptions& options);

struct InfoOptions {
  std::filesystem::path log;
  bool json = false;
};
int run_info(const InfoOptions& options);

struct RecoverOptions {
  std::filesystem::path log, out;
  bool json = false;
};
int run_recover(const RecoverOptions& options);

}  // namespace mortise

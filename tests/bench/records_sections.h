#pragma once
#include <filesystem>
#include <vector>

#include "tests/bench/bench_main.h"
#include "tests/golden/played_session.h"

namespace mortise::bench {

struct RecordsOptions : BenchOptions {};

void section_size(Report& report, const RecordsOptions& options);
void section_cost(Report& report, const RecordsOptions& options);
void section_checkpoint(Report& report, const RecordsOptions& options);
void section_verify(Report& report, const RecordsOptions& options);
void section_hour(Report& report, const RecordsOptions& options);
void section_killed(Report& report, const RecordsOptions& options);
void section_damaged(Report& report, const RecordsOptions& options);

/// The demo's scenario and play in one process, computed once; null when it cannot be played.
const test::PlayedSession* demo_session();

/// A file in the system's temporary folder, removed with the object.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& name);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Makes what goes to a file of this name slow: every write and every sync of it waits. Stands in
/// front of the C library in this program; empty: nothing is slow.
struct SlowDisk {
  double write_s = 0.0, sync_s = 0.0;
};
void make_slow(const std::filesystem::path& file, const SlowDisk& disk);
/// What waited so far.
struct SlowCalls {
  long long writes = 0, syncs = 0;
};
SlowCalls slow_calls();

}  // namespace mortise::bench

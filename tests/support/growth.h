#pragma once
#include <sys/types.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace mortise::test {

/// What a process holds of the machine at one moment.
struct Holdings {
  double at_s = 0.0, resident_mb = 0.0;
  int threads = 0, handles = 0;  ///< handles: open files, sockets and the like
};

/// As the kernel counts it; all zero when there is no such process.
inline Holdings holdings_of(pid_t pid, double at_s) {
  Holdings holdings;
  holdings.at_s = at_s;
  const std::string process = "/proc/" + std::to_string(pid);
  std::ifstream status(process + "/status");
  for (std::string key; status >> key; std::getline(status, key)) {
    double kb = 0.0;
    if (key == "VmRSS:" && status >> kb) holdings.resident_mb = kb / 1024.0;
    if (key == "Threads:") status >> holdings.threads;
  }
  std::error_code gone;
  for (std::filesystem::directory_iterator file(process + "/fd", gone), end; !gone && file != end;
       file.increment(gone))
    ++holdings.handles;
  return holdings;
}

/// Least squares over what was seen from `from_s` on, MB an hour; 0 of fewer than three.
inline double resident_mb_per_h(const std::vector<Holdings>& seen, double from_s) {
  double n = 0.0, t = 0.0, m = 0.0, tt = 0.0, tm = 0.0;
  for (const Holdings& h : seen) {
    if (h.at_s < from_s) continue;
    n += 1.0, t += h.at_s, m += h.resident_mb;
    tt += h.at_s * h.at_s, tm += h.at_s * h.resident_mb;
  }
  const double spread = n * tt - t * t;
  return n < 3.0 || !(spread > 0.0) ? 0.0 : 3600.0 * (n * tm - t * m) / spread;
}

/// The most of `what` between two moments.
template <class Number>
Number most(const std::vector<Holdings>& seen, Number Holdings::*what, double from_s, double to_s) {
  Number highest{};
  for (const Holdings& h : seen)
    if (h.at_s >= from_s && h.at_s <= to_s) highest = std::max(highest, h.*what);
  return highest;
}

}  // namespace mortise::test

#pragma once
#include <vector>

namespace mortise::bench {

/// CPU time of the calling thread since it began, s. Error about 1 us (the clock of the kernel).
double thread_cpu_s();
/// CPU time of all threads of the process, s.
double process_cpu_s();

/// CPU time of the calling thread since it was made, s.
class Stopwatch {
 public:
  double elapsed_s() const { return thread_cpu_s() - start_s_; }

 private:
  double start_s_ = thread_cpu_s();
};

/// Least CPU time of one call, s: at most `most` measurements, no more once `enough_s` are spent.
/// Calls of a few microseconds are measured many together: reading the clock costs as much.
template <class F>
double least_time_s(F&& call, int most = 5, double enough_s = 0.02) {
  constexpr double kTogether_s = 1e-4;
  const auto measure = [&](int calls) {
    const Stopwatch watch;
    for (int i = 0; i < calls; ++i) call();
    return watch.elapsed_s();
  };
  double spent_s = measure(1);
  double least_s = spent_s;
  const int together = 1 + static_cast<int>(kTogether_s / (least_s + 1e-6));
  for (int i = 1; i < most && spent_s < enough_s; ++i) {
    const double time_s = measure(together);
    spent_s += time_s;
    least_s = time_s / together < least_s ? time_s / together : least_s;
  }
  return least_s;
}

/// The value at rank ceil(q n), q in (0, 1]; not a number when there is none.
double quantile(std::vector<double> values, double q);
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }
double largest(const std::vector<double>& values);
/// Of positive values; not a number when there is none.
double geometric_mean(const std::vector<double>& values);

}  // namespace mortise::bench

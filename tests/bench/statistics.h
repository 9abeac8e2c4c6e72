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

/// Least CPU time of one call, s: at most `most` calls, no more once `enough_s` are spent in all.
template <class F>
double least_time_s(F&& call, int most = 5, double enough_s = 0.02) {
  double least_s = 0.0, spent_s = 0.0;
  for (int i = 0; i < most && (i == 0 || spent_s < enough_s); ++i) {
    const Stopwatch watch;
    call();
    const double time_s = watch.elapsed_s();
    least_s = i == 0 || time_s < least_s ? time_s : least_s;
    spent_s += time_s;
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

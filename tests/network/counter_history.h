#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace mortise::test {

/// What happened to a counter that is only counted up, as one client saw it, by its clock. It is
/// linear where of any two operations of which one ended before the other began, the later sees the
/// earlier: a read tells all that was acknowledged or read before it began, and no more than was
/// asked for before it ended.
class CounterHistory {
 public:
  void asked(double at_s) { asked_s_.push_back(at_s); }
  void acknowledged(std::uint64_t seq, double at_s) {
    if (!refused_.contains(seq)) done_s_.emplace(seq, at_s);
  }
  /// An acknowledged one is not counted where it was refused: told before or after.
  void refused(std::uint64_t seq) {
    refused_.insert(seq);
    done_s_.erase(seq);
  }
  void read(double begun_s, double ended_s, std::uint64_t count) {
    const std::uint64_t most = reads_.empty() ? 0 : reads_.back().most;
    reads_.push_back({begun_s, ended_s, count, std::max(most, count)});
  }
  const std::map<std::uint64_t, double>& known() const { return done_s_; }

  /// Empty: it is linear.
  std::string what_is_wrong() const {
    std::vector<double> done_s;
    for (const auto& [seq, at_s] : done_s_) done_s.push_back(at_s);
    std::ranges::sort(done_s);
    for (const Read& read : reads_) {
      const auto before = std::ranges::lower_bound(reads_, read.begun_s, {}, &Read::ended_s);
      const std::uint64_t seen = before == reads_.begin() ? 0 : std::prev(before)->most;
      const std::uint64_t least = std::max(seen, before_that(done_s, read.begun_s));
      const std::uint64_t most = before_that(asked_s_, read.ended_s);
      if (read.count < least)
        return "a read of " + std::to_string(read.count) + ", where " + std::to_string(seen) +
               " had been read, and " + std::to_string(before_that(done_s, read.begun_s)) +
               " acknowledged";
      if (read.count > most)
        return "a read of " + std::to_string(read.count) + ", where " + std::to_string(most) +
               " had been asked for";
    }
    return "";
  }

 private:
  struct Read {
    double begun_s = 0.0, ended_s = 0.0;
    std::uint64_t count = 0, most = 0;  ///< most: of this and all before
  };
  static std::uint64_t before_that(const std::vector<double>& rising_s, double at_s) {
    return static_cast<std::uint64_t>(std::ranges::lower_bound(rising_s, at_s) - rising_s.begin());
  }
  std::vector<double> asked_s_;  ///< rising
  std::map<std::uint64_t, double> done_s_;
  std::set<std::uint64_t> refused_;
  std::vector<Read> reads_;  ///< by their ends
};

}  // namespace mortise::test

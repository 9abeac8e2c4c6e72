#pragma once
#include <string>

namespace mortise::test {

/// A disk that takes its time: while it lives, fdatasync() of a file whose name ends so waits in
/// this program until go_on(). One at a time.
class SlowFile {
 public:
  explicit SlowFile(const std::string& end_of_name);
  ~SlowFile();
  SlowFile(const SlowFile&) = delete;
  SlowFile& operator=(const SlowFile&) = delete;
  bool is_waited_for(double limit_s) const;  ///< by now, or within so long
  void go_on();
};

}  // namespace mortise::test

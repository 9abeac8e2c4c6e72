#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/network/patience.h"
#include "tests/support/test_folder.h"

namespace mortise::test {

/// A program of the house in a process of its own; ended with the object, by its id.
class Program {
 public:
  /// `name` in the folder of the built programs, or with its path. Output goes to files in
  /// `folder`.
  Program(const std::filesystem::path& folder, const std::string& name,
          const std::vector<std::string>& arguments);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void signal(int number) const;
  /// Waits for its end: the exit code, 128 + signal when it was ended by one, -1 when the time is
  /// over.
  int wait(double limit_s);
  bool running();
  std::string out() const;            ///< what it wrote to stdout so far
  std::string errors() const;         ///< and to stderr
  pid_t pid() const { return pid_; }  ///< -1: it has ended
  double cpu_s() const;               ///< user and system time so far; only while it runs

 private:
  bool reap(int flags);

  std::filesystem::path out_, errors_;
  pid_t pid_ = -1;
  int exit_code_ = -1;
};

std::filesystem::path program_path(const std::string& name);

}  // namespace mortise::test

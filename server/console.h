#pragma once
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/io/progress_log.h"

namespace mortise {

struct ConsoleStyle {
  bool terminal = false;    ///< else a file or a pipe: each line begins with the time of day
  bool color = false;       ///< of warnings, errors and classes
  std::size_t columns = 0;  ///< of the terminal; 0: not known
};

/// Of stderr as it is now. Colours only on a terminal, and not where NO_COLOR is set.
ConsoleStyle style_of_stderr();

/// Messages on stderr: news begins with its own first word, warnings and errors with theirs. On a
/// terminal, lines that stay are below all of them.
class Console : public LogSink {
 public:
  using StyleNow = std::function<ConsoleStyle()>;
  explicit Console(std::FILE* out = stderr, StyleNow style = style_of_stderr);

  void take(const LogMessage& message) override;

  /// In the place of the lines that stayed before. Nothing where `out` is no terminal.
  void stay(std::vector<std::string> lines);
  /// The lines that stay are left where they are, and what is printed next goes below them.
  void leave();

 private:
  void clear();
  void draw();

  std::mutex mutex_;
  std::FILE* out_;
  const StyleNow style_;
  const ConsoleStyle style_of_messages_;  ///< as it was at the beginning
  std::vector<std::string> lines_;
  std::size_t rows_ = 0;  ///< on the terminal now
};

}  // namespace mortise

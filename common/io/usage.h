#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Command lines of programs. Behind it stands CLI11, whose templates cost each unit that includes
/// them ten seconds of compiling. What it does for the process is in program_process.h.
namespace mortise {

/// What is wrong with a command line: "--part x: there is none". Thrown by what reads or checks it.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One option of a program. The functions return the option itself, for the next one.
class ProgramOption {
 public:
  explicit ProgramOption(CLI::Option* option) : option_(option) {}
  /// Under this heading of --help.
  ProgramOption group(const std::string& heading) const;
  ProgramOption required() const;
  /// --help shows the value that the variable has now.
  ProgramOption shows_default() const;
  ProgramOption in_range(int lo, int hi) const;
  ProgramOption in_range(double lo, double hi) const;
  ProgramOption in_range(std::uint64_t lo, std::uint64_t hi) const;
  ProgramOption positive() const;      ///< up to kLargestNumber
  ProgramOption not_negative() const;  ///< the same
  ProgramOption one_of(const std::vector<std::string>& words) const;
  /// What `wrong` says of a value is wrong with it; nothing: it may be.
  ProgramOption check(const std::function<std::string(const std::string&)>& wrong) const;
  /// A list as one word with commas between.
  ProgramOption comma_separated() const;
  /// Names a file that is read. A pipe or a device, which may have no end, is bad input.
  ProgramOption reads_file() const;
  /// Names a file that is written: none that is read, and none that another option has written.
  ProgramOption writes_file() const;
  /// A list of which each word has the option before it.
  ProgramOption one_at_a_time() const;
  ProgramOption needs(const ProgramOption& other) const;
  ProgramOption excludes(const ProgramOption& other) const;
  ProgramOption excludes(const std::string& other) const;

 private:
  CLI::Option* option_;
};

/// The options of a program, or of one of its commands. Names are those of CLI11: "-o,--out" is an
/// option, "file" a positional one. What options are read into must outlive read().
class ProgramOptions {
 public:
  /// `version` is what --version prints.
  ProgramOptions(const std::string& title, const std::string& version);

  /// Of text, a number, a path, an optional number, or a vector of them: of which types is in
  /// usage.cpp. Numbers are finite, and those without a sign have none.
  template <class T>
  ProgramOption add(const std::string& name, T& value, const std::string& text);
  ProgramOption add_flag(const std::string& name, bool& value, const std::string& text);
  /// Each value goes to `take`, which may throw a UsageError.
  ProgramOption add_number(const std::string& name, const std::function<void(double)>& take,
                           const std::string& text);
  ProgramOption add_word(const std::string& name,
                         const std::function<void(const std::string&)>& take,
                         const std::string& text);
  /// A command of the program, which must be given one; `run` is called when it was this one.
  ProgramOptions add_command(const std::string& name, const std::string& text,
                             const std::function<void()>& run);
  /// The last lines of --help.
  void footer(const std::string& text);

  /// Reads a command line, and calls `then`, which checks what options ask of each other and throws
  /// a UsageError. -1: go on. Else the exit code of the program: it has printed help or version
  /// where they were asked for, else one line on stderr that says what is wrong and what to do (the
  /// nearest known option or command).
  int read(int argc, char** argv, const std::function<void()>& then = {});

 private:
  explicit ProgramOptions(CLI::App* app) : app_(app) {}
  std::shared_ptr<CLI::App> owned_;  ///< of the program; none for a command of it
  CLI::App* app_;
};

/// Fails where one of these files, which are read although no option names them (meshes of a
/// scenario, further files of a log), is one that an option of the command line has written.
Status none_is_written(const std::vector<std::filesystem::path>& read);

}  // namespace mortise

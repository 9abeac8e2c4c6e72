#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/io/mesh/mesh_import.h"

namespace mortise {

/// Processor time that a file of so many bytes may take, besides the limit of wall time.
struct CpuLimit {
  double least_s = 0.0, s_for_MB = 0.0;
};

/// A program that reads what strangers wrote, alone and with limits: it gets what it may use (see
/// sandbox.h) as its last argument, questions on stdin, and answers on stdout.
struct ConfinedChild {
  std::string called;      ///< "mesh importer", for messages
  std::string where_from;  ///< what to do when it cannot be started
  std::filesystem::path program;
  std::filesystem::path file;          ///< that it reads; one of the arguments names it
  std::vector<std::string> arguments;  ///< before the last
  ImportLimits limits;
  CpuLimit cpu;
  std::span<const std::byte> question = {};
};

/// An answer, as long as it is needed.
class MappedBytes {
 public:
  explicit MappedBytes(std::span<const std::byte> bytes) : bytes_(bytes) {}
  ~MappedBytes();
  MappedBytes(MappedBytes&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
  MappedBytes& operator=(MappedBytes&&) = delete;
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// The program that an environment variable names, else the one of this name beside the running
/// program, else the first one in PATH: a library runs in programs of others.
std::filesystem::path program_beside(const char* variable, const char* name);

/// Runs it and returns its answer. Every failure of it (crash, hang, limits, no answer) becomes one
/// line. The process has ended when this returns.
Result<MappedBytes> run_confined(const ConfinedChild& child);

/// A child that says one thing by itself, keeps what it read, and answers one question about it. It
/// ends when it has answered, or with its owner. Its stdin is a socket: it writes there how long
/// its first answer is once stdout holds it (8 bytes), and reads the question to its end; the
/// second answer follows the first on stdout.
class ConfinedDialogue {
 public:
  /// `child.question` is not used.
  static Result<ConfinedDialogue> start(const ConfinedChild& child);
  ConfinedDialogue(ConfinedDialogue&& other) noexcept;
  ConfinedDialogue& operator=(ConfinedDialogue&&) = delete;
  ~ConfinedDialogue();

  /// Its first answer, once.
  std::vector<std::byte> take_said() { return std::move(said_); }
  /// Waits at most so long. Fails when it was asked before.
  Result<std::vector<std::byte>> ask(std::span<const std::byte> question, double seconds);

 private:
  explicit ConfinedDialogue(ConfinedChild child) : child_(std::move(child)) {}
  Status begin();
  Error end_of_child(double seconds_left, double seconds);
  Result<std::vector<std::byte>> answer_from(std::size_t begin, std::size_t end) const;

  ConfinedChild child_;
  int pid_ = 0, answer_ = -1, socket_ = -1;
  std::vector<std::byte> said_;
  std::size_t said_bytes_ = 0;
};

}  // namespace mortise

#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace mortise {

/// The kind of an error, for a program to act on. The text of an Error says what, where, and what
/// to do, in one line.
enum class Code { kInvalidInput, kNotFound, kUnsupported, kLimit, kMismatch, kRuntime };

struct Error {
  Code code = Code::kRuntime;
  std::string text;
};

/// Exit codes of every program of the house.
enum ExitCode {
  kExitOk = 0,
  kExitRuntime = 1,
  kExitUsage = 2,
  kExitBadInput = 3,   ///< bad scenario, mesh or log
  kExitMismatch = 4,   ///< verification mismatch
  kExitThreshold = 5,  ///< a required figure was not met
  kExitFindings = 6,   ///< --fail-on found something
};

int exit_code_of(Code code);

/// A value, or the reason why there is none. Made only by ok(...) / fail(...): there is no default
/// success.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}
  explicit operator bool() const { return state_.index() == 0; }
  T& value() & { return std::get<0>(state_); }
  const T& value() const& { return std::get<0>(state_); }
  T&& value() && { return std::get<0>(std::move(state_)); }
  const Error& error() const { return std::get<1>(state_); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }

 private:
  std::variant<T, Error> state_;
};

/// Success without a value.
struct Done {};
using Status = Result<Done>;

inline Status ok() { return Done{}; }
inline Error fail(Code code, std::string text) { return Error{code, std::move(text)}; }

}  // namespace mortise

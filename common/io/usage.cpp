#include "common/io/usage.h"

#include <errno.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "common/base/in_quotes.h"
#include "common/base/nearest_word.h"
#include "common/base/result.h"

namespace mortise {
namespace {

// What the system may refuse anywhere, in a thread of a library too. Null: a fault of our own.
const char* what_is_missing() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    return "no memory is left: raise its limit (ulimit -v), or give it less to do";
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again)
      return "no further thread can be started: raise the limits of memory (ulimit -v) and "
             "processes (ulimit -u)";
  } catch (...) {
  }
  return nullptr;
}

std::terminate_handler& handler_before() {
  static std::terminate_handler before = nullptr;
  return before;
}

// Nothing here asks for memory.
[[noreturn]] void end_with_one_line() {
  if (const char* missing = what_is_missing()) {
    std::fprintf(stderr, "%s: %s\n", program_invocation_short_name, missing);
    std::_Exit(kExitRuntime);
  }
  if (handler_before() != nullptr) handler_before()();
  std::abort();
}

// Of every program that reads a command line, before it does.
[[maybe_unused]] const bool kEndsWithOneLine = [] {
  handler_before() = std::set_terminate(end_with_one_line);
  return true;
}();

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* command : app.get_subcommands()) {
    const std::vector<std::string> more = options_of(*command);
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

// What is wrong with the first word that the program does not know; empty when it knows all.
std::string unknown_word(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining(true);
  for (const std::string& word : words)
    if (word.starts_with("-")) {
      const std::string name = word.substr(0, word.find('='));
      const std::string nearest = nearest_word(name, options_of(app));
      return "no such option: " + name +
             (nearest.empty() ? "; --help lists them" : "; did you mean " + nearest + "?");
    }
  if (words.empty()) return {};
  const std::vector<std::string> commands = commands_of(app);
  if (!commands.empty() && app.get_subcommands().empty())
    return "no such command: " + words.front() + did_you_mean(words.front(), commands);
  return in_quotes(words.front()) + " is one argument too many; --help says what is expected";
}

int exit_of_usage(const CLI::App& app, const std::string& what) {
  std::string wrong = unknown_word(app);
  if (wrong.empty()) wrong = what + "; --help says what is expected";
  std::fprintf(stderr, "%s: %s\n",
               std::filesystem::path(app.get_name()).filename().string().c_str(), wrong.c_str());
  return kExitUsage;
}

}  // namespace

ProgramOption ProgramOption::group(const std::string& heading) const {
  return ProgramOption(option_->group(heading));
}
ProgramOption ProgramOption::required() const { return ProgramOption(option_->required()); }
ProgramOption ProgramOption::shows_default() const {
  return ProgramOption(option_->capture_default_str());
}
ProgramOption ProgramOption::in_range(int lo, int hi) const {
  return ProgramOption(option_->check(CLI::Range(lo, hi)));
}
ProgramOption ProgramOption::in_range(double lo, double hi) const {
  return ProgramOption(option_->check(CLI::Range(lo, hi)));
}
ProgramOption ProgramOption::in_range(std::uint64_t lo, std::uint64_t hi) const {
  return ProgramOption(option_->check(CLI::Range(lo, hi)));
}
ProgramOption ProgramOption::positive() const {
  return ProgramOption(option_->check(CLI::PositiveNumber));
}
ProgramOption ProgramOption::not_negative() const {
  return ProgramOption(option_->check(CLI::NonNegativeNumber));
}
ProgramOption ProgramOption::one_of(const std::vector<std::string>& words) const {
  return ProgramOption(option_->check(CLI::IsMember(words)));
}
ProgramOption ProgramOption::check(
    const std::function<std::string(const std::string&)>& wrong) const {
  return ProgramOption(option_->check(wrong, ""));
}
ProgramOption ProgramOption::comma_separated() const {
  return ProgramOption(option_->delimiter(','));
}
ProgramOption ProgramOption::one_at_a_time() const {
  return ProgramOption(option_->allow_extra_args(false));
}
ProgramOption ProgramOption::needs(const ProgramOption& other) const {
  return ProgramOption(option_->needs(other.option_));
}
ProgramOption ProgramOption::excludes(const ProgramOption& other) const {
  return ProgramOption(option_->excludes(other.option_));
}
ProgramOption ProgramOption::excludes(const std::string& other) const {
  return ProgramOption(option_->excludes(other));
}

ProgramOptions::ProgramOptions(const std::string& title, const std::string& version)
    : owned_(std::make_shared<CLI::App>(title)), app_(owned_.get()) {
  app_->set_version_flag("--version", version);
}

template <class T>
ProgramOption ProgramOptions::add(const std::string& name, T& value, const std::string& text) {
  return ProgramOption(app_->add_option(name, value, text));
}
template ProgramOption ProgramOptions::add(const std::string&, std::string&, const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, int&, const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, unsigned&, const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, double&, const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, std::uint64_t&, const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, std::filesystem::path&,
                                           const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, std::optional<int>&,
                                           const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, std::vector<std::string>&,
                                           const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, std::vector<std::uint64_t>&,
                                           const std::string&);
template ProgramOption ProgramOptions::add(const std::string&, std::vector<std::filesystem::path>&,
                                           const std::string&);

ProgramOption ProgramOptions::add_flag(const std::string& name, bool& value,
                                       const std::string& text) {
  return ProgramOption(app_->add_flag(name, value, text));
}

ProgramOption ProgramOptions::add_number(const std::string& name,
                                         const std::function<void(double)>& take,
                                         const std::string& text) {
  return ProgramOption(app_->add_option_function<double>(name, take, text));
}

ProgramOption ProgramOptions::add_word(const std::string& name,
                                       const std::function<void(const std::string&)>& take,
                                       const std::string& text) {
  return ProgramOption(app_->add_option_function<std::string>(name, take, text));
}

ProgramOptions ProgramOptions::add_command(const std::string& name, const std::string& text,
                                           const std::function<void()>& run) {
  app_->require_subcommand(1);
  CLI::App* const command = app_->add_subcommand(name, text);
  command->callback(run);
  return ProgramOptions(command);
}

void ProgramOptions::footer(const std::string& text) { app_->footer(text); }

int ProgramOptions::read(int argc, char** argv, const std::function<void()>& then) {
  try {
    app_->parse(argc, argv);
    if (then) then();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success))
      return exit_of_usage(*app_, error.what());
    app_->exit(error);
    return kExitOk;
  } catch (const UsageError& error) {
    return exit_of_usage(*app_, error.what());
  }
  return -1;
}

}  // namespace mortise

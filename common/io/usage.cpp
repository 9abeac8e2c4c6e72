#include "common/io/usage.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/base/in_quotes.h"
#include "common/base/nearest_word.h"
#include "common/base/ranges.h"
#include "common/base/result.h"
#include "common/io/program_process.h"

namespace mortise {
namespace {

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

namespace fs = std::filesystem;

// What the command line of this process names.
struct NamedFile {
  std::string option;
  fs::path path;
};
struct NamedFiles {
  std::vector<NamedFile> read, written;
};
NamedFiles& named_files() {
  static NamedFiles files;
  return files;
}

// Links and other spellings of a name are followed. What goes to a device or a pipe overwrites
// nothing.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::exists(a, error)) return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
  const auto whole = [&](const fs::path& file) {
    return fs::weakly_canonical(fs::absolute(file, error), error);
  };
  return !whole(a).empty() && whole(a) == whole(b);
}

// A file that is named cannot be read.
struct BadInput {
  std::string text;
};

void check_named_files() {
  const auto& [read, written] = named_files();
  std::error_code error;
  for (const NamedFile& file : read) {
    const fs::file_status status = fs::status(file.path, error);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
      throw BadInput{file.path.string() + ": is a pipe or a device; write it to a file, name that"};
  }
  const auto wrong = [](const NamedFile& file, const std::string& what) {
    return UsageError(file.option + " " + file.path.string() + ": " + what + "; name another file");
  };
  for (std::size_t i = 0; i < written.size(); ++i) {
    for (const NamedFile& input : read)
      if (is_same_file(written[i].path, input.path))
        throw wrong(written[i], "would overwrite the input " + input.path.string());
    for (std::size_t j = 0; j < i; ++j)
      if (is_same_file(written[i].path, written[j].path))
        throw wrong(written[i], written[j].option + " writes this one too");
  }
}

// CLI11 takes "nan" for a number.
std::optional<double> finite_number(const std::string& text) {
  double x = 0.0;
  if (!CLI::detail::lexical_cast(text, x) || !std::isfinite(x)) return std::nullopt;
  return x;
}

std::string wrong_number(const std::string& text, double lo, double hi) {
  const auto x = finite_number(text);
  if (!x) return in_quotes(text) + " is no finite number";
  if (lo <= *x && *x <= hi) return {};
  char range[96];
  std::snprintf(range, sizeof range, " not in range %.10g to %.10g", lo, hi);
  return "Value " + text + range;
}

template <class T>
struct ElementOf {
  using type = T;
};
template <class T>
struct ElementOf<std::vector<T>> {
  using type = T;
};
template <class T>
struct ElementOf<std::optional<T>> {
  using type = T;
};

// CLI11 takes "-1" for the largest number without a sign.
template <class T>
CLI::Option* with_sane_numbers(CLI::Option* option) {
  using Number = typename ElementOf<T>::type;
  if constexpr (std::is_floating_point_v<Number>)
    option->check([](const std::string& text) { return wrong_number(text, -HUGE_VAL, HUGE_VAL); },
                  "");
  else if constexpr (std::is_unsigned_v<Number>)
    option->check(
        [](const std::string& text) {
          return text.starts_with("-") ? text + " is below 0" : std::string();
        },
        "");
  return option;
}

int exit_of_usage(const CLI::App& app, const std::string& what) {
  std::string wrong = unknown_word(app);
  if (wrong.empty()) wrong = what + "; --help says what is expected";
  std::fprintf(stderr, "%s: %s\n", fs::path(app.get_name()).filename().string().c_str(),
               wrong.c_str());
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
  char range[96];
  std::snprintf(range, sizeof range, "FLOAT in [%.10g - %.10g]", lo, hi);
  const auto wrong = [lo, hi](const std::string& text) { return wrong_number(text, lo, hi); };
  return ProgramOption(option_->check(wrong, range));
}
ProgramOption ProgramOption::in_range(std::uint64_t lo, std::uint64_t hi) const {
  return ProgramOption(option_->check(CLI::Range(lo, hi)));
}
ProgramOption ProgramOption::positive() const {
  const auto wrong = [](const std::string& text) {
    return finite_number(text) == 0.0 ? "must be above 0" : wrong_number(text, 0.0, kLargestNumber);
  };
  return ProgramOption(option_->check(wrong, "POSITIVE"));
}
ProgramOption ProgramOption::not_negative() const {
  const auto wrong = [](const std::string& text) {
    return wrong_number(text, 0.0, kLargestNumber);
  };
  return ProgramOption(option_->check(wrong, "NONNEGATIVE"));
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
ProgramOption ProgramOption::reads_file() const {
  return ProgramOption(option_->each([option = option_](const std::string& file) {
    named_files().read.push_back({option->get_name(), file});
  }));
}
ProgramOption ProgramOption::writes_file() const {
  return ProgramOption(option_->each([option = option_](const std::string& file) {
    if (!file.empty()) named_files().written.push_back({option->get_name(), file});
  }));
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
  begin_program();
  app_->set_version_flag("--version", version);
}

template <class T>
ProgramOption ProgramOptions::add(const std::string& name, T& value, const std::string& text) {
  return ProgramOption(with_sane_numbers<T>(app_->add_option(name, value, text)));
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
  return ProgramOption(
      with_sane_numbers<double>(app_->add_option_function<double>(name, take, text)));
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
  command->callback([run] {
    check_named_files();
    run();
  });
  return ProgramOptions(command);
}

void ProgramOptions::footer(const std::string& text) { app_->footer(text); }

int ProgramOptions::read(int argc, char** argv, const std::function<void()>& then) {
  named_files() = {};
  try {
    app_->parse(argc, argv);
    if (then) then();
    check_named_files();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success))
      return exit_of_usage(*app_, error.what());
    app_->exit(error);
    return kExitOk;
  } catch (const UsageError& error) {
    return exit_of_usage(*app_, error.what());
  } catch (const BadInput& bad) {
    std::fprintf(stderr, "%s: %s\n", fs::path(app_->get_name()).filename().string().c_str(),
                 bad.text.c_str());
    return kExitBadInput;
  }
  return -1;
}

Status none_is_written(const std::vector<fs::path>& read) {
  for (const NamedFile& written : named_files().written)
    for (const fs::path& file : read)
      if (is_same_file(written.path, file))
        return fail(Code::kInvalidInput, written.option + " " + written.path.string() +
                                             ": would overwrite the input " + file.string() +
                                             "; name another file");
  return ok();
}

}  // namespace mortise

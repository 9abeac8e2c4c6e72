#include "client/replay/output.h"

#include <iostream>

#include "client/replay/progress.h"
#include "common/base/json_text.h"
#include "common/io/log/log_chain.h"
#include "common/io/usage.h"

namespace mortise {

int say(const Error& error, int exit_code) {
  std::cerr << "mortise-replay: " << error.text << '\n';
  return exit_code;
}

void print(const Json& document) { std::cout << json_text(document) << '\n'; }

void print_lines(const Json& document) {
  for (const auto& [key, value] : document.items())
    std::cout << key << ": " << (value.is_string() ? value.get<std::string>() : value.dump())
              << '\n';
}

void print_notes(const SessionLog& log) {
  if (!log.complete) std::cerr << "the log was not closed: its tail is missing\n";
  for (const std::string& note : log.notes) std::cerr << note << '\n';
}

Result<SessionLog> read_files(const std::filesystem::path& log,
                              const std::vector<std::filesystem::path>& more) {
  std::vector<std::filesystem::path> files{log};
  files.insert(files.end(), more.begin(), more.end());
  if (more.empty()) files = chain_from(log);
  if (const Status kept = none_is_written(files); !kept) return kept.error();
  Progress progress("reading the log", static_cast<double>(files.size()));
  return read_session(files, {.on_progress = [&](double read) { progress.show(read); }});
}

}  // namespace mortise

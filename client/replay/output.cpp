#include "client/replay/output.h"

#include <iostream>

namespace mortise {

int say(const Error& error, int exit_code) {
  std::cerr << "mortise-replay: " << error.text << '\n';
  return exit_code;
}

void print(const Json& document) {
  std::cout << document.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

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
  if (more.empty()) return read_session(log);
  std::vector<std::filesystem::path> files{log};
  files.insert(files.end(), more.begin(), more.end());
  return read_session(files);
}

}  // namespace mortise

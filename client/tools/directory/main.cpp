#include <chrono>
#include <cstdio>
#include <thread>

#include "client/tools/directory/listing.h"

namespace {

// Between two looks at what has answered: far below --wait.
constexpr std::chrono::milliseconds kTurn{20};

int fail(const std::string& text, int exit_code) {
  std::fprintf(stderr, "mortise-directory: %s\n", text.c_str());
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  const mortise::DirectoryCommand command = mortise::read_directory_command(argc, argv);
  if (command.exit_code >= 0) return command.exit_code;
  std::vector<std::unique_ptr<mortise::Directory>> directories;
  for (const mortise::DdsOptions& place : command.places) {
    auto opened = mortise::open_directory(place);
    if (!opened) return fail(opened.error().text, mortise::exit_code_of(opened.error().code));
    directories.push_back(std::move(*opened));
  }

  // All servers that there are are not known before the time is over.
  using Clock = std::chrono::steady_clock;
  std::vector<mortise::ListedServer> servers;
  const auto end = Clock::now() + std::chrono::duration<double>(command.wait_s);
  do {
    std::this_thread::sleep_for(kTurn);
    servers.clear();
    for (std::size_t i = 0; i < directories.size(); ++i)
      for (mortise::KnownServer& server : directories[i]->known())
        servers.push_back({command.places[i].domain, std::move(server)});
  } while (Clock::now() < end);

  if (command.json) std::fputs(mortise::listing_json(servers).c_str(), stdout);
  if (servers.empty()) return fail(mortise::nobody_text(command), mortise::kExitRuntime);
  if (!command.json) std::fputs(mortise::listing_text(servers).c_str(), stdout);
  return mortise::kExitOk;
}

#include "client/tools/directory/options.h"

#include <charconv>
#include <set>
#include <sstream>

#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise {
namespace {

// The ports of domain 233 would be above 65535. A server hears at a port and at the next one.
constexpr int kMaxDomain = 232, kMaxPort = 65534;
// Each is a participant of its own, with its threads and sockets.
constexpr std::size_t kMostPlaces = 32;

}  // namespace

std::vector<int> read_numbers(const std::string& text, int lo, int hi) {
  std::set<int> numbers;
  std::stringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    int first = 0, last = 0;
    const char* const end = word.data() + word.size();
    auto read = std::from_chars(word.data(), end, first);
    last = first;
    if (read.ec == std::errc() && read.ptr != end && *read.ptr == '-')
      read = std::from_chars(read.ptr + 1, end, last);
    if (read.ec != std::errc() || read.ptr != end || first < lo || last > hi || last < first)
      throw UsageError("'" + word + "' is neither a number nor a range of numbers in " +
                       std::to_string(lo) + ".." + std::to_string(hi) +
                       "; write for example 0,3,5-8");
    for (int number = first; number <= last; ++number) numbers.insert(number);
  }
  return {numbers.begin(), numbers.end()};
}

DirectoryCommand read_directory_command(int argc, char** argv) {
  DirectoryCommand command;
  DdsOptions where;
  where.session = kEverySession;
  std::string domains = "0", ports = "0";
  ProgramOptions app(
      "mortise-directory: which sessions there are, and which servers lead or stand by",
      version_line("mortise-directory"));
  app.add("--session", where.session, "This session only; *: all")
      .group(kSessionGroup)
      .shows_default();
  app.add("--domain", domains, "DDS domains to look in, e.g. 0,3,5-8")
      .group(kNetworkGroup)
      .shows_default();
  app.add("--server-port", ports, "First UDP ports of servers, likewise; 0: 7402 + 250 * domain")
      .group(kNetworkGroup)
      .shows_default();
  add_search_network_options(app, where);
  app.add("--wait", command.wait_s, "Listen for so many seconds")
      .in_range(0.1, 600.0)
      .shows_default();
  app.add_flag("--json", command.json, "One JSON document on stdout");
  app.footer(
      "Exit codes: 0 ok, 1 no server was found or the network failed, 2 usage, 3 an address, "
      "session "
      "or folder of keys that cannot be.");
  command.exit_code = app.read(argc, argv, [&] {
    for (const int domain : read_numbers(domains, 0, kMaxDomain))
      for (const int port : read_numbers(ports, 0, kMaxPort)) {
        where.domain = domain;
        where.discovery_port = port;
        command.places.push_back(where);
        if (command.places.size() > kMostPlaces)
          throw UsageError("more than " + std::to_string(kMostPlaces) +
                           " domains times ports at one time; ask for fewer");
      }
    if (command.places.empty()) throw UsageError("--domain and --server-port need a number");
  });
  return command;
}

}  // namespace mortise

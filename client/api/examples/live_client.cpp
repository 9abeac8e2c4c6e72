// Looks on at a live session and names its parts: live_client SESSION [DOMAIN]
#include <mortise/client.h>

#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: live_client SESSION [DOMAIN]\n";
    return 2;
  }
  mortise::ClientOptions options;
  options.session = argv[1];
  options.domain = argc > 2 ? std::atoi(argv[2]) : 0;
  options.role = "observer";
  auto client = mortise::Client::join("looker", options);
  if (!client) {
    std::cerr << client.error().text << "\n";
    return 1;
  }
  for (const mortise::LivePart& part : client->parts()) std::cout << part.name << "\n";
  for (const mortise::LiveEvent& event : client->listen(0.5).events)
    std::cout << event.kind << ": " << event.clash.explanation << "\n";
  return 0;
}

// Looks on at a session and names its parts: watch SESSION [DOMAIN]
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "client/client.h"
#include "idl/dds_channel.h"

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: watch SESSION [DOMAIN]\n";
    return 2;
  }
  mortise::DdsOptions options;
  options.session = argv[1];
  options.domain = argc > 2 ? std::atoi(argv[2]) : 0;
  auto channel = mortise::open_client_channel(options);
  if (!channel) {
    std::cerr << channel.error().text << "\n";
    return 1;
  }
  mortise::Client client(**channel);
  constexpr int kPatience_ms = 10'000, kPeriod_ms = 20;
  for (int waited_ms = 0; waited_ms < kPatience_ms; waited_ms += kPeriod_ms) {
    if (client.poll().resynced) {
      for (const auto& [id, part] : client.parts()) std::cout << part.info.name << "\n";
      return 0;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(kPeriod_ms));
  }
  std::cerr << "no server of session '" << options.session << "' in domain " << options.domain
            << "\n";
  return 1;
}

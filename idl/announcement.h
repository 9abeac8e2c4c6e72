#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mortise {

/// A UDP port of a host. Both in the order of this machine.
struct UdpPlace {
  std::uint32_t ipv4 = 0;
  std::uint16_t port = 0;
  auto operator<=>(const UdpPlace&) const = default;
};
std::string to_text(std::uint32_t ipv4);     ///< 127.0.0.1
std::string to_text(const UdpPlace& place);  ///< 127.0.0.1:7402

/// What a participant tells a discovery server of itself, in the user data of what it announces.
struct Purpose {
  bool serves = false;  ///< leads the session or stands by; else takes part, or looks who does
  int domain = 0;
  std::string session;  ///< as DdsOptions::session; kEverySession: all of the domain
  bool operator==(const Purpose&) const = default;
};
std::string to_text(const Purpose& purpose);
std::optional<Purpose> purpose_of(const std::string& text);

/// A participant's announcement of itself (RTPS 2.3, section 8.5.3), as far as one asks who does
/// not take part: who is it, what is it for, and where does it hear?
struct Announcement {
  std::array<std::byte, 12> participant{};  ///< prefix of its GUIDs
  bool leaves = false;                      ///< it takes leave; then the rest is empty
  std::optional<Purpose> purpose;           ///< none: it tells no discovery server
  std::vector<UdpPlace> places;             ///< of announcements, at most 8
  std::vector<UdpPlace> inboxes;            ///< of all else, likewise
  bool hears_otherwise = false;  ///< at more places, by multicast, or not by UDP over IPv4
};

/// Of a datagram that the guard lets through (admissible_length()) and that holds one announcement
/// of who sends it, a time at most, and nothing else: so it may be passed on whole. None: it is
/// another. Proven by nothing. O(datagram).
std::optional<Announcement> read_announcement(std::span<const std::byte> datagram);

}  // namespace mortise

#include "idl/announcement.h"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "idl/rtps_bytes.h"

namespace mortise {
namespace {

using namespace rtps_wire;

// Above it RTPS has no port for a domain.
constexpr int kMaxDomain = 232;
// Twice the length of a valid name.
constexpr std::size_t kMostOfSession = 128;
// More than a host has interfaces; bounds what a stranger can make us keep.
constexpr std::size_t kMostPlaces = 8;
const std::string kBegin = "mortise ", kServer = "server ", kClient = "client ";

// The writer of announcements, section 9.3.1.5.
constexpr std::array<std::byte, 4> kAnnouncer = {std::byte{0x00}, std::byte{0x01}, std::byte{0x00},
                                                 std::byte{0xc2}};
constexpr std::size_t kWriterAt = 8, kAfterSequence = 20;  // in the body of DATA
constexpr std::uint8_t kInlineQosFlag = 2, kDataOrKeyFlag = 4 | 8;
constexpr std::uint8_t kInfoTimestamp = 0x09;
// Parameters, sections 9.6.2.2 and 9.6.3.9.
constexpr std::uint16_t kMulticast = 0x30, kUnicast = 0x31, kMetatrafficUnicast = 0x32,
                        kMetatrafficMulticast = 0x33, kParticipantGuid = 0x50, kKeyHash = 0x70,
                        kStatusInfo = 0x71;
constexpr std::uint32_t kUdpV4 = 1;
constexpr std::size_t kLocatorSize = 24, kIpv4InLocator = 20;

/// Calls with the id and the value of each; how long the list is, with its end.
template <class Action>
std::size_t for_each_parameter(const Bytes& list, Action action) {
  std::size_t at = 0;
  while (list.has(at + 4)) {
    const std::uint16_t id = list.u16(at), length = list.u16(at + 2);
    at += 4;
    if (id == kSentinel || !list.has(at + length)) break;
    action(id, Bytes{list.data.subspan(at, length), list.little});
    at += length;
  }
  return at;
}

void read_place(const Bytes& locator, std::vector<UdpPlace>& places, bool& otherwise) {
  const std::uint32_t port = locator.has(kLocatorSize) ? locator.u32(4) : 0;
  if (port == 0 || port > 0xffff || locator.u32(0) != kUdpV4 || places.size() >= kMostPlaces) {
    otherwise = true;
    return;
  }
  const Bytes in_net_order{locator.data, false};
  places.push_back({in_net_order.u32(kIpv4InLocator), static_cast<std::uint16_t>(port)});
}

std::string text_of(const Bytes& octets) {
  if (!octets.has(4)) return {};
  const std::size_t size = std::min<std::size_t>(octets.u32(0), octets.data.size() - 4);
  std::string text(size, '\0');
  if (size > 0) std::memcpy(text.data(), octets.data.data() + 4, size);
  return text;
}

/// Reads the body of DATA; false: it is no announcement of who sends it.
class AnnouncementReader {
 public:
  explicit AnnouncementReader(Announcement& told) : told_(told) {}

  bool read(const Bytes& body, std::uint8_t flags) {
    if (!body.has(kAfterSequence) ||
        !std::equal(kAnnouncer.begin(), kAnnouncer.end(), body.data.begin() + kWriterAt))
      return false;
    std::size_t at = kAfterSequence;
    if ((flags & kInlineQosFlag) != 0)
      at += for_each_parameter(
          {body.data.subspan(at), body.little},
          [this](std::uint16_t id, const Bytes& value) { take_inline(id, value); });
    if ((flags & kDataOrKeyFlag) != 0) {
      if (!body.has(at + 4)) return false;
      const bool little = body.u8(at + 1) == 3;  // encapsulation: a parameter list, 2 or 3
      for_each_parameter({body.data.subspan(at + 4), little},
                         [this](std::uint16_t id, const Bytes& value) { take(id, value); });
    }
    return names_itself_ && !names_another_;
  }

 private:
  void take_inline(std::uint16_t id, const Bytes& value) {
    constexpr std::uint32_t kGone = 1 | 2;  // disposed, unregistered
    if (id == kStatusInfo && value.has(4))
      told_.leaves = (Bytes{value.data, false}.u32(0) & kGone) != 0;
    if (id == kKeyHash) take_name(value);
  }
  void take(std::uint16_t id, const Bytes& value) {
    if (id == kParticipantGuid) take_name(value);
    if (id == kMetatrafficUnicast) read_place(value, told_.places, told_.hears_otherwise);
    if (id == kUnicast) read_place(value, told_.inboxes, told_.hears_otherwise);
    if (id == kMulticast || id == kMetatrafficMulticast) told_.hears_otherwise = true;
    if (id == kUserData) told_.purpose = purpose_of(text_of(value));
  }
  void take_name(const Bytes& guid) {
    const bool own =
        guid.has(told_.participant.size()) &&
        std::equal(told_.participant.begin(), told_.participant.end(), guid.data.begin());
    (own ? names_itself_ : names_another_) = true;
  }

  Announcement& told_;
  bool names_itself_ = false, names_another_ = false;
};

}  // namespace

std::string to_text(std::uint32_t ipv4) {
  std::string text;
  for (const int shift : {24, 16, 8, 0}) {
    if (!text.empty()) text += '.';
    text += std::to_string((ipv4 >> shift) & 0xff);
  }
  return text;
}

std::string to_text(const UdpPlace& place) {
  return to_text(place.ipv4) + ":" + std::to_string(place.port);
}

std::string to_text(const Purpose& purpose) {
  return kBegin + (purpose.serves ? kServer : kClient) + std::to_string(purpose.domain) + " " +
         purpose.session;
}

std::optional<Purpose> purpose_of(const std::string& text) {
  Purpose purpose;
  if (!text.starts_with(kBegin)) return std::nullopt;
  const std::string_view rest = std::string_view(text).substr(kBegin.size());
  purpose.serves = rest.starts_with(kServer);
  if (!purpose.serves && !rest.starts_with(kClient)) return std::nullopt;
  const char* const first = rest.data() + (purpose.serves ? kServer : kClient).size();
  const char* const end = rest.data() + rest.size();
  const auto read = std::from_chars(first, end, purpose.domain);
  if (read.ec != std::errc() || read.ptr == end || *read.ptr != ' ' || purpose.domain < 0 ||
      purpose.domain > kMaxDomain)
    return std::nullopt;
  purpose.session.assign(read.ptr + 1, end);
  if (purpose.session.empty() || purpose.session.size() > kMostOfSession) return std::nullopt;
  return purpose;
}

std::optional<Announcement> read_announcement(std::span<const std::byte> datagram) {
  const Bytes all{datagram, true};
  if (!all.has(kHeaderSize)) return std::nullopt;
  Announcement told;
  std::copy_n(datagram.begin() + kHeaderSize - told.participant.size(), told.participant.size(),
              told.participant.begin());
  bool announces = false;
  std::size_t at = kHeaderSize;
  while (all.has(at + kSubmessageHeaderSize)) {
    const std::uint8_t id = all.u8(at), flags = all.u8(at + 1);
    const bool little = (flags & 1) != 0;
    std::size_t length = Bytes{datagram, little}.u16(at + 2);
    at += kSubmessageHeaderSize;
    if (length == 0 && id == kDataSubmessage) length = datagram.size() - at;
    if (!all.has(at + length)) return std::nullopt;
    if (id == kDataSubmessage) {
      if (announces ||
          !AnnouncementReader(told).read({datagram.subspan(at, length), little}, flags))
        return std::nullopt;
      announces = true;
    } else if (id != kInfoTimestamp || announces) {
      return std::nullopt;
    }
    at += length;
  }
  return announces ? std::optional(told) : std::nullopt;
}

}  // namespace mortise

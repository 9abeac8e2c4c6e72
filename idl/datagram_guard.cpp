#include "idl/datagram_guard.h"

#include <algorithm>
#include <cstring>

#include "idl/rtps_bytes.h"

namespace mortise {
namespace {

using namespace rtps_wire;

constexpr std::uint8_t kMajorVersion = 2;

enum Submessage : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoSource = 0x0c,
  kInfoDestination = 0x0e,
  kNackFrag = 0x12,
  kHeartbeatFrag = 0x13,
  kData = kDataSubmessage,
  kDataFrag = 0x16,
  kSecureBody = 0x30,
  kSecurePrefix = 0x31,
  kSecurePostfix = 0x32,
  kSecureRtpsPrefix = 0x33,
  kSecureRtpsPostfix = 0x34,
  kStatistics = 0x80,  // eProsima's own: an assert() of the reader is reachable behind it
};

constexpr std::uint16_t kTypeIdentifier = 0x69, kTypeObject = 0x72;  // their reader crashes
// Lengths inside these are believed by their readers.
constexpr std::uint16_t kPropertyList = 0x59, kIdentityToken = 0x1001, kPermissionsToken = 0x1002,
                        kIdentityStatusToken = 0x1006;
constexpr std::uint32_t kMaxBitmapBits = 256;                 // of a number set, 9.4.2.6
constexpr std::int64_t kMaxSequence = std::int64_t{1} << 48;  // no writer gets there
constexpr std::int64_t kMaxHeartbeatRange = 10'000'000;       // far above any history
constexpr std::int64_t kMaxGapRange = 100'000;                // a gap is walked number by number

/// The value of a parameter, read from its front; nothing in it may be longer than what is left.
class Value {
 public:
  explicit Value(const Bytes& bytes) : bytes_(bytes) {}

  /// Text, or a sequence of bytes.
  bool octets() {
    std::uint32_t size = 0;
    if (!count(size) || size > bytes_.data.size() - at_) return false;
    at_ = std::min(bytes_.data.size(), at_ + (std::size_t{size} + 3) / 4 * 4);
    return true;
  }
  /// Properties: pairs of a name and a value.
  bool properties() {
    std::uint32_t size = 0;
    if (!count(size)) return false;
    for (std::uint32_t i = 0; i < size; ++i) {
      if (!octets() || !octets()) return false;
    }
    return true;
  }
  /// Class, properties and binary properties.
  bool token() { return octets() && properties() && properties(); }

 private:
  bool count(std::uint32_t& number) {
    if (!bytes_.has(at_ + 4)) return false;
    number = bytes_.u32(at_);
    at_ += 4;
    return true;
  }
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

/// Of what participants announce: is the value of the parameter whole?
bool announced_ok(std::uint16_t id, const Bytes& value) {
  switch (id) {
    case kUserData:
      return Value(value).octets();
    case kPropertyList:
      return Value(value).properties();
    case kIdentityToken:
    case kPermissionsToken:
    case kIdentityStatusToken:
      return Value(value).token();
    default:
      return true;
  }
}

/// Length of a parameter list with its sentinel; 0 when it does not end, or holds what must not be
/// read.
std::size_t parameter_list_length(const Bytes& list, bool is_announced) {
  std::size_t at = 0;
  while (list.has(at + 4)) {
    const std::uint16_t id = list.u16(at), length = list.u16(at + 2);
    at += 4;
    if (id == kSentinel) return at;
    if (is_announced && (id == kTypeIdentifier || id == kTypeObject)) return 0;
    if (length % 4 != 0 || !list.has(at + length)) return 0;
    if (is_announced && !announced_ok(id, {list.data.subspan(at, length), list.little})) return 0;
    at += length;
  }
  return 0;
}

/// Serialized payload: encapsulation known (CDR or parameter list, XCDR1), parameter lists whole.
bool payload_ok(const Bytes& payload) {
  // Encapsulations: 0 and 1 are CDR, 2 and 3 parameter lists; odd ones are little endian.
  constexpr std::uint8_t kLastKnown = 3, kFirstParameterList = 2;
  if (!payload.has(4) || payload.u8(0) != 0 || payload.u8(1) > kLastKnown) return false;
  if (payload.u8(1) < kFirstParameterList) return true;
  const Bytes list{payload.data.subspan(4), payload.u8(1) == kLastKnown};
  return parameter_list_length(list, true) != 0;
}

bool sequence_ok(std::int64_t sequence) { return sequence > 0 && sequence < kMaxSequence; }

bool data_ok(const Bytes& body, std::uint8_t flags) {
  // Bits of the flags of DATA (RTPS 2.2, section 9.4.5.3).
  constexpr std::uint8_t kInlineQos = 2, kDataOrKey = 4 | 8;
  if (!body.has(20) || body.u16(2) != kOctetsToInlineQos || !sequence_ok(body.sequence(12))) {
    return false;
  }
  std::size_t at = 20;
  if ((flags & kInlineQos) != 0) {
    const std::size_t length = parameter_list_length({body.data.subspan(at), body.little}, false);
    if (length == 0) return false;
    at += length;
  }
  return (flags & kDataOrKey) == 0 || payload_ok({body.data.subspan(at), body.little});
}

bool data_frag_ok(const Bytes& body) {
  if (!body.has(32) || body.u16(2) != kOctetsToInlineQos + 12 || !sequence_ok(body.sequence(12))) {
    return false;
  }
  const std::uint32_t first = body.u32(20), sample_size = body.u32(28);
  const std::uint32_t count = body.u16(24), fragment_size = body.u16(26);
  // Fragments are numbered from 1 and lie inside the sample.
  return first >= 1 && count >= 1 && fragment_size >= 1 &&
         (std::uint64_t{first} + count - 2) * fragment_size < sample_size;
}

/// Number set of a bitmap that starts at `at` with its base's bit count.
bool bitmap_ok(const Bytes& body, std::size_t at, std::size_t after) {
  if (!body.has(at + 4)) return false;
  const std::uint32_t bits = body.u32(at);
  return bits <= kMaxBitmapBits && body.has(at + 4 + 4 * ((bits + 31) / 32) + after);
}

bool heartbeat_ok(const Bytes& body) {
  if (!body.has(28)) return false;
  const std::int64_t first = body.sequence(8), last = body.sequence(16);
  return first > 0 && last >= first - 1 && last < kMaxSequence &&
         last - first <= kMaxHeartbeatRange;
}

bool gap_ok(const Bytes& body) {
  if (!body.has(28)) return false;
  const std::int64_t start = body.sequence(8), base = body.sequence(16);
  return sequence_ok(start) && base >= start && base < kMaxSequence &&
         base - start <= kMaxGapRange && bitmap_ok(body, 24, 0);
}

bool acknack_ok(const Bytes& body) {
  if (!body.has(24)) return false;
  const std::int64_t base = body.sequence(8);
  return base >= 0 && base < kMaxSequence && bitmap_ok(body, 16, 4);
}

// DDS-Security 1.1, section 9.5.2: lengths inside what is encrypted are big endian. Fast DDS
// believes them before it knows whether they are genuine, and decrypts beyond the end of the
// datagram.
bool secure_prefix_ok(const Bytes& body) {
  constexpr std::size_t kSecureHeaderSize = 20;  // kind, key id, session id, suffix: 4 + 4 + 4 + 8
  return body.data.size() == kSecureHeaderSize;
}

bool secure_body_ok(const Bytes& body) {
  constexpr std::uint64_t kMostPadding = 3;  // to a multiple of four bytes
  if (!body.has(4)) return false;
  const std::uint64_t room = body.data.size() - 4, length = Bytes{body.data, false}.u32(0);
  return length <= room && room - length <= kMostPadding;
}

bool secure_postfix_ok(const Bytes& body) {
  constexpr std::size_t kMacSize = 16, kReceiverMacSize = 20;  // of AES-GCM; with a key id
  if (!body.has(kMacSize + 4)) return false;
  const std::uint64_t macs = Bytes{body.data, false}.u32(kMacSize);
  return body.data.size() == kMacSize + 4 + macs * kReceiverMacSize;
}

/// What is encrypted is prefix, body and postfix, in this order and with nothing between them.
class SecureOrder {
 public:
  bool admits(std::uint8_t id) {
    const std::uint8_t before = last_;
    last_ = id;
    if (before == kSecurePrefix || before == kSecureRtpsPrefix) {
      postfix_ = before == kSecurePrefix ? kSecurePostfix : kSecureRtpsPostfix;
      return id == kSecureBody;
    }
    if (before == kSecureBody) return id == postfix_;
    return id != kSecureBody && id != kSecurePostfix && id != kSecureRtpsPostfix;
  }
  bool may_end() const {
    return last_ != kSecurePrefix && last_ != kSecureRtpsPrefix && last_ != kSecureBody;
  }

 private:
  std::uint8_t last_ = 0, postfix_ = 0;
};

bool submessage_ok(std::uint8_t id, std::uint8_t flags, const Bytes& body) {
  constexpr std::uint8_t kInvalidateFlag = 2;  // of INFO_TS: no time follows
  switch (id) {
    case kPad:
      return true;
    case kInfoTimestamp:
      return (flags & kInvalidateFlag) != 0 || body.has(8);
    case kInfoDestination:
      return body.has(12);
    case kInfoSource:
      return body.has(20);
    case kData:
      return data_ok(body, flags);
    case kDataFrag:
      return data_frag_ok(body);
    case kAckNack:
      return acknack_ok(body);
    case kHeartbeat:
      return heartbeat_ok(body);
    case kGap:
      return gap_ok(body);
    case kNackFrag:
      return body.has(28) && sequence_ok(body.sequence(8)) && bitmap_ok(body, 20, 4);
    case kHeartbeatFrag:
      return body.has(24) && sequence_ok(body.sequence(8));
    case kSecurePrefix:
    case kSecureRtpsPrefix:
      return secure_prefix_ok(body);
    case kSecureBody:
      return secure_body_ok(body);
    case kSecurePostfix:
    case kSecureRtpsPostfix:
      return secure_postfix_ok(body);
    default:
      return false;
  }
}

}  // namespace

std::size_t admissible_length(std::span<const std::byte> datagram) {
  const Bytes all{datagram, true};
  if (!all.has(kHeaderSize) || std::memcmp(datagram.data(), "RTPS", 4) != 0 ||
      all.u8(4) != kMajorVersion) {
    return 0;
  }
  SecureOrder order;
  std::size_t at = kHeaderSize;
  while (all.has(at + kSubmessageHeaderSize)) {
    const std::uint8_t id = all.u8(at), flags = all.u8(at + 1);
    if (id == kStatistics) return at > kHeaderSize && order.may_end() ? at : 0;
    if (!order.admits(id)) return 0;
    const bool little = (flags & 1) != 0;
    std::size_t length = Bytes{datagram, little}.u16(at + 2);
    at += kSubmessageHeaderSize;
    // Length 0 means "to the end", except where an empty body is possible.
    if (length == 0 && id != kPad && id != kInfoTimestamp) length = datagram.size() - at;
    if (length % 4 != 0 || !all.has(at + length)) return 0;
    if (!submessage_ok(id, flags, {datagram.subspan(at, length), little})) return 0;
    at += length;
  }
  return at == datagram.size() && order.may_end() ? at : 0;
}

}  // namespace mortise

#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/messages/channel.h"
#include "idl/dds_channel.h"

namespace mortise {

/// As DdsOptions::session of open_directory(): whatever they are called.
inline constexpr const char* kEverySession = "*";

/// A server of a session, as far as it has told of itself.
struct KnownServer {
  enum class Place {
    kLeads,
    kStandsBy,
    kOvertaken,  ///< led the session, and another does so now
  };
  std::string session;
  std::string address;  ///< IPv4; empty: not known yet
  int port = 0;         ///< first of its two
  Place place = Place::kLeads;
  std::uint64_t term = 0;              ///< ms since 1970 of when it began to lead; 0: it does not
  std::string version;                 ///< of the program; empty: one that tells none
  std::optional<std::size_t> parts;    ///< of one that leads
  std::optional<double> tick_rate_hz;  ///< likewise
  std::optional<SessionPulse> pulse;   ///< likewise, within a second
};

/// Hears which sessions have servers at the places of DdsOptions, and takes part in none of them.
class Directory {
 public:
  virtual ~Directory() = default;
  /// All that is known by now, by session and address. Names are as they came: not for a terminal.
  virtual std::vector<KnownServer> known() = 0;
};

/// Returns at once; servers tell of themselves within 0.5 s, with keys after a handshake.
Result<std::unique_ptr<Directory>> open_directory(const DdsOptions& options);

}  // namespace mortise

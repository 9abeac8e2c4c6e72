#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace mortise::web {

/// Faults of strangers and broken clients.
enum class Incident : std::uint8_t {
  kBadRequest = 0,  ///< not HTTP, header too large, wrong method
  kSlowRequest,     ///< a request or handshake that was not complete in time
  kWrongHost,       ///< requested under a foreign host name
  kWrongOrigin,     ///< a foreign page
  kWrongToken,      ///< a wrong or missing token
  kTooManyConnections,
  kTooManyBrowsers,
  kOversized,  ///< message over the limit
  kMalformed,  ///< message not understood
  kFlood,      ///< messages over the rate
  kStalled,    ///< no longer takes data
  kSilent,     ///< no answer to a ping
  kTls,        ///< handshake failed
  kCount,
};

std::string_view name_of(Incident incident);

/// Counts incidents and logs each kind at most once a second, with the number of unlogged ones, so
/// that a flood of the gateway does not flood its log.
class Incidents {
 public:
  using Say = std::function<void(const std::string& line)>;
  explicit Incidents(Say say) : say_(std::move(say)) {}

  void note(Incident incident, const std::string& from, const std::string& what, double now_s);
  std::uint64_t count(Incident incident) const { return rows_[index(incident)].count; }
  std::map<std::string, std::uint64_t> counts() const;

 private:
  struct Row {
    std::uint64_t count = 0, unsaid = 0;
    double said_s = -1e9;
  };
  static std::size_t index(Incident incident) { return static_cast<std::size_t>(incident); }

  Say say_;
  std::array<Row, static_cast<std::size_t>(Incident::kCount)> rows_;
};

}  // namespace mortise::web

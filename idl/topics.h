#pragma once
#include <span>
#include <string>

namespace mortise {

/// One topic of the wire with its quality of service. The one table: endpoints are made from it,
/// and README.md prints it.
struct TopicRow {
  enum class Reader { kKeepLast, kKeepAll };

  const char* topic;
  const char* type;
  bool to_server;
  const char* key;  ///< members; empty: no key
  bool reliable;
  bool transient_local;  ///< kept for late joiners
  int writer_depth;      ///< KEEP_LAST per key: a writer never waits for a reader
  Reader reader;
  int reader_depth;   ///< per key
  int max_keys;       ///< 1 without key
  bool asynchronous;  ///< sent by another thread than the tick's
  bool throttled;     ///< by the mesh flow controller
  bool presence;      ///< MANUAL_BY_TOPIC liveliness
  bool large;         ///< payloads are allocated to size, not beforehand
  bool among_servers = false;
  bool leads = false;  ///< MANUAL_BY_TOPIC liveliness, short: who writes it leads the session
};

enum class Topic {
  kIncrement,
  kRequest,
  kPresence,
  kAnswers,
  kPose,
  kKeyframe,
  kEvent,
  kSnapshot,
  kMesh,
  kFeatures,
  kPulse,
  kTick,
  kTaken,
};

const TopicRow& row_of(Topic topic);
std::span<const TopicRow> topic_table();

/// The table as README.md shows it, a Markdown table, lines ending in '\n'.
std::string topic_table_markdown();

/// Largest serialized sample, bytes: below one UDP datagram, so that no sample is fragmented.
inline constexpr std::size_t kSampleLimit_bytes = 60'000;

/// Mesh flow controller: at most so much each period, so that late joiners with large scenes leave
/// the tick alone (measured: p99 lateness 0.22 ms against 3.9 ms without).
inline constexpr int kMeshBytesPerPeriod = 500'000;
inline constexpr int kMeshPeriod_ms = 10;
inline constexpr const char* kMeshFlowController = "mortise_mesh_flow";

/// A server that leads and is silent for so long is gone: it says four times in it that it lives.
inline constexpr double kLeaderLease_s = 0.15;
inline constexpr double kLeaderAssert_s = kLeaderLease_s / 4;

}  // namespace mortise

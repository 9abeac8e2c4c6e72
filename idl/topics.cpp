#include "idl/topics.h"

#include <array>

namespace mortise {
namespace {

constexpr auto kLast = TopicRow::Reader::kKeepLast;
constexpr auto kAll = TopicRow::Reader::kKeepAll;

// Users and parts of one session may number a few thousand; chunks are bounded by what fits.
constexpr int kMaxUsers = 4096;
constexpr int kMaxPoseChunks = 64;
constexpr int kMaxSnapshotChunks = 1024;
constexpr int kMaxMeshChunks = 32768;  // 1.9 GB of meshes
constexpr int kMaxFeatureChunks = 1024;

constexpr std::array<TopicRow, 13> kTopics = {{
    // topic, type, to server, key, reliable, transient local, writer depth, reader, depth, keys,
    // asynchronous, throttled, presence, large
    {"mortise_increment", "IncrementBatch", true, "user", false, false, 32, kAll, 128, kMaxUsers,
     false, false, false, true},
    {"mortise_request", "Request", true, "", true, false, 1024, kAll, 8192, 1, false, false, false,
     true},
    // The server takes several beats at once: what another client says in a user's name must not
    // push out what the user said.
    {"mortise_presence", "Presence", true, "user", true, false, 1, kLast, 16, kMaxUsers, false,
     false, true, false},
    {"mortise_answers", "Answers", false, "", true, false, 1024, kLast, 1024, 1, true, false, false,
     true},
    {"mortise_pose", "PoseBatch", false, "chunk", false, false, 8, kLast, 64, kMaxPoseChunks, true,
     false, false, true},
    {"mortise_keyframe", "PoseBatch", false, "chunk", true, true, 1, kLast, 1, kMaxPoseChunks, true,
     false, false, true},
    {"mortise_event", "EventBatch", false, "", true, false, 1024, kLast, 1024, 1, true, false,
     false, true},
    {"mortise_snapshot", "Snapshot", false, "chunk", true, true, 1, kLast, 1, kMaxSnapshotChunks,
     true, false, false, true},
    {"mortise_mesh", "MeshChunk", false, "mesh, chunk", true, true, 1, kLast, 1, kMaxMeshChunks,
     true, true, false, true},
    {"mortise_features", "Features", false, "chunk", true, true, 1, kLast, 1, kMaxFeatureChunks,
     true, true, false, true},
    {"mortise_pulse", "Pulse", false, "", true, true, 1, kLast, 1, 1, true, false, false, false},
    // At once: it is out before what it acknowledges is.
    {"mortise_tick", "ServerTick", false, "", true, false, 4096, kAll, 65536, 1, false, false,
     false, true, true, true},
    // Best effort: the next one says all that this one said.
    {"mortise_taken", "ServerTaken", false, "", false, false, 1, kLast, 1, 1, false, false, false,
     false, true},
}};

}  // namespace

const TopicRow& row_of(Topic topic) { return kTopics[static_cast<std::size_t>(topic)]; }

std::span<const TopicRow> topic_table() { return kTopics; }

std::string topic_table_markdown() {
  std::string text =
      "| topic | type | way | key | reliability | durability | writer keeps | reader keeps | keys "
      "| "
      "sent | other |\n|--|--|--|--|--|--|--|--|--|--|--|\n";
  for (const TopicRow& row : kTopics) {
    text += "| ";
    text += row.topic;
    text += " | ";
    text += row.type;
    text += row.among_servers ? " | among servers | "
            : row.to_server   ? " | to server | "
                              : " | to clients | ";
    text += *row.key == '\0' ? "none" : row.key;
    text += row.reliable ? " | reliable" : " | best effort";
    text += row.transient_local ? " | transient local" : " | volatile";
    text += " | last " + std::to_string(row.writer_depth);
    text += row.reader == kAll ? " | all, up to " : " | last ";
    text += std::to_string(row.reader_depth) + " | " + std::to_string(row.max_keys);
    text += row.asynchronous ? " | by another thread | " : " | at once | ";
    if (row.presence) text += "manual-by-topic liveliness ";
    if (row.leads) text += "manual-by-topic liveliness ";
    if (row.throttled) {
      text += "at most " + std::to_string(kMeshBytesPerPeriod / 1000) + " kB each " +
              std::to_string(kMeshPeriod_ms) + " ms ";
    }
    text += "|\n";
  }
  return text;
}

}  // namespace mortise

#pragma once

/// Names inside a session log, shared by its writer and its reader; see session_log_format.md.
namespace mortise::log_layout {

inline constexpr const char* kProfile = "mortise";
inline constexpr const char* kFormat = "2";  ///< of the records that are written
/// Formats that are read; another one is refused.
inline constexpr const char* kFormatsRead[] = {"1", "2"};

inline constexpr const char* kSessionMetadata = "mortise.session";
inline constexpr const char* kBuildMetadata = "mortise.build";
inline constexpr const char* kRecoveryMetadata = "mortise.recovery";
inline constexpr const char* kChainMetadata = "mortise.chain";
inline constexpr const char* kSignerMetadata = "mortise.signer";
inline constexpr const char* kSealMetadata = "mortise.seal";

inline constexpr const char* kScenarioAttachment = "scenario.yaml";
inline constexpr const char* kMeshPrefix = "mesh/";          ///< and the hash of the mesh
inline constexpr const char* kAssemblyPrefix = "assembly/";  ///< and the hash of its bytes
inline constexpr const char* kImportPrefix = "import/";      ///< and the id of the part

inline constexpr const char* kBinary = "x-mortise";
inline constexpr const char* kJson = "json";

inline constexpr const char* kDecisions = "/decisions";
inline constexpr const char* kIncrements = "/increments";
inline constexpr const char* kPoses = "/poses";
inline constexpr const char* kClashes = "/clashes";
inline constexpr const char* kTicks = "/ticks";
inline constexpr const char* kStatistics = "/statistics";
inline constexpr const char* kGaps = "/gaps";
inline constexpr const char* kCheckpoints = "/checkpoints";
inline constexpr const char* kTotals = "/totals";

}  // namespace mortise::log_layout

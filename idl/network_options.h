#pragma once
#include "common/io/usage.h"
#include "idl/dds_channel.h"

namespace mortise {

/// Names of the groups in which --help shows options; the same in all programs.
inline constexpr const char* kSessionGroup = "Session";
inline constexpr const char* kNetworkGroup = "Network";
inline constexpr const char* kLogGroup = "Log";
inline constexpr const char* kLimitsGroup = "Limits";
inline constexpr const char* kMetricsGroup = "Metrics";

/// The options that say where a session is met, the same in every program: --session, --domain,
/// --server-port, --interface, --discovery-server, --keys, and for clients --server. All must
/// outlive the parsing.
void add_server_network_options(ProgramOptions& app, DdsOptions& options);
void add_client_network_options(ProgramOptions& app, DdsOptions& options);
/// The same for a program that looks in several domains and at several ports: without --session,
/// --domain and --server-port.
void add_search_network_options(ProgramOptions& app, DdsOptions& options);

/// The option takes only what is_session_name().
void must_name_a_session(const ProgramOption& option);

}  // namespace mortise

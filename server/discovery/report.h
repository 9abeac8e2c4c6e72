#pragma once
#include <string>

#include "server/discovery/discovery_server.h"

namespace mortise {

/// The closing report of a discovery server: a table for people, or one JSON document.
std::string discovery_text(const DiscoveryCounts& counts);
std::string discovery_json(const DiscoveryCounts& counts);

}  // namespace mortise

#pragma once
#include <string>

#include "server/discovery/discovery_server.h"

namespace mortise {

/// Of a discovery server that ends: a table for people, or one JSON document.
std::string discovery_text(const DiscoveryCounts& counts);
std::string discovery_json(const DiscoveryCounts& counts);

}  // namespace mortise

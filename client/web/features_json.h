#pragma once
#include "client/client.h"
#include "client/web/json_out.h"

namespace mortise::web {

/// What constraints can name, as in protocol.md: a list for all parts that share it.
Json features_message(const Client& client);

}  // namespace mortise::web

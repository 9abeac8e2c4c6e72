#pragma once
#include "client/tools/first_contact/options.h"
#include "common/base/result.h"

namespace mortise {

/// Reads the meshes and the motions, asks for the first contact of each, writes the CSV. Progress
/// goes to stderr, a summary or the JSON document to stdout.
Status run_first_contact(const FirstContactOptions& options);

}  // namespace mortise

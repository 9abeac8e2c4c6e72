#pragma once
#include <string>
#include <vector>

#include "client/tools/directory/options.h"

namespace mortise {

/// A server and the domain that it was found in.
struct ListedServer {
  int domain = 0;
  KnownServer server;
};

/// For people: a table, one line a server. An unknown value is a dash; a character of a name that
/// is not printable ASCII is a question mark.
std::string listing_text(const std::vector<ListedServer>& servers);

/// The same as one document; what is not known is null.
std::string listing_json(const std::vector<ListedServer>& servers);

/// The message when no server was found: where it was looked for and what that may mean. No
/// newline.
std::string nobody_text(const DirectoryCommand& command);

}  // namespace mortise

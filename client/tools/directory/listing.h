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

/// For people: a table, one line a server. What is not known is a dash; what is no printable ASCII
/// in a name, a question mark.
std::string listing_text(const std::vector<ListedServer>& servers);

/// The same as one document; what is not known is null.
std::string listing_json(const std::vector<ListedServer>& servers);

/// One line without its end: nobody was found, where, and what that may mean.
std::string nobody_text(const DirectoryCommand& command);

}  // namespace mortise

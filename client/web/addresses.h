#pragma once
#include <string>

#include "client/web/gateway.h"

namespace mortise::web {

/// Where the addresses with the tokens are published.
struct AddressesTo {
  /// "-": stdout. A file: readable by its owner only, replaced as a whole. Empty: stdout if that is
  /// a terminal, else nowhere, because the output of a service is kept in a journal that others
  /// read.
  std::string file;
  std::string tokens;  ///< file of the tokens, named where addresses are not printed
};

/// Writes lines "ROLE [NAME] ADDRESS" to stdout or the file, or else prints where the tokens are.
Status say_addresses(const AddressesTo& to, const Gateway& gateway, const Tokens& tokens);

}  // namespace mortise::web

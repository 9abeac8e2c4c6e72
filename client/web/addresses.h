#pragma once
#include <string>

#include "client/web/gateway.h"

namespace mortise::web {

/// Where people learn the addresses that let them in.
struct AddressesTo {
  /// "-": stdout. A file: its owner reads it, nobody else; it is replaced as a whole. Empty: stdout
  /// if that is a terminal, else nowhere: what a service prints is kept in a journal that others
  /// read.
  std::string file;
  std::string tokens;  ///< file of the tokens, named where addresses are not said
};

/// Lines "ROLE [NAME] ADDRESS" on stdout or into the file, and else where the tokens are.
Status say_addresses(const AddressesTo& to, const Gateway& gateway, const Tokens& tokens);

}  // namespace mortise::web

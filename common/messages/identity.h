#pragma once
#include <string>

namespace mortise {

/// Whom a certificate of the site's authority is for. Every certificate has a serial of its own, so
/// that two of one name are two identities.
struct Identity {
  std::string site;
  std::string role;  ///< designer, observer, bot, gateway or server
  std::string serial;
  std::string name;
};

}  // namespace mortise

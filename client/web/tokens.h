#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/messages/role.h"

namespace mortise::web {

/// The role and name that a token grants.
struct Bearer {
  Role role = Role::kUnknown;
  std::string name;  ///< empty: any name
};

/// The tokens that grant access: one for designers and one for observers, or one for each person.
struct Tokens {
  std::string designer, observer;  ///< empty where each person has one
  struct Personal {
    Bearer bearer;
    std::string token;
  };
  std::vector<Personal> people = {};
};

/// 128 bits of the system's randomness each, as hex.
Tokens make_tokens();

/// Either two lines, the tokens of designers and of observers, or a line "ROLE NAME TOKEN" for each
/// person, as `mortise-keys token` makes them. A missing file is created with two lines, readable
/// by its owner only, so that addresses outlive the program.
Result<Tokens> tokens_of_file(const std::string& file);

/// The bearer of `token`; nothing for an unknown one. Takes the same time for every wrong token.
std::optional<Bearer> bearer_of(const Tokens& tokens, std::string_view token);

}  // namespace mortise::web

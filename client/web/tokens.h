#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/messages/role.h"

namespace mortise::web {

/// Whom a token is for.
struct Bearer {
  Role role = Role::kUnknown;
  std::string name;  ///< empty: whoever has it, under any name
};

/// Who may come in: one secret for those who take part and another for those who look on, or one
/// for each person.
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
/// person, as `mortise-keys token` makes them. A file that is not there is made with two lines,
/// readable by its owner only, so that addresses outlive the program.
Result<Tokens> tokens_of_file(const std::string& file);

/// Whom `token` is for; nothing when it is nobody's. Takes as long whatever is wrong with it.
std::optional<Bearer> bearer_of(const Tokens& tokens, std::string_view token);

}  // namespace mortise::web

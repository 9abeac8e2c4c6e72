#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/messages/role.h"

namespace mortise::web {

/// Who may come in: one secret for those who take part, another for those who look on.
struct Tokens {
  std::string designer, observer;
};

/// 128 bits of the system's randomness each, as hex.
Tokens make_tokens();

/// Two lines: designer, observer. A file that is not there is made, readable by its owner only, so
/// that addresses outlive the program.
Result<Tokens> tokens_of_file(const std::string& file);

/// What the bearer of `token` may be; nothing for a token that is neither. Takes as long whatever
/// is wrong with it.
std::optional<Role> role_of(const Tokens& tokens, std::string_view token);

}  // namespace mortise::web

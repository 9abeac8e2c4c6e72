#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mortise::web {

/// May requests use this `Host`? Addresses written as numbers, "localhost" and the given names,
/// with any port (it may be forwarded). Any other name may be that of a foreign page whose DNS name
/// points here.
bool is_own_host(std::string_view host, const std::vector<std::string>& names);

/// Does this `Origin` belong to a page of ours: the scheme and the Host of the request, or one of
/// the given origins?
bool is_own_origin(std::string_view origin, std::string_view host, bool tls,
                   const std::vector<std::string>& origins);

/// The T of "Authorization: Bearer T"; empty when there is none.
std::string_view bearer_token(std::string_view authorization);

/// The T of subprotocols "mortise.1, token.T"; nothing when "mortise.1" is not among them, empty
/// without a token.
std::optional<std::string_view> subprotocol_token(std::string_view protocols);

inline constexpr std::string_view kSubprotocol = "mortise.1";

}  // namespace mortise::web

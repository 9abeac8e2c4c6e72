#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mortise::web {

/// Is this `Host` one that we may be asked for under? Addresses written as numbers, "localhost",
/// and the given names are, with any port (it may be forwarded); another name is that of a page
/// that was made to point here.
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

#include "client/web/tokens.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "client/web/private_file.h"

namespace mortise::web {
namespace {

// 128 bits: not to be guessed.
constexpr std::size_t kRandomBytes = 16;
constexpr std::size_t kShortest = 16, kLongest = 128;

std::string random_hex() {
  std::array<unsigned char, kRandomBytes> bytes;
  // A machine without randomness cannot keep anybody out.
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) std::abort();
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const unsigned char byte : bytes) {
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 15];
  }
  return hex;
}

// Digests are compared, so that not even the length of a token shows in the time taken.
bool same(std::string_view a, std::string_view b) {
  const auto digest = [](std::string_view text) {
    std::array<unsigned char, SHA256_DIGEST_LENGTH> out;
    SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), out.data());
    return out;
  };
  const auto digest_a = digest(a), digest_b = digest(b);
  return CRYPTO_memcmp(digest_a.data(), digest_b.data(), digest_a.size()) == 0;
}

bool is_token(std::string_view text) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  return text.size() >= kShortest && text.size() <= kLongest &&
         text.find_first_not_of(kLetters) == std::string_view::npos;
}

/// Lines "ROLE NAME TOKEN"; nothing when a line is none, or a token is there twice.
std::optional<std::vector<Tokens::Personal>> read_people(std::istream& in) {
  std::vector<Tokens::Personal> people;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string role, name, token, more;
    words >> role >> name >> token >> more;
    if (role.empty() || role.starts_with('#')) continue;
    const std::optional<Role> known = role_named(role);
    const bool may = known == Role::kDesigner || known == Role::kObserver;
    const bool twice = std::any_of(people.begin(), people.end(),
                                   [&](const Tokens::Personal& p) { return p.token == token; });
    if (!may || !is_token(token) || !more.empty() || twice) return std::nullopt;
    people.push_back({{*known, name}, token});
  }
  return people;
}

}  // namespace

Tokens make_tokens() { return {random_hex(), random_hex()}; }

Result<Tokens> tokens_of_file(const std::string& file) {
  std::ifstream in(file);
  if (!in) {
    const Tokens made = make_tokens();
    const std::string lines = made.designer + "\n" + made.observer + "\n";
    if (Status written = write_private(file, lines); !written) return written.error();
    return made;
  }
  Tokens tokens;
  std::getline(in, tokens.designer);
  if (tokens.designer.find(' ') != std::string::npos || tokens.designer.starts_with('#')) {
    tokens.designer.clear();
    in.seekg(0);
    auto people = read_people(in);
    if (people && !people->empty()) {
      tokens.people = std::move(*people);
      return tokens;
    }
    return fail(Code::kInvalidInput,
                file +
                    ": a line for each person is needed, ROLE NAME TOKEN, role designer or "
                    "observer, each token once; `mortise keys token` makes them");
  }
  std::getline(in, tokens.observer);
  if (!is_token(tokens.designer) || !is_token(tokens.observer) ||
      tokens.designer == tokens.observer) {
    return fail(
        Code::kInvalidInput,
        file +
            ": two different lines are needed, the tokens of designers and of "
            "observers, 16 to 128 characters A-Z a-z 0-9 - _ each; or lines ROLE NAME TOKEN");
  }
  return tokens;
}

std::optional<Bearer> bearer_of(const Tokens& tokens, std::string_view token) {
  std::optional<Bearer> bearer;
  const auto compare = [&](const std::string& known, const Bearer& whose) {
    if (same(token, known) && !known.empty()) bearer = whose;
  };
  compare(tokens.designer, {Role::kDesigner, {}});
  compare(tokens.observer, {Role::kObserver, {}});
  for (const Tokens::Personal& person : tokens.people) compare(person.token, person.bearer);
  return bearer;
}

}  // namespace mortise::web

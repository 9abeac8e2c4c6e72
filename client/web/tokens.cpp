#include "client/web/tokens.h"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace mortise::web {
namespace {

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

Status write_new(const std::string& file, const Tokens& tokens) {
  const std::string text = tokens.designer + "\n" + tokens.observer + "\n";
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool written =
      out >= 0 && ::write(out, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int error = errno;
  if (out >= 0) ::close(out);
  if (written) return ok();
  return fail(Code::kRuntime, file + ": cannot be written: " + std::strerror(error));
}

}  // namespace

Tokens make_tokens() { return {random_hex(), random_hex()}; }

Result<Tokens> tokens_of_file(const std::string& file) {
  std::ifstream in(file);
  if (!in) {
    const Tokens made = make_tokens();
    if (Status written = write_new(file, made); !written) return written.error();
    return made;
  }
  Tokens tokens;
  std::getline(in, tokens.designer);
  std::getline(in, tokens.observer);
  if (!is_token(tokens.designer) || !is_token(tokens.observer) ||
      tokens.designer == tokens.observer) {
    return fail(Code::kInvalidInput,
                file +
                    ": two different lines are needed, the tokens of designers and of "
                    "observers, 16 to 128 characters A-Z a-z 0-9 - _ each");
  }
  return tokens;
}

std::optional<Role> role_of(const Tokens& tokens, std::string_view token) {
  const bool designer = same(token, tokens.designer), observer = same(token, tokens.observer);
  if (designer) return Role::kDesigner;
  if (observer) return Role::kObserver;
  return std::nullopt;
}

}  // namespace mortise::web

#include "common/io/log/log_seal.h"

#include <openssl/err.h>
#include <openssl/pem.h>

#include <array>
#include <vector>

#include "common/base/check.h"
#include "common/io/log/openssl_owner.h"

namespace mortise {
namespace {

std::string hexadecimal(std::span<const unsigned char> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace

RunningDigest::RunningDigest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
  MORTISE_CHECK(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1,
                "OpenSSL has no SHA-256");
}

void RunningDigest::add(std::span<const std::byte> bytes) {
  EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
}

std::string RunningDigest::take() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
  EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  return hexadecimal(std::span(digest).first(size));
}

std::string seal_text(std::uint64_t number, bool is_last, const std::string& digest) {
  return "mortise log seal " + std::to_string(number) + (is_last ? " last " : " ") + digest;
}

Result<std::shared_ptr<const LogSigner>> LogSigner::open(const std::filesystem::path& certificate,
                                                         const std::filesystem::path& key) {
  std::shared_ptr<LogSigner> signer(new LogSigner);
  signer->certificate_ = openssl::text_of(certificate);
  const auto own = openssl::of_pem<openssl::Certificate>(signer->certificate_, PEM_read_bio_X509);
  signer->key_.reset(
      openssl::of_pem<openssl::Key>(openssl::text_of(key), PEM_read_bio_PrivateKey).release(),
      EVP_PKEY_free);
  const bool fits =
      own && signer->key_ && X509_check_private_key(own.get(), signer->key_.get()) == 1;
  ERR_clear_error();
  if (!fits)
    return fail(Code::kInvalidInput, key.string() + ": is not there, or not the key of " +
                                         certificate.string() + "; the log cannot be signed");
  return std::shared_ptr<const LogSigner>(std::move(signer));
}

std::string LogSigner::sign(const std::string& text) const {
  const openssl::Digest context(EVP_MD_CTX_new());
  const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
  std::size_t size = 0;
  EVP_DigestSignInit(context.get(), nullptr, EVP_sha256(), nullptr, key_.get());
  EVP_DigestSign(context.get(), nullptr, &size, bytes, text.size());
  std::vector<unsigned char> signature(size);
  if (EVP_DigestSign(context.get(), signature.data(), &size, bytes, text.size()) != 1) size = 0;
  ERR_clear_error();
  return hexadecimal(std::span(signature).first(size));
}

}  // namespace mortise

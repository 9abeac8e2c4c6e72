#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "common/base/result.h"

struct evp_md_ctx_st;
struct evp_pkey_st;

namespace mortise {

/// SHA-256 of bytes as they come.
class RunningDigest {
 public:
  RunningDigest();
  void add(std::span<const std::byte> bytes);
  std::string take();  ///< 64 hexadecimal digits; afterwards it is that of nothing

 private:
  std::unique_ptr<evp_md_ctx_st, void (*)(evp_md_ctx_st*)> context_;
};

/// What a signature is of: the place of a seal in its file, and the digest up to it.
std::string seal_text(std::uint64_t number, bool is_last, const std::string& digest);

/// The key with which a server signs its logs. Not thread-safe.
class LogSigner {
 public:
  /// Fails when the files are not there, or the key is not that of the certificate.
  static Result<std::shared_ptr<const LogSigner>> open(const std::filesystem::path& certificate,
                                                       const std::filesystem::path& key);
  const std::string& certificate() const { return certificate_; }  ///< PEM
  std::string sign(const std::string& text) const;                 ///< hexadecimal

 private:
  LogSigner() = default;
  std::string certificate_;
  std::shared_ptr<evp_pkey_st> key_;
};

}  // namespace mortise

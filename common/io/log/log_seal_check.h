#pragma once
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>

#include "common/base/result.h"

namespace mortise {

/// What the seals of one file prove; session_log_format.md, "Seals".
struct SealReport {
  std::uint64_t seals = 0;         ///< whole and signed, from the front without a gap
  std::uint64_t proven_bytes = 0;  ///< up to the last of them, with it
  bool is_closed = false;     ///< the last one says that it is the last, and the file ends there
  std::string signer;         ///< name of the server
  std::string previous_seal;  ///< of the file that this one continues
  std::set<std::string> digests;  ///< of all seals
  std::string trouble;            ///< why not all is proven; empty: it is, up to proven_bytes
};

/// Reads a file record by record. `site`: a folder with the authority's ca.crt, and crl.pem where
/// there is one. A signer must be a server of that site; that its certificate expired meanwhile
/// does not matter.
Result<SealReport> check_seals(const std::filesystem::path& file,
                               const std::filesystem::path& site);

/// The files of one session, in order: empty, or why the log is not, whole and unchanged, what
/// servers of the site recorded. A file that another one continues may have lost its end, as after
/// a crash, but no whole chunk may stand behind its last seal.
Result<std::string> why_not_signed(std::span<const std::filesystem::path> files,
                                   const std::filesystem::path& site);

}  // namespace mortise

#pragma once
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "common/base/result.h"
#include "common/messages/channel.h"
#include "common/messages/identity.h"

namespace mortise {

/// What is in the folder of one identity, as `mortise-keys issue` makes it. The key alone may come
/// from elsewhere: from a service manager that hands secrets to a process without an account of its
/// own ($CREDENTIALS_DIRECTORY/identity.key), so that the folder's key stays root's.
struct KeyFiles {
  explicit KeyFiles(const std::filesystem::path& folder);
  std::filesystem::path authority, certificate, key, governance, permissions, revocations;
};

/// Reads a certificate's subject as `mortise-keys` writes it:
/// /O=site/OU=role/serialNumber=../CN=name.
Result<Identity> identity_of_subject(const std::string& subject);

/// Looks at keys before they are used, so that what is wrong with them is said here and by name;
/// the other end only refuses. Checks that the files are there, that the certificate is of the
/// site's authority, valid now and not revoked, that its serial is the one its subject says (by
/// which it is taken back while its owner is there), and that its key is the one beside it.
Result<Identity> check_keys(const std::filesystem::path& folder);

/// Whom the participants that were met belong to. Under DDS-Security the first 47 bits of a
/// participant's GUID are bound to the subject of its certificate by the handshake (DDS-Security
/// 1.1, 9.3.3); what a participant says of its own subject counts only when it has this hash.
/// Thread-safe.
class PeerIdentities {
 public:
  /// `revocations`: the list of the site's authority; read again when the file changes.
  PeerIdentities(std::filesystem::path authority, std::filesystem::path revocations);

  void met(const ClientKey& client, const std::string& subject);
  void parted(const ClientKey& client);
  std::optional<Identity> identity_of(const ClientKey& client) const;
  std::string whose(const ClientKey& client) const;  ///< for a message
  struct WhyNot {
    std::string text;
    bool is_certain;  ///< else it may yet be let in: nothing that it says of itself is against it
  };
  /// Why one that says this of itself can not have been let in, as far as can be told from that:
  /// the transport does not say. Empty subject: it has no certificate.
  WhyNot why_not(const std::string& subject, const std::string& authority) const;
  /// Also of one that came after its certificate was revoked: the list that the transport read when
  /// it began lets it in.
  bool is_revoked(const ClientKey& client) const;
  bool is_revoked(const Identity& identity) const;  ///< one's own, say
  /// Clients that are found to be revoked, or have come being so, since the last call. Looks at the
  /// file once a second; a list that is not the authority's changes nothing.
  std::vector<ClientKey> newly_revoked();

 private:
  struct Known {
    Identity identity;
    bool told = false;  ///< that it is revoked
  };
  void read_revocations();

  std::filesystem::path authority_, revocations_;
  std::string authority_subject_;
  mutable std::mutex mutex_;
  std::map<ClientKey, Known> known_;
  std::set<std::string> revoked_;  ///< serials
  bool has_news_ = false;          ///< somebody was met, or the list read, since the last look
  std::filesystem::file_time_type read_of_{};
  std::chrono::steady_clock::time_point looked_at_{};
};

}  // namespace mortise

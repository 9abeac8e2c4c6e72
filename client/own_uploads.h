#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "client/client_update.h"
#include "client/own_users.h"

namespace mortise {

/// Mesh files of this client's users on their way to the server. Sends no more than the server can
/// take in a tick beyond what it has confirmed, so that a large file delays nobody.
class OwnUploads {
 public:
  /// Both must outlive this.
  OwnUploads(ClientChannel& channel, const OwnUsers& users) : channel_(channel), users_(users) {}

  /// Returns the number of the upload.
  std::uint64_t begin(LocalUser user, const std::string& name, double unit_mm,
                      std::vector<std::byte> bytes);
  void take(const std::vector<UploadState>& states, ClientUpdate& update);
  void send_what_is_due();
  /// They begin anew at the next one.
  void forget_server();

 private:
  struct Upload {
    LocalUser user = 0;
    std::string name, hash;
    double unit_mm = 1.0;
    std::vector<std::byte> bytes;
    std::uint64_t sent = 0, received = 0;  ///< bytes
  };
  void send_some(std::uint64_t number, Upload& upload);

  ClientChannel& channel_;
  const OwnUsers& users_;
  std::map<std::uint64_t, Upload> uploads_;  ///< by number, until the server has all or refuses
  std::uint64_t next_ = 1;
};

}  // namespace mortise

#include "idl/security_properties.h"

namespace mortise {

void add_security(eprosima::fastdds::dds::DomainParticipantQos& qos, const KeyFiles& files) {
  const auto set = [&qos](const std::string& name, const std::string& value) {
    qos.properties().properties().emplace_back("dds.sec." + name, value);
  };
  const auto file = [&set](const std::string& name, const std::filesystem::path& path) {
    set(name, "file://" + path.string());
  };
  set("auth.plugin", "builtin.PKI-DH");
  file("auth.builtin.PKI-DH.identity_ca", files.authority);
  file("auth.builtin.PKI-DH.identity_certificate", files.certificate);
  file("auth.builtin.PKI-DH.private_key", files.key);
  file("auth.builtin.PKI-DH.identity_crl", files.revocations);
  set("access.plugin", "builtin.Access-Permissions");
  file("access.builtin.Access-Permissions.permissions_ca", files.authority);
  file("access.builtin.Access-Permissions.governance", files.governance);
  file("access.builtin.Access-Permissions.permissions", files.permissions);
  set("crypto.plugin", "builtin.AES-GCM-GMAC");
  // Unless told, session keys are changed so often that it shows in the CPU of every participant;
  // AES-GCM with a counter for its nonce allows 2^32 datagrams a key.
  set("crypto.maxblockspersession", "1000000");
}

}  // namespace mortise

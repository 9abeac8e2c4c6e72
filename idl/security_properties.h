#pragma once
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "idl/identity.h"

namespace mortise {

/// Switches DDS-Security on: authentication by certificates (PKI-DH), permissions by topic
/// (Access-Permissions), encryption (AES-GCM-GMAC), with the files of one identity.
void add_security(eprosima::fastdds::dds::DomainParticipantQos& qos, const KeyFiles& files);

}  // namespace mortise

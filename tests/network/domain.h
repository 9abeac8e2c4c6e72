#pragma once
#include <string>

#include "idl/dds_channel.h"

namespace mortise::test {

/// DDS domains that no other test uses while this process or one that it started lives: the first
/// of so many in a row. Waits where all are taken.
int take_domains(int count);

/// The domain of the test that runs, taken when it is first asked for.
int own_domain();
DdsOptions own_options(const std::string& session = "test");

/// Of the 250 ports of a domain, one that no participant takes by itself; index 0 to 9.
int spare_port(int domain, int index);

}  // namespace mortise::test

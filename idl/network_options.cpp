#include "idl/network_options.h"

#include "common/base/in_quotes.h"
#include "common/base/plain_text.h"

namespace mortise {

void must_name_a_session(const ProgramOption& option) {
  option.check([](const std::string& name) {
    if (is_session_name(name)) return std::string();
    return in_quotes(name) +
           " is no name of a session: up to 64 of letters, digits, '-', '_' and '.', the first "
           "no '.'";
  });
}

namespace {

void add_place(ProgramOptions& app, DdsOptions& o) {
  must_name_a_session(
      app.add("--session", o.session, "Name of the session").group(kSessionGroup).shows_default());
  app.add("--domain", o.domain, "DDS domain").group(kNetworkGroup).in_range(0, 232).shows_default();
  app.add("--server-port", o.discovery_port,
          "First of the server's two UDP ports; 0: 7402 + 250 * domain")
      .group(kNetworkGroup)
      .in_range(0, 65535)
      .shows_default();
}

void add_interface(ProgramOptions& app, DdsOptions& o) {
  app.add("--interface", o.interface, "IPv4 address of the own interface to the session")
      .group(kNetworkGroup)
      .shows_default();
}

void add_keys(ProgramOptions& app, DdsOptions& o, const char* text) {
  app.add("--keys", o.keys, text).group(kNetworkGroup);
}

}  // namespace

void add_server_network_options(ProgramOptions& app, DdsOptions& o) {
  add_place(app, o);
  add_interface(app, o);
  app.add("--discovery-server", o.discovery_server,
          "Tell it where this server is: HOST[:PORT] of mortise-discovery, comma between. "
          "Who asks there needs to know no host of the session, nor its --server-port")
      .group(kNetworkGroup);
  add_keys(app, o,
           "Folder of this server's keys (mortise keys): only who has keys of the same site may "
           "come in, and all is encrypted; needed on any --interface but loopback");
}

void add_client_network_options(ProgramOptions& app, DdsOptions& o) {
  add_place(app, o);
  add_search_network_options(app, o);
}

void add_search_network_options(ProgramOptions& app, DdsOptions& o) {
  add_interface(app, o);
  app.add("--server", o.server,
          "Hosts where the server may be, comma between: IPv4, or a name of them; default: "
          "the own interface, unless a discovery server is asked")
      .group(kNetworkGroup);
  app.add("--discovery-server", o.discovery_server,
          "Ask these where the session is led: HOST[:PORT] of mortise-discovery, comma "
          "between")
      .group(kNetworkGroup);
  add_keys(app, o, "Folder of the own keys (mortise keys), where the server asks for some");
}

}  // namespace mortise

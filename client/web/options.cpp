#include "client/web/options.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise::web {
namespace {

/// Where the page lies: in the tree of this build, else where it was installed with the
/// program.
std::string default_page() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path page = "client/web/page";
  // Of the sources that this was built in (build/PRESET/bin), or as installed.
  const fs::path bin = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& place : {bin / "../../.." / page, bin / "../share/mortise/page"})
    if (fs::exists(place, ignored)) return place.lexically_normal().string();
  return page.string();
}

void add_what_is_shown(ProgramOptions& app, WebOptions& o) {
  app.add("--replay", o.replay, "Show this session log (MCAP) with a timeline, without a server")
      .group(kLogGroup)
      .reads_file()
      .excludes("--session");
  app.add("--read-log", o.read_log,
          "Log that the server of the session writes, where this machine can read it: pages "
          "can download a report of the session so far")
      .group(kLogGroup)
      .reads_file()
      .excludes("--replay");
  // Until 0.3: elsewhere --log says where a log is written.
  app.add_word(
         "--log",
         [&o](const std::string& file) {
           std::fputs("mortise-web: --log is called --read-log now\n", stderr);
           o.read_log = file;
         },
         "")
      .group("")
      .reads_file()
      .excludes("--replay");
}

void add_http(ProgramOptions& app, GatewayOptions& o) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add(name, value, text).group("Browsers");
  };
  add("--http-address", o.address, "IPv4 address to listen on; 0.0.0.0: every interface")
      .shows_default();
  add("--http-port", o.port, "Port to listen on; 0: a free one").in_range(0, 65535).shows_default();
  add("--name", o.names,
      "Host name that browsers may ask for, beside numbers and localhost; again for more");
  add("--origin", o.origins,
      "Origin (https://host:port) of another page that may connect; again for more");
  const auto certificate =
      add("--certificate", o.certificate, "Speak TLS with this certificate chain (PEM)")
          .reads_file();
  const auto key = add("--key", o.key, "Its private key (PEM)").reads_file();
  certificate.needs(key);
  key.needs(certificate);
  app.add("--browsers", o.limits.browsers, "Browsers at one time")
      .group(kLimitsGroup)
      .in_range(1, 4096)
      .shows_default();
  app.add("--max-messages", o.limits.messages_per_s, "Messages a second of one browser")
      .group(kLimitsGroup)
      .in_range(1.0, 1e6)
      .shows_default();
}

void add_page(ProgramOptions& app, WebOptions& o) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add(name, value, text).group("Browsers");
  };
  add("--page", o.page, "Folder of the page").shows_default();
  add("--tokens", o.tokens,
      "File of two lines, the tokens of designers and of observers (made when it is not there), "
      "or a line ROLE NAME TOKEN for each person (mortise keys token). Default: two new "
      "ones for this run")
      .reads_file();
  add("--addresses", o.addresses,
      "File for the addresses with their tokens, which only its owner reads; -: stdout. "
      "Default: stdout where that is a terminal, else none are said")
      .writes_file();
}

/// What options ask of each other.
void check_together(const WebOptions& o) {
  if (o.gateway.certificate.empty() && !o.gateway.address.starts_with("127."))
    throw UsageError("--http-address " + o.gateway.address +
                     " opens the gateway to other hosts: give --certificate and --key, or "
                     "stay on 127.0.0.1 behind a proxy that speaks TLS");
  if (o.addresses.empty() && o.tokens.empty() && ::isatty(STDOUT_FILENO) == 0)
    throw UsageError(
        "stdout is no terminal, so that nobody would learn the tokens of this run: give "
        "--addresses FILE (or - for stdout all the same), or --tokens FILE");
}

}  // namespace

WebCommandLine read_web_command_line(int argc, char** argv) {
  WebCommandLine line;
  WebOptions& o = line.options;
  o.page = default_page();
  ProgramOptions app("mortise-web: lets browsers take part in a session, or look at a log of one",
                     mortise::version_line("mortise-web"));
  add_client_network_options(app, o.network);
  add_what_is_shown(app, o);
  add_http(app, o.gateway);
  add_page(app, o);
  app.add_flag("--quiet", o.quiet, "Print warnings and errors only");
  app.footer(
      "Prints two addresses, one for designers and one for who only looks on, or one for each "
      "person; whoever has one may come in.\nExit codes: 0 ok, 1 runtime error (port in use), 2 "
      "usage, 3 bad file (page, "
      "tokens, certificate, log).");
  line.exit_code = app.read(argc, argv, [&] { check_together(o); });
  return line;
}

}  // namespace mortise::web

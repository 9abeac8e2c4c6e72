#pragma once
#include <fstream>
#include <sstream>
#include <string>

#include "tests/golden/played_session.h"
#include "tests/support/programs.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {

inline std::string scenario(const std::string& name) {
  return std::string(MORTISE_SOURCE_DIR) + "/scenarios/" + name;
}

/// The log of a session that was played as the file says, with one piece of its text otherwise.
inline Result<SessionLog> played(const std::string& name, const std::string& from = "",
                                 const std::string& to = "") {
  std::ostringstream whole;
  whole << std::ifstream(scenario(name + ".yaml")).rdbuf();
  std::string text = whole.str();
  if (!from.empty()) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  }
  const test::TemporaryFile yaml("played.yaml"), file("played.mcap");
  std::ofstream(yaml.path()) << text;
  auto session = test::play_session(yaml.path().string(), scenario(name + ".play.yaml"));
  if (!session) return session.error();
  if (const Status written = test::write_log(*session, file.path()); !written)
    return written.error();
  return read_session_log(file.path());
}

}  // namespace mortise

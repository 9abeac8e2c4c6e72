#include "server/discovery/report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace mortise {

std::string discovery_text(const DiscoveryCounts& c) {
  std::string text;
  const auto row = [&text](const char* what, std::uint64_t number) {
    text += fmt::format("  {:<52} {:>12}\n", what, number);
  };
  row("announcements taken", c.heard);
  row("passed on to others", c.passed_on);
  row("not passed on: the network did not take it", c.not_sent);
  row("dropped: malformed, or too large", c.malformed);
  row("dropped: no announcement", c.no_announcement);
  row("dropped: does not say what it is for", c.no_purpose);
  row("dropped: not from the host that it names", c.from_elsewhere);
  row("dropped: was here for something else", c.other_purpose);
  row("dropped: takes leave, and was not here", c.unknown);
  row("dropped: too often", c.too_often);
  row("dropped: too many participants or servers", c.full);
  row("participants at most", c.most_participants);
  row("participants at the end", c.participants);
  row("of them servers", c.servers);
  row("sessions at the end", c.sessions);
  return text;
}

std::string discovery_json(const DiscoveryCounts& c) {
  nlohmann::ordered_json document = {{"heard", c.heard},
                                     {"passed_on", c.passed_on},
                                     {"not_sent", c.not_sent},
                                     {"malformed", c.malformed},
                                     {"no_announcement", c.no_announcement},
                                     {"no_purpose", c.no_purpose},
                                     {"from_elsewhere", c.from_elsewhere},
                                     {"other_purpose", c.other_purpose},
                                     {"unknown", c.unknown},
                                     {"too_often", c.too_often},
                                     {"full", c.full},
                                     {"most_participants", c.most_participants},
                                     {"participants", c.participants},
                                     {"servers", c.servers},
                                     {"sessions", c.sessions}};
  return json_text(document) + "\n";
}

}  // namespace mortise

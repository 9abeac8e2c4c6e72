#include "client/report/clash_picture.h"

#include <fmt/format.h>

#include <optional>

#include "client/picture/picture.h"
#include "client/report/moments.h"

namespace mortise {
namespace {

// An end has no region any more, and a review nothing new of one.
bool is_judged(const ClashEvent& event) {
  return event.kind == ClashEvent::Kind::kBegin || event.kind == ClashEvent::Kind::kChange;
}

std::optional<std::uint64_t> tick_of(const SessionLog& log, const ClashMoment& wanted) {
  std::optional<std::uint64_t> last;
  for (const TickRecord& record : log.ticks)
    for (const ClashEvent& event : record.report.events)
      if (event.clash == wanted.clash && event.tick <= wanted.until_tick && is_judged(event))
        last = event.tick;
  return last;
}

}  // namespace

Result<std::string> clash_picture(const SessionLog& log, const ClashMoment& wanted) {
  const auto tick = tick_of(log, wanted);
  if (!tick)
    return fail(Code::kNotFound,
                fmt::format("the log has no clash {} up to that time", wanted.clash.value));
  Result<std::string> drawn =
      fail(Code::kRuntime, fmt::format("clash {} was not drawn", wanted.clash.value));
  const Status done = for_moments(log, {{*tick, wanted.clash}}, [&](const Moment& moment) {
    const ClashEvent& event = moment.event;
    if (is_judged(event))
      drawn = region_picture({&moment.world, event.part_a, event.part_b, &event.verdict},
                             Canvas::Format::kSvg);
  });
  if (!done) return done.error();
  return drawn;
}

}  // namespace mortise

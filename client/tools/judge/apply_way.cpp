#include "client/tools/judge/apply_way.h"

#include <fmt/format.h>

#include "client/picture/picture.h"
#include "common/messages/length_text.h"
#include "common/session/tick/way_out.h"

namespace mortise {

Result<std::string> apply_way(World& world, const JudgeReport& report, std::size_t number) {
  const NumberedRegion* chosen = nullptr;
  const std::vector<NumberedRegion> regions = numbered_regions(report);
  for (const NumberedRegion& region : regions) {
    const bool wanted = number > 0
                            ? region.number == number
                            : region.verdict->separation_way != SeparationWay::kNone &&
                                  (chosen == nullptr || region.verdict->collision_class >
                                                            chosen->verdict->collision_class);
    if (wanted) chosen = &region;
  }
  if (chosen == nullptr || chosen->verdict->separation_way == SeparationWay::kNone)
    return fail(Code::kNotFound,
                number > 0 ? fmt::format("region {} tells no way out: nothing was moved", number)
                           : "no region tells a way out: nothing was moved");
  const SeparatingMotion motion = way_out(*chosen->verdict);
  Part& part = *world.find(motion.of_b ? chosen->pair->b : chosen->pair->a);
  const double path_mm = longest_path_mm(*part.solid, part.X_WP, motion);
  part.X_WP = motion.displacement() * part.X_WP;
  return fmt::format("region {}: {} was moved out, no point of it farther than {}", chosen->number,
                     part.name, length_text(path_mm));
}

}  // namespace mortise

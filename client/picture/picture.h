#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "client/picture/canvas.h"
#include "client/picture/detail_view.h"
#include "common/base/result.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"
#include "common/session/world/world.h"

namespace mortise {

/// A region of a report by its number: 1, 2, 3 ... through all pairs, in the order in which
/// `judge_text` and the JSON document list them.
struct NumberedRegion {
  std::size_t number = 0;
  const PairVerdicts* pair = nullptr;
  const Verdict* verdict = nullptr;
};
std::vector<NumberedRegion> numbered_regions(const JudgeReport& report);

/// One region in section through its deciding point: both meshes, the surfaces that they stand for,
/// where the real surfaces may lie, overlap, thresholds, witness, and the sentence of its verdict.
/// 860 x 560 units; the bytes of an SVG or PNG. Cost: one section of both meshes, some ms.
Result<std::string> region_picture(const RegionQuery& query, Canvas::Format format);

/// Draws regions beside each other into a file that ends in .svg or .png. No number given: the
/// worst region. An error when there is no such region or the file cannot be written.
Status draw_regions(const World& world, const JudgeReport& report,
                    const std::vector<std::size_t>& numbers, const std::string& file);

}  // namespace mortise

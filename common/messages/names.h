#pragma once
#include <string_view>

#include "common/messages/command.h"
#include "common/messages/constraint.h"
#include "common/messages/event.h"
#include "common/messages/feature_info.h"
#include "common/messages/report.h"

namespace mortise {

/// Stable lower-case names, used in JSON, tables and explanations.
std::string_view name_of(CollisionClass value);
std::string_view name_of(DeviationGrade value);
std::string_view name_of(FaceShape value);
std::string_view name_of(SurfaceKind value);
std::string_view name_of(SeparationWay value);
std::string_view name_of(SeparationPath value);
std::string_view name_of(Refusal value);
std::string_view name_of(ConstraintKind value);
std::string_view name_of(CommandKind value);
std::string_view name_of(Decision::Kind value);
std::string_view name_of(ClashEvent::Kind value);
std::string_view name_of(ReviewStatus value);
std::string_view name_of(Unexamined value);
/// What a pair without a verdict does or has, as the end of a sentence about it.
std::string_view in_words(Unexamined value);
std::string_view name_of(Role value);

}  // namespace mortise

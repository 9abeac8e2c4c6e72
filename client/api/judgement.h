#pragma once
#include <mortise/judge.h>

#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judge_world.h"

namespace mortise::api {

/// Two parts where the options put them, as a scene.
mortise::Result<mortise::OpenedScene> open_pair(const Part& a, const Part& b,
                                                const JudgeOptions& options);

Judgement judgement_of(const mortise::OpenedScene& opened, const mortise::JudgeReport& report);

/// Threads that a caller may ask for.
bool is_thread_count(int threads);

}  // namespace mortise::api

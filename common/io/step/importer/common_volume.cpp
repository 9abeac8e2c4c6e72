#include "common/io/step/importer/common_volume.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <gp_Quaternion.hxx>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <optional>
#include <thread>

namespace mortise {
namespace {

// Processes: as many as there are cores, within these. At least two, so that one that hangs does
// not hold up the rest; not more than eight, chosen, as each takes memory.
constexpr std::size_t kTogether = 2, kMostTogether = 8;
constexpr std::chrono::microseconds kLook(300);  // between looks for answers

TopLoc_Location location_of(const Pose& X) {
  gp_Trsf placed;
  placed.SetRotation(gp_Quaternion(X.q.x(), X.q.y(), X.q.z(), X.q.w()));
  placed.SetTranslationPart(gp_Vec(X.p.x(), X.p.y(), X.p.z()));
  return TopLoc_Location(placed);
}

StepCommon common_of(const TopoDS_Shape& a, const TopoDS_Shape& b, const Pose& X_AB) {
  StepCommon common;
  BRepAlgoAPI_Common operation(a, b.Moved(location_of(X_AB)));
  if (!operation.IsDone() || operation.HasErrors()) return common;
  common.volume_mm3 = 0.0;
  // Each piece by itself: a thin sliver elsewhere must not make a thick one seem thin.
  for (TopExp_Explorer x(operation.Shape(), TopAbs_SOLID); x.More(); x.Next()) {
    GProp_GProps volume, surface;
    BRepGProp::VolumeProperties(x.Current(), volume, 1e-4, true);
    BRepGProp::SurfaceProperties(x.Current(), surface);
    const double own_mm3 = std::max(0.0, volume.Mass());
    common.volume_mm3 += own_mm3;
    if (surface.Mass() > 0.0)
      common.thickness_mm = std::max(common.thickness_mm, 2.0 * own_mm3 / surface.Mass());
  }
  return common;
}

// A process with one query, and where it answers.
struct Running {
  pid_t child = -1;
  int answers = -1;
  std::size_t query = 0;
};

Running start(const StepTree& tree, const StepCommonQuery& query, unsigned seconds) {
  Running running;
  int ends[2];
  if (pipe(ends) != 0) return running;
  running.child = fork();
  if (running.child == 0) {
    close(ends[0]);
    const rlimit limit{seconds, seconds};
    setrlimit(RLIMIT_CPU, &limit);
    StepCommon common;
    try {
      common = common_of(tree.solids[query.part_a], tree.solids[query.part_b], query.X_AB);
    } catch (...) {
      common = {};
    }
    const ssize_t written = write(ends[1], &common, sizeof common);
    _exit(written == sizeof common ? 0 : 1);
  }
  close(ends[1]);
  running.answers = ends[0];
  fcntl(running.answers, F_SETFL, O_NONBLOCK);
  return running;
}

// Its answer, when it has one or has ended.
std::optional<StepCommon> answer_of(const Running& running) {
  StepCommon answer;
  if (running.answers < 0) return answer;
  const ssize_t n =
      running.child < 0 ? 0 : read(running.answers, &answer, sizeof answer);  // all at once
  if (n < 0 && errno == EAGAIN) return std::nullopt;
  if (n != sizeof answer) answer = {};
  close(running.answers);
  if (running.child > 0) waitpid(running.child, nullptr, 0);
  return answer;
}

}  // namespace

std::vector<StepCommon> common_volumes(const StepTree& tree,
                                       const std::vector<StepCommonQuery>& queries,
                                       const CommonLimits& limits) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::seconds(limits.all_s);
  const std::size_t together =
      std::clamp<std::size_t>(std::thread::hardware_concurrency(), kTogether, kMostTogether);
  std::vector<StepCommon> answers(queries.size());
  std::vector<Running> running;
  // What still runs at the end of the time is ended with this process.
  for (std::size_t next = 0; Clock::now() < deadline;) {
    while (next < queries.size() && running.size() < together) {
      const StepCommonQuery& query = queries[next++];
      if (query.part_a >= tree.solids.size() || query.part_b >= tree.solids.size()) continue;
      running.push_back(start(tree, query, limits.each_s));
      running.back().query = next - 1;
    }
    if (running.empty()) break;
    const std::size_t before = running.size();
    std::erase_if(running, [&](const Running& one) {
      const std::optional<StepCommon> answer = answer_of(one);
      if (answer) answers[one.query] = *answer;
      return answer.has_value();
    });
    if (running.size() == before) std::this_thread::sleep_for(kLook);
  }
  return answers;
}

}  // namespace mortise

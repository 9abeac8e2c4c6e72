#include "common/io/step/importer/common_volume.h"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <gp_Quaternion.hxx>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

namespace mortise {
namespace {

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
  GProp_GProps volume, surface;
  BRepGProp::VolumeProperties(operation.Shape(), volume, 1e-4, true);
  BRepGProp::SurfaceProperties(operation.Shape(), surface);
  common.volume_mm3 = std::max(0.0, volume.Mass());
  common.area_mm2 = surface.Mass();
  return common;
}

StepCommon in_a_process(const StepTree& tree, const StepCommonQuery& query, unsigned seconds) {
  StepCommon common;
  int ends[2];
  if (pipe(ends) != 0) return common;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const rlimit limit{seconds, seconds};
    setrlimit(RLIMIT_CPU, &limit);
    try {
      common = common_of(tree.solids[query.part_a], tree.solids[query.part_b], query.X_AB);
    } catch (...) {
      common = {};
    }
    const ssize_t written = write(ends[1], &common, sizeof common);
    _exit(written == sizeof common ? 0 : 1);
  }
  close(ends[1]);
  StepCommon answer;
  if (child < 0 || read(ends[0], &answer, sizeof answer) != sizeof answer) answer = {};
  close(ends[0]);
  if (child > 0) waitpid(child, nullptr, 0);
  return answer;
}

}  // namespace

std::vector<StepCommon> common_volumes(const StepTree& tree,
                                       const std::vector<StepCommonQuery>& queries,
                                       unsigned seconds_each) {
  std::vector<StepCommon> answers;
  for (const StepCommonQuery& query : queries) {
    const bool known = query.part_a < tree.solids.size() && query.part_b < tree.solids.size();
    answers.push_back(known ? in_a_process(tree, query, seconds_each) : StepCommon{});
  }
  return answers;
}

}  // namespace mortise

#include "tests/unit/ccd/workload.h"

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

namespace mortise::testing {
namespace {

using Row = std::map<std::string, std::string>;

bool load_csv(const std::string& file, std::vector<Row>& rows) {
  std::ifstream in(file);
  std::string line, cell;
  if (!std::getline(in, line)) return false;
  std::vector<std::string> names;
  for (std::istringstream s(line); std::getline(s, cell, ',');) names.push_back(cell);
  while (std::getline(in, line)) {
    Row row;
    std::size_t i = 0;
    for (std::istringstream s(line); std::getline(s, cell, ',') && i < names.size();)
      row[names[i++]] = cell;
    rows.push_back(row);
  }
  return true;
}

double number(const Row& row, const std::string& name) { return std::stod(row.at(name)); }

Vec3 vector_of(const Row& row, const std::string& prefix) {
  return {number(row, prefix + "x"), number(row, prefix + "y"), number(row, prefix + "z")};
}

Pose pose_of(const Row& row, const std::string& prefix) {
  const Quat q(number(row, prefix + "qw"), number(row, prefix + "qx"), number(row, prefix + "qy"),
               number(row, prefix + "qz"));
  return {q.normalized(), vector_of(row, prefix)};
}

}  // namespace

std::string data_folder() {
  const char* set = std::getenv("MORTISE_DATA");
  return set != nullptr ? set : std::string(MORTISE_SOURCE_DIR) + "/../shared/data";
}

std::vector<std::string> workload_names() {
  return {"sphere10k", "peg_c0.10", "peg_c0.50", "gears", "wall"};
}

bool load_plain_obj(const std::string& file, TriangleMesh& mesh) {
  std::ifstream in(file);
  if (!in) return false;
  for (std::string line; std::getline(in, line);) {
    std::istringstream s(line);
    std::string kind;
    s >> kind;
    if (kind == "v") {
      Vec3 p;
      s >> p.x() >> p.y() >> p.z();
      mesh.points_mm.push_back(p);
    } else if (kind == "f") {
      std::array<std::uint32_t, 3> t{};
      for (auto& index : t) {
        std::string corner;
        s >> corner;
        index = static_cast<std::uint32_t>(std::stoul(corner) - 1);
      }
      mesh.triangles.push_back(t);
    }
  }
  return !mesh.triangles.empty();
}

bool load_workload(const std::string& name, Workload& workload) {
  const std::string folder = data_folder() + "/ccd-motions/" + name + "/";
  TriangleMesh moving, fixed;
  std::vector<Row> motions, truth;
  if (!load_plain_obj(folder + "moving.obj", moving) ||
      !load_plain_obj(folder + "static.obj", fixed) || !load_csv(folder + "motions.csv", motions) ||
      !load_csv(folder + "truth.csv", truth) || motions.size() != truth.size())
    return false;
  workload.name = name;
  workload.moving = std::make_shared<Solid>(std::move(moving));
  workload.fixed = std::make_shared<Solid>(std::move(fixed));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Pose start = pose_of(motions[i], "start_"), end = pose_of(motions[i], "end_");
    const Vec3 reference = vector_of(motions[i], "ref_");
    Workload::Row row;
    row.id = std::stoi(motions[i].at("id"));
    row.motion = motions[i].at("path") == "screw" ? screw_motion(start, end, reference)
                                                  : linear_motion(start, end, reference);
    row.contact = truth[i].at("state") == "contact";
    row.t_contact = number(truth[i], "t_contact");
    row.max_speed_mm = number(truth[i], "max_speed_mm");
    workload.rows.push_back(row);
  }
  return true;
}

}  // namespace mortise::testing

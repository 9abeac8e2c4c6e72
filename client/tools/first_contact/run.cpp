#include "client/tools/first_contact/run.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/tools/first_contact/motions_file.h"
#include "common/base/json_text.h"
#include "common/base/nearest_rank.h"
#include "common/base/ranges.h"
#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "common/ccd/start_state.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/mesh/obj_exact.h"

namespace mortise {
namespace {

const char* name_of(ContactState state) {
  switch (state) {
    case ContactState::kFree:
      return "free";
    case ContactState::kContact:
      return "contact";
    case ContactState::kTouchingAtStart:
      return "touching_at_start";
    case ContactState::kOverlappingAtStart:
      return "overlapping_at_start";
    case ContactState::kUndecided:
    case ContactState::kUnknown:
      break;
  }
  return "undecided";
}

Result<SolidPtr> load(const std::string& file, double unit_mm) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  TriangleMesh mesh;
  if (extension == ".obj") {
    Result<CleanMesh> clean = read_obj_exact(file, unit_mm);
    if (!clean) return clean.error();
    if (clean->degenerate_dropped > 0)
      std::fprintf(stderr, "%s: %llu triangles without area were dropped\n", file.c_str(),
                   static_cast<unsigned long long>(clean->degenerate_dropped));
    mesh = std::move(clean->mesh);
  } else {
    Result<ImportedMesh> imported = import_mesh(file, unit_mm);
    if (!imported) return imported.error();
    for (const std::string& note : notes_of(imported->report))
      std::fprintf(stderr, "%s: %s\n", file.c_str(), note.c_str());
    if (imported->report.quantum_mm > 0.0)
      std::fprintf(stderr, "%s: coordinates are rounded to %.2g mm on import; an OBJ file is not\n",
                   file.c_str(), imported->report.quantum_mm);
    mesh = std::move(imported->mesh);
  }
  for (const Vec3& point : mesh.points_mm)
    if (!within(point.array().abs().maxCoeff(), kLongest_mm))
      return fail(Code::kInvalidInput,
                  file + ": a coordinate is beyond ±1e9 mm; correct the value or the unit");
  std::fprintf(stderr, "%s: %zu triangles\n", file.c_str(), mesh.triangles.size());
  return SolidPtr(std::make_shared<Solid>(std::move(mesh)));
}

struct Row {
  FirstContact answer;
  bool hidden = false;  ///< surfaces keep clear, but what has no inside may hold the other
  double distance_mm = 0.0;
  double time_us = 0.0;
};

Row ask(const ContactQuery& query, CcdScratch& scratch) {
  Row row;
  const auto start = std::chrono::steady_clock::now();
  row.answer = first_contact(query, scratch);
  row.time_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  row.distance_mm = row.answer.distance_mm;
  const bool free = row.answer.state == ContactState::kFree;
  for (const double t : {0.0, 1.0})
    row.hidden |=
        free && containment(*query.a, query.motion_a.pose_at(t), *query.b,
                            query.motion_b.pose_at(t), query.accuracy_mm) == Containment::kUnknown;
  if (free || row.answer.state == ContactState::kUndecided)
    row.distance_mm = distance(*query.a, query.motion_a.pose_at(row.answer.t_clear), *query.b,
                               query.motion_b.pose_at(row.answer.t_clear), scratch)
                          .distance_mm;
  return row;
}

const char* state_of(const Row& row) {
  return row.hidden ? "no_inside" : name_of(row.answer.state);
}

nlohmann::ordered_json document_of(const FirstContactOptions& options,
                                   const std::vector<NamedMotion>& motions,
                                   const std::vector<Row>& rows) {
  nlohmann::ordered_json document;
  document["schema"] = "mortise/first-contact/1";
  document["moving"] = options.moving;
  document["static"] = options.fixed;
  document["accuracy_mm"] = options.accuracy_mm;
  document["counts"] = {
      {"free", 0},      {"contact", 0},  {"touching_at_start", 0}, {"overlapping_at_start", 0},
      {"undecided", 0}, {"no_inside", 0}};
  document["motions"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const FirstContact& answer = rows[i].answer;
    const std::string state = state_of(rows[i]);
    document["counts"][state] = document["counts"][state].get<int>() + 1;
    document["motions"].push_back({{"id", motions[i].id},
                                   {"state", state},
                                   {"t_clear", answer.t_clear},
                                   {"t_contact", answer.t_contact},
                                   {"distance_mm", rows[i].distance_mm},
                                   {"point_mm", nullptr},
                                   {"time_us", rows[i].time_us}});
    if (answer.state == ContactState::kContact || answer.state == ContactState::kTouchingAtStart)
      document["motions"].back()["point_mm"] = {answer.point_b_W.x(), answer.point_b_W.y(),
                                                answer.point_b_W.z()};
  }
  return document;
}

void summarize(const std::vector<Row>& rows) {
  int count[6] = {}, hidden = 0;
  std::vector<double> time_us;
  for (const Row& row : rows) {
    ++(row.hidden ? hidden : count[static_cast<int>(row.answer.state)]);
    time_us.push_back(row.time_us);
  }
  std::sort(time_us.begin(), time_us.end());
  std::printf(
      "%zu motions: %d free, %d contact, %d undecided, %d touching at start, %d overlapping at "
      "start; median %.1f us, p99 %.1f us\n",
      rows.size(), count[static_cast<int>(ContactState::kFree)],
      count[static_cast<int>(ContactState::kContact)],
      count[static_cast<int>(ContactState::kUndecided)],
      count[static_cast<int>(ContactState::kTouchingAtStart)],
      count[static_cast<int>(ContactState::kOverlappingAtStart)], quantile_of_sorted(time_us, 0.5),
      quantile_of_sorted(time_us, 0.99));
  if (hidden > 0)
    std::printf("%d motions: no inside: one mesh is open and the other may lie within it\n",
                hidden);
}

Status write(const std::string& file, const std::vector<NamedMotion>& motions,
             const std::vector<Row>& rows) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (out == nullptr) return fail(Code::kRuntime, file + ": cannot be written; check the folder");
  std::fprintf(out, "id,state,t_clear,t_contact,distance_mm,time_us\n");
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::fprintf(out, "%s,%s,%.17g,%.17g,%.17g,%.17g\n", motions[i].id.c_str(), state_of(rows[i]),
                 rows[i].answer.t_clear, rows[i].answer.t_contact, rows[i].distance_mm,
                 rows[i].time_us);
  const bool good = std::ferror(out) == 0;
  if (std::fclose(out) != 0 || !good)
    return fail(Code::kRuntime, file + ": writing broke off; check the disk");
  return ok();
}

}  // namespace

Status run_first_contact(const FirstContactOptions& options) {
  const Result<SolidPtr> moving = load(options.moving, options.unit_mm);
  if (!moving) return moving.error();
  const Result<SolidPtr> fixed = load(options.fixed, options.unit_mm);
  if (!fixed) return fixed.error();
  const Result<std::vector<NamedMotion>> motions = read_motions(options.motions, options.unit_mm);
  if (!motions) return motions.error();
  // Trees and topology are made once a mesh; no motion pays for them.
  for (const SolidPtr& solid : {*moving, *fixed}) {
    solid->bvh();
    solid->topology();
    solid->shells();
  }
  CcdScratch scratch;
  std::vector<Row> rows;
  for (const NamedMotion& motion : *motions) {
    ContactQuery query;
    query.a = moving->get();
    query.b = fixed->get();
    query.motion_a = motion.motion;
    query.motion_b = still_motion({});
    query.accuracy_mm = options.accuracy_mm;
    query.work_cap = options.work_cap;
    rows.push_back(ask(query, scratch));
    if (rows.size() % 100 == 0)
      std::fprintf(stderr, "%zu of %zu motions\n", rows.size(), motions->size());
  }
  if (!options.out.empty())
    if (const Status written = write(options.out, *motions, rows); !written) return written;
  if (options.json)
    std::printf("%s\n", json_text(document_of(options, *motions, rows)).c_str());
  else
    summarize(rows);
  return ok();
}

}  // namespace mortise

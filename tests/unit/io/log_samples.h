#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "common/io/log/session_log.h"

/// Made-up sessions for tests of the log: every field of every record takes unusual values.
namespace mortise::test {

/// A file name in the system's temporary folder that is free now and removed at the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name) {
    static std::uint64_t count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("mortise_" + std::to_string(std::random_device{}()) + "_" + std::to_string(++count) +
             "_" + name);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline TriangleMesh tetrahedron(double size_mm) {
  return {{Vec3(0, 0, 0), Vec3(size_mm, 0, 0), Vec3(0, size_mm, 0), Vec3(0, 0, size_mm)},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

struct SampleHeader {
  TriangleMesh small = tetrahedron(1.0), large = tetrahedron(20.0);
  LogHeader header{.session = "sample",
                   .scenario_name = "sample.yaml",
                   .scenario_yaml =
                       "name: sample  # Ø20 H7/g6\nunits: mm\nparts:\n"
                       "  - {name: a, mesh: {file: part0.stl, unit: mm}}\n"
                       "  - {name: b, mesh: {file: part1.stl, unit: mm}}\n"
                       "  - {name: c, mesh: {file: part2.stl, unit: mm}}\n",
                   .meshes = {{mesh_hash(small), &small}, {mesh_hash(large), &large}},
                   .mesh_of_part = {mesh_hash(small), mesh_hash(large), mesh_hash(small)},
                   .imports = {}};
  SampleHeader() {
    for (int part = 0; part < 3; ++part) {
      ImportReport report;
      report.file = "part" + std::to_string(part) + ".stl";
      report.quantum_mm = 1.0 / 3.0;
      report.closed = true;
      report.notes = {"a \"quoted\" note"};
      header.imports.push_back(report);
    }
  }
};

inline TickRecord sample_tick(std::uint64_t tick, std::uint64_t seed) {
  std::mt19937_64 random(seed * 1'000'003 + tick);
  std::uniform_real_distribution<double> uniform(-100.0, 100.0);
  const auto vector = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  TickRecord record;
  record.tick = record.report.tick = tick;
  record.time_ns = static_cast<std::int64_t>(tick) * 16'666'667;
  record.report.state_hash = random();
  if (tick == 1)
    record.decisions.push_back({Decision::Kind::kJoin, UserId{1}, PartId{}, "Ada \xc3\x98"});
  if (tick % 7 == 3) {
    Decision decision{Decision::Kind::kReview, UserId{1}, PartId{}, "", Role::kBot};
    decision.details = {
        {PartId{3}, PartId{400}}, PartId{2},       "bore", "shaft",        UserId{9}, ClashId{77},
        ReviewStatus::kResolved,  "text \xc3\x98", {},     ConstraintId{5}};
    if (tick % 2 == 0)
      decision.details.constraint = {
          ConstraintKind::kTangent, {PartId{1}, "a"}, {PartId{2}, "b"}, -0.1, true};
    record.decisions.push_back(decision);
  }
  if (tick % 50 == 2) record.decisions.push_back({Decision::Kind::kGrab, UserId{1}, PartId{2}, ""});
  for (std::uint64_t i = 0; i < tick % 4; ++i) {
    Increment increment{UserId{1}, PartId{2}, tick * 4 + i, vector(), Vec3::Zero()};
    if (i == 1) increment.rotation_rad = Vec3(0.1, -0.0, 0.0);
    if (i == 2) increment.translation_mm.x() = std::numeric_limits<double>::quiet_NaN();
    record.increments.push_back(increment);
  }
  if (tick % 4 != 0) {
    const Vec3 p = vector();
    const Quat q = Quat(uniform(random), uniform(random), uniform(random), uniform(random));
    record.report.moved.push_back({PartId{2}, UserId{1}, Pose{q.normalized(), p}});
  }
  if (tick % 4 == 3)
    record.report.refused.push_back({UserId{1}, PartId{2}, tick * 4 + 2, Refusal::kNotFinite});
  if (tick % 10 == 5) {
    ClashEvent event;
    event.kind = ClashEvent::Kind::kBegin;
    event.seq = tick / 10 + 1;
    event.tick = tick;
    event.clash = ClashId{static_cast<std::uint32_t>(tick)};
    event.part_a = PartId{1};
    event.part_b = PartId{2};
    event.user = UserId{1};
    event.verdict.collision_class = CollisionClass::kPotential;
    event.verdict.delta_mm = {0.1 + 0.2, 1.0 / 3.0};
    event.verdict.gpd_mm = {0.1, std::numeric_limits<double>::infinity()};
    event.verdict.point_W = vector();
    event.verdict.has_witness = true;
    event.verdict.shape_a = FaceShape::kConcave;
    event.verdict.grade = DeviationGrade::kRecognizedFeature;
    event.verdict.face_a = "bore";
    event.verdict.explanation = "overlap 48.2 \xc2\xb5m";
    event.t_contact = uniform(random);
    event.t_potential = 0.1;  // t_real: never
    event.verdict.separation_way = SeparationWay::kAxis;
    event.begin_tick = tick;
    event.worst_class = CollisionClass::kReal;
    event.worst_delta_mm = {-1.0, 2.0};
    event.cause = Decision::Kind::kSetTolerance;
    event.review = {ReviewStatus::kActive, "no longer approved", UserId{2}, tick};
    event.approval_lost = tick % 20 == 5;
    record.report.events.push_back(event);
  }
  record.report.counters.increments = {record.increments.size(), record.increments.size()};
  return record;
}

/// Writes ticks 1..count and closes; the log is on disk afterwards.
inline Status write_sample(const std::filesystem::path& file, std::uint64_t count,
                           const LogOptions& options = {}) {
  const SampleHeader sample;
  auto writer = SessionLogWriter::create(file, sample.header, options);
  if (!writer) return writer.error();
  for (std::uint64_t tick = 1; tick <= count; ++tick) (*writer)->record(sample_tick(tick, 7));
  return (*writer)->close();
}

}  // namespace mortise::test

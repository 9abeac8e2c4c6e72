#include "common/io/step/given_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>
#include <utility>

#include "common/geometry/recognition/names.h"
#include "common/math/box.h"

namespace mortise {
namespace {

// Faces that a file splits agree to the last digits of its numbers.
constexpr double kOneSurface_mm = 1e-6, kOneDirection = 1e-9;
// A volume that differs by more than the faces can tell is a fault of the tessellation.
constexpr double kVolumeShare = 1e-6;

std::string six_digits(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

Vec3 across(const Vec3& v, const Vec3& axis) { return v - v.dot(axis) * axis; }

bool same_sizes(const Surface& a, const Surface& b) {
  return std::fabs(a.radius_mm - b.radius_mm) < kOneSurface_mm &&
         std::fabs(a.tube_radius_mm - b.tube_radius_mm) < kOneSurface_mm &&
         std::fabs(a.half_angle_rad - b.half_angle_rad) < kOneDirection;
}

bool same_surface(const Surface& a, const Surface& b) {
  if (a.kind != b.kind || a.inward != b.inward || !same_sizes(a, b)) return false;
  const Vec3 between = b.point - a.point;
  const double turned = a.axis.cross(b.axis).norm();
  switch (a.kind) {
    case SurfaceKind::kPlane:
      return turned < kOneDirection && a.axis.dot(b.axis) > 0.0 &&
             std::fabs(between.dot(a.axis)) < kOneSurface_mm;
    case SurfaceKind::kCylinder:
      return turned < kOneDirection && across(between, a.axis).norm() < kOneSurface_mm;
    case SurfaceKind::kCone:
      return turned < kOneDirection && a.axis.dot(b.axis) > 0.0 && between.norm() < kOneSurface_mm;
    case SurfaceKind::kSphere:
      return between.norm() < kOneSurface_mm;
    case SurfaceKind::kTorus:
      return turned < kOneDirection && between.norm() < kOneSurface_mm;
    case SurfaceKind::kUnknown:
      break;
  }
  return false;
}

struct Gathered {
  Feature feature;
  Interval along_mm;
  std::vector<std::uint32_t> faces;
};

class Gatherer {
 public:
  Gatherer(const StepPart& part, const std::vector<std::uint32_t>& group_of_face)
      : part_(part), group_of_face_(group_of_face), triangles_of_(part.faces.size()) {
    for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t)
      triangles_of_[part.face_of_triangle[t]].push_back(static_cast<std::uint32_t>(t));
  }

  std::vector<Gathered> run() {
    for (std::uint32_t f = 0; f < part_.faces.size(); ++f)
      if (part_.faces[f].surface.kind != SurfaceKind::kUnknown && !triangles_of_[f].empty()) add(f);
    for (auto& [bucket, list] : buckets_) join_all(list);
    std::vector<Gathered> all;
    for (auto& [bucket, list] : buckets_)
      for (Gathered& gathered : list) all.push_back(std::move(gathered));
    std::sort(all.begin(), all.end(),
              [](const Gathered& a, const Gathered& b) { return order(a) < order(b); });
    return all;
  }

  const std::vector<std::uint32_t>& triangles_of(std::uint32_t face) const {
    return triangles_of_[face];
  }

 private:
  using Bucket = std::tuple<int, bool, long long, std::uint32_t>;

  void add(std::uint32_t f) {
    const StepFace& face = part_.faces[f];
    Gathered gathered;
    gathered.feature.surface = face.surface;
    gathered.feature.grade = face.surface.kind == SurfaceKind::kPlane
                                 ? DeviationGrade::kPlanar
                                 : DeviationGrade::kDeclaredFeature;
    gathered.feature.residual_mm = face.residual_mm;
    gathered.feature.origin = FeatureOrigin::kGenerated;
    gathered.feature.triangles = triangles_of_[f];
    gathered.faces = {f};
    bool first = true;
    for (const std::uint32_t t : gathered.feature.triangles)
      for (int k = 0; k < 3; ++k) {
        const double z = (part_.mesh.corner(t, k) - face.surface.point).dot(face.surface.axis);
        gathered.along_mm = first ? Interval{z, z} : hull(gathered.along_mm, {z, z});
        first = false;
      }
    const double size = face.surface.kind == SurfaceKind::kPlane
                            ? 0.0
                            : face.surface.radius_mm + face.surface.half_angle_rad;
    const bool apart = face.surface.kind == SurfaceKind::kPlane && f < group_of_face_.size();
    buckets_[{static_cast<int>(face.surface.kind), face.surface.inward, std::llround(size * 1e3),
              apart ? group_of_face_[f] : 0}]
        .push_back(std::move(gathered));
  }

  // The length of b along the axis of a, from the point of a.
  static Interval along_of(const Gathered& a, const Gathered& b) {
    const Surface &sa = a.feature.surface, &sb = b.feature.surface;
    const double shift = (sb.point - sa.point).dot(sa.axis);
    const double sign = sa.axis.dot(sb.axis) < 0.0 ? -1.0 : 1.0;
    const double lo = shift + sign * b.along_mm.lo, hi = shift + sign * b.along_mm.hi;
    return {std::min(lo, hi), std::max(lo, hi)};
  }

  // Pairs in their order, the first that join first, until none do. What does not join is asked
  // again only once one of the two has grown: of a plate with thousands of like holes each pair is
  // asked about once.
  static void join_all(std::vector<Gathered>& list) {
    for (std::size_t i = 0; i < list.size(); ++i)
      for (std::size_t j = i + 1; j < list.size();) {
        if (!join(list, i, j)) {
          ++j;
          continue;
        }
        for (std::size_t before = 0; before < i;)
          if (join(list, before, i))
            i = std::exchange(before, 0);
          else
            ++before;
        j = i + 1;
      }
  }

  // The first takes the second up, where they are one surface.
  static bool join(std::vector<Gathered>& list, std::size_t i, std::size_t j) {
    Gathered &a = list[i], &b = list[j];
    if (!same_surface(a.feature.surface, b.feature.surface)) return false;
    const Interval along = along_of(a, b);
    const bool meet =
        along.lo <= a.along_mm.hi + kOneSurface_mm && along.hi >= a.along_mm.lo - kOneSurface_mm;
    if (a.feature.surface.kind == SurfaceKind::kCylinder && !meet) return false;
    a.along_mm = hull(a.along_mm, along);
    a.feature.residual_mm = std::max(a.feature.residual_mm, b.feature.residual_mm);
    a.feature.triangles.insert(a.feature.triangles.end(), b.feature.triangles.begin(),
                               b.feature.triangles.end());
    a.faces.insert(a.faces.end(), b.faces.begin(), b.faces.end());
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(j));
    return true;
  }

  // By geometry alone: kind, larger first, then by place to a tenth of a micrometre.
  static std::tuple<std::string, double, long long, long long, long long> order(
      const Gathered& gathered) {
    const Surface& s = gathered.feature.surface;
    const Vec3 middle = s.kind == SurfaceKind::kPlane
                            ? Vec3(s.axis * s.axis.dot(s.point))
                            : Vec3(s.point + s.axis * gathered.along_mm.middle());
    const auto rounded = [](double x) { return std::llround(x * 1e4); };
    return {stem_of(s), -s.radius_mm - s.tube_radius_mm, rounded(middle.x()), rounded(middle.y()),
            rounded(middle.z())};
  }

 private:
  const StepPart& part_;
  const std::vector<std::uint32_t>& group_of_face_;
  std::vector<std::vector<std::uint32_t>> triangles_of_;
  std::map<Bucket, std::vector<Gathered>> buckets_;
};

double area_of(const TriangleMesh& mesh, std::uint32_t t) {
  return 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0))
                   .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                   .norm();
}

// The mesh encloses what the exact solids do, but for what lies between mesh and surfaces.
std::string volume_note(const StepPart& part) {
  if (part.open_edges > 0) return {};
  const double volume = signed_volume_mm3(part.mesh);
  const double apart =
      std::fabs(volume - part.volume_mm3) - kVolumeShare * std::fabs(part.volume_mm3);
  double between = 0.0;
  for (std::uint32_t t = 0; t < part.mesh.triangles.size() && between < apart; ++t) {
    const StepFace& face = part.faces[part.face_of_triangle[t]];
    Interval off = face.deviation_mm;
    if (face.surface.kind != SurfaceKind::kUnknown)
      off = face.surface.signed_distance_range_mm(part.mesh.corner(t, 0), part.mesh.corner(t, 1),
                                                  part.mesh.corner(t, 2));
    between += area_of(part.mesh, t) * std::max(std::fabs(off.lo), std::fabs(off.hi));
  }
  if (apart <= between) return {};
  return "its mesh encloses " + six_digits(volume) + " mm³, its exact solids " +
         six_digits(part.volume_mm3) + " mm³: more apart than its faces explain";
}

std::vector<std::string> notes_on(const StepPart& part) {
  std::vector<std::string> notes;
  const auto note = [&](std::uint32_t count, const std::string& what) {
    if (count > 0) notes.push_back(std::to_string(count) + " " + what);
  };
  note(part.untriangulated, "faces could not be tessellated: it is open there");
  note(part.loose_faces, "faces that bound no solid were left out");
  std::uint32_t unknown = 0;
  for (const StepFace& face : part.faces) unknown += face.grade == StepFaceGrade::kUnknown;
  note(unknown - std::min(unknown, part.untriangulated),
       "freeform faces could not be measured and are taken as their mesh is");
  if (const std::string volume = volume_note(part); !volume.empty()) notes.push_back(volume);
  if (part.mirrored) notes.emplace_back("placed as a mirror image");
  return notes;
}

}  // namespace

std::vector<std::uint32_t> groups_of_faces(const StepDocument& document, std::uint32_t part) {
  std::vector<std::vector<std::size_t>> said(document.parts[part].faces.size());
  for (std::size_t i = 0; i < document.statements.size(); ++i)
    for (const auto* faces : {&document.statements[i].faces, &document.statements[i].other_faces})
      for (const StepFaceRef& ref : *faces)
        if (ref.part == part) said[ref.face].push_back(i);
  std::map<std::vector<std::size_t>, std::uint32_t> numbers = {{{}, 0}};
  std::vector<std::uint32_t> groups;
  for (const auto& statements : said)
    groups.push_back(
        numbers.try_emplace(statements, static_cast<std::uint32_t>(numbers.size())).first->second);
  return groups;
}

StepPartGiven given_part(const StepPart& part, const std::string& file,
                         const std::vector<std::uint32_t>& group_of_face) {
  auto given = std::make_shared<GivenPart>();
  given->file = file;
  given->product = part.name;
  given->mesh = part.mesh;
  given->volume_mm3 = part.volume_mm3;
  given->notes = notes_on(part);
  StepPartGiven result;
  result.feature_of_face.assign(part.faces.size(), -1);
  Gatherer gatherer(part, group_of_face);
  std::map<std::string, int> numbers;
  for (Gathered& gathered : gatherer.run()) {
    const std::string kind = stem_of(gathered.feature.surface);
    gathered.feature.name = kind + "_" + std::to_string(++numbers[kind]);
    std::sort(gathered.feature.triangles.begin(), gathered.feature.triangles.end());
    for (const std::uint32_t f : gathered.faces)
      result.feature_of_face[f] = static_cast<std::int32_t>(given->features.size());
    given->features.push_back(std::move(gathered.feature));
  }
  for (std::uint32_t f = 0; f < part.faces.size(); ++f)
    if (part.faces[f].grade == StepFaceGrade::kMeasured && !gatherer.triangles_of(f).empty())
      given->freeform.push_back({part.faces[f].deviation_mm, gatherer.triangles_of(f)});
  result.part = std::move(given);
  return result;
}

namespace {

// The boxes of all instances, in the world.
std::vector<Box> boxes_of(const StepDocument& document) {
  std::vector<Box> of_part(document.parts.size()), boxes;
  for (std::size_t i = 0; i < document.parts.size(); ++i)
    for (const Vec3& point : document.parts[i].mesh.points_mm) of_part[i].add(point);
  for (const StepInstance& instance : document.instances) {
    const Box& own = of_part[instance.part];
    Box box;
    for (int corner = 0; corner < 8 && !own.empty(); ++corner)
      box.add(instance.X_WP * Vec3((corner & 1) != 0 ? own.hi.x() : own.lo.x(),
                                   (corner & 2) != 0 ? own.hi.y() : own.lo.y(),
                                   (corner & 4) != 0 ? own.hi.z() : own.lo.z()));
    if (!box.empty()) boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

bool is_crowded(const StepDocument& document) {
  std::vector<Box> boxes = boxes_of(document);
  Box all;
  for (const Box& box : boxes) all.add(box.center());
  if (all.empty()) return false;
  int axis = 0;
  all.half().maxCoeff(&axis);
  std::ranges::sort(boxes, {}, [&](const Box& box) { return box.lo[axis]; });
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < boxes.size() && pairs <= kMostStepPairs; ++i)
    for (std::size_t k = i + 1; k < boxes.size() && boxes[k].lo[axis] <= boxes[i].hi[axis]; ++k)
      pairs += boxes[i].overlaps(boxes[k]) ? 1 : 0;
  return pairs > kMostStepPairs;
}

}  // namespace mortise

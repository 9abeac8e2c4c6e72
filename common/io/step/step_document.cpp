#include "common/io/step/step_document.h"

#include <cmath>
#include <set>

#include "common/base/ranges.h"
#include "common/io/state/bytes.h"
#include "common/math/unit.h"

namespace mortise {
namespace {

// "STS2", "STQ1", "STA1".
constexpr std::uint32_t kDocument = 0x32535453, kQueries = 0x31515453, kAnswers = 0x31415453;
// Longer than names and notes are; a file cannot fill memory with them.
constexpr std::size_t kLongestStepText = 4096;

Error damaged(const std::string& what) {
  return fail(Code::kRuntime, "the STEP importer's answer is damaged (" + what + ")");
}

// 1. writing

void put(ByteWriter& out, const std::string& text) { out.string(text.substr(0, kLongestStepText)); }
void put(ByteWriter& out, const Vec3& v) {
  for (int i = 0; i < 3; ++i) out.f64(v[i]);
}
void put(ByteWriter& out, const Pose& X) {
  put(out, X.p);
  for (const double q : {X.q.w(), X.q.x(), X.q.y(), X.q.z()}) out.f64(q);
}

void put(ByteWriter& out, const StepFace& face) {
  out.u8(static_cast<std::uint8_t>(face.grade));
  const Surface& s = face.surface;
  out.u8(static_cast<std::uint8_t>(s.kind));
  out.u8(s.inward ? 1 : 0);
  put(out, s.point);
  put(out, s.axis);
  for (const double x : {s.radius_mm, s.tube_radius_mm, s.half_angle_rad, face.residual_mm,
                         face.deviation_mm.lo, face.deviation_mm.hi})
    out.f64(x);
}

void put(ByteWriter& out, const StepPart& part) {
  put(out, part.name);
  out.u32(static_cast<std::uint32_t>(part.mesh.points_mm.size()));
  out.u32(static_cast<std::uint32_t>(part.mesh.triangles.size()));
  out.u32(static_cast<std::uint32_t>(part.faces.size()));
  for (const Vec3& point : part.mesh.points_mm) put(out, point);
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    for (const std::uint32_t corner : part.mesh.triangles[t]) out.u32(corner);
    out.u32(part.face_of_triangle[t]);
  }
  for (const StepFace& face : part.faces) put(out, face);
  out.f64(part.volume_mm3);
  for (const std::uint32_t n :
       {part.solids, part.open_edges, part.untriangulated, part.loose_faces})
    out.u32(n);
  out.u8(part.mirrored ? 1 : 0);
}

void put(ByteWriter& out, const std::vector<StepFaceRef>& faces) {
  out.u32(static_cast<std::uint32_t>(faces.size()));
  for (const StepFaceRef& ref : faces) {
    out.u32(ref.part);
    out.u32(ref.face);
  }
}

void put(ByteWriter& out, const StepStatement& s) {
  out.u8(static_cast<std::uint8_t>(s.kind));
  out.u32(s.entity);
  put(out, s.name);
  for (const double x : {s.value, s.upper, s.lower, s.limit_upper, s.limit_lower, s.outside})
    out.f64(x);
  put(out, s.code);
  put(out, s.modifiers);
  put(out, s.faces);
  put(out, s.other_faces);
  out.u32(s.faces_lost);
}

// 2. reading: nothing is trusted

class StepReader {
 public:
  explicit StepReader(std::span<const std::byte> bytes) : in_(bytes) {}

  Result<StepDocument> document() {
    StepDocument d;
    if (in_.u32() != kDocument) return damaged("it is not one of ours");
    d.refusal = text();
    const std::uint32_t parts = count(60), instances = count(60), statements = count(60);
    const std::uint32_t not_solid = count(4), notes = count(4);
    if (instances > kMostStepInstances) return damaged("too many instances");
    for (std::uint32_t i = 0; good() && i < parts; ++i) d.parts.push_back(part());
    std::set<std::string> paths;
    for (std::uint32_t i = 0; good() && i < instances; ++i) {
      d.instances.push_back(instance(d.parts.size()));
      if (!paths.insert(d.instances.back().path).second) wrong("a path stands twice");
    }
    for (std::uint32_t i = 0; good() && i < statements; ++i)
      d.statements.push_back(statement(d.parts));
    for (std::uint32_t i = 0; good() && i < not_solid; ++i) d.not_solid.push_back(text());
    for (std::uint32_t i = 0; good() && i < notes; ++i) d.notes.push_back(text());
    if (!wrong_.empty()) return damaged(wrong_);
    if (!in_.at_end()) return damaged("its length is not what it states");
    return d;
  }

 private:
  bool good() const { return in_.ok() && wrong_.empty(); }
  void wrong(const char* what) {
    if (wrong_.empty()) wrong_ = what;
  }
  std::uint32_t count(std::uint64_t least_bytes) {
    const std::uint32_t n = in_.u32();
    in_.room_for(n, least_bytes);
    return in_.ok() ? n : 0;
  }
  std::string text() {
    const std::uint32_t size = in_.u32();
    if (size > kLongestStepText) {
      wrong("a text is too long");
      return {};
    }
    return one_line(in_.text(size));
  }
  double number(double most = kLongest_mm) {
    const double x = in_.f64();
    if (!(std::fabs(x) <= most)) wrong("a number is not finite, or far too large");
    return x;
  }
  double number_or_none() {
    const double x = in_.f64();
    if (!std::isnan(x) && !(std::fabs(x) <= kLongest_mm)) wrong("a number is far too large");
    return x;
  }
  Vec3 vector(double most = kLongest_mm) {
    const double x = number(most), y = number(most), z = number(most);
    return {x, y, z};
  }
  Vec3 direction() {
    const Vec3 v = vector(2.0);
    if (std::fabs(v.norm() - 1.0) > 1e-6) wrong("a direction is not of length 1");
    return is_unit(v) ? v : Vec3(v.normalized());
  }
  Pose pose() {
    Pose X;
    X.p = vector();
    const double w = number(2.0), x = number(2.0), y = number(2.0), z = number(2.0);
    X.q = Quat(w, x, y, z);
    if (std::fabs(X.q.norm() - 1.0) > 1e-6) wrong("a rotation is none");
    return X;
  }

  StepFace face() {
    StepFace face;
    const std::uint8_t grade = in_.u8(), kind = in_.u8();
    if (grade > 3 || kind >= kSurfaceKindCount) wrong("a face is of no known kind");
    if (!good()) return face;
    face.grade = static_cast<StepFaceGrade>(grade);
    Surface& s = face.surface;
    s.kind = static_cast<SurfaceKind>(kind);
    s.inward = in_.u8() != 0;
    s.point = vector();
    s.axis = direction();
    s.radius_mm = number();
    s.tube_radius_mm = number();
    s.half_angle_rad = number();
    face.residual_mm = number();
    face.deviation_mm.lo = number();
    face.deviation_mm.hi = number();
    const bool round = s.kind == SurfaceKind::kCylinder || s.kind == SurfaceKind::kSphere;
    const bool torus = s.kind == SurfaceKind::kTorus;
    if ((round && !(s.radius_mm > 0.0)) ||
        (torus && !(s.tube_radius_mm > 0.0 && s.radius_mm > s.tube_radius_mm)) ||
        (s.kind == SurfaceKind::kCone && !(s.half_angle_rad > 0.0 && s.half_angle_rad < 1.5708)))
      wrong("a surface has no such size");
    if (face.residual_mm < 0.0 || face.deviation_mm.lo > face.deviation_mm.hi)
      wrong("a deviation is turned round");
    return face;
  }

  StepPart part() {
    StepPart part;
    part.name = text();
    const std::uint32_t points = in_.u32(), triangles = in_.u32(), faces = in_.u32();
    in_.room_for(points, 24);
    in_.room_for(triangles, 16);
    in_.room_for(faces, 99);
    if (triangles > kMostStepTriangles) wrong("too many triangles");
    if (!good()) return part;
    part.mesh.points_mm.reserve(points);
    for (std::uint32_t i = 0; good() && i < points; ++i)
      part.mesh.points_mm.push_back(vector(kLongestInPart_mm));
    for (std::uint32_t i = 0; good() && i < triangles; ++i) {
      std::array<std::uint32_t, 3> corners{};
      for (std::uint32_t& corner : corners) {
        corner = in_.u32();
        if (corner >= points) wrong("a triangle names a point that is not there");
      }
      part.mesh.triangles.push_back(corners);
      part.face_of_triangle.push_back(in_.u32());
      if (part.face_of_triangle.back() >= faces) wrong("a triangle names a face that is not there");
    }
    for (std::uint32_t i = 0; good() && i < faces; ++i) part.faces.push_back(face());
    part.volume_mm3 = number(1e27);
    part.solids = in_.u32();
    part.open_edges = in_.u32();
    part.untriangulated = in_.u32();
    part.loose_faces = in_.u32();
    part.mirrored = in_.u8() != 0;
    return part;
  }

  StepInstance instance(std::size_t parts) {
    StepInstance instance;
    instance.path = text();
    instance.products = text();
    instance.part = in_.u32();
    if (instance.part >= parts) wrong("an instance names a part that is not there");
    instance.X_WP = pose();
    instance.colour = in_.u32();
    return instance;
  }

  std::vector<StepFaceRef> refs(const std::vector<StepPart>& parts) {
    std::vector<StepFaceRef> refs;
    const std::uint32_t n = count(8);
    for (std::uint32_t i = 0; good() && i < n; ++i) {
      refs.push_back({in_.u32(), in_.u32()});
      if (refs.back().part >= parts.size() ||
          refs.back().face >= parts[refs.back().part].faces.size())
        wrong("a statement names a face that is not there");
    }
    return refs;
  }

  StepStatement statement(const std::vector<StepPart>& parts) {
    StepStatement s;
    const std::uint8_t kind = in_.u8();
    if (kind > static_cast<std::uint8_t>(StepStatement::Kind::kDatum))
      wrong("a statement is of no known kind");
    if (!good()) return s;
    s.kind = static_cast<StepStatement::Kind>(kind);
    s.entity = in_.u32();
    s.name = text();
    for (double* x : {&s.value, &s.upper, &s.lower, &s.limit_upper, &s.limit_lower, &s.outside})
      *x = number_or_none();
    s.code = text();
    s.modifiers = text();
    s.faces = refs(parts);
    s.other_faces = refs(parts);
    s.faces_lost = in_.u32();
    return s;
  }

 public:
  Result<std::vector<StepCommonQuery>> queries() {
    std::vector<StepCommonQuery> queries;
    if (in_.u32() != kQueries) return damaged("it is not one of ours");
    const std::uint32_t n = count(64);
    for (std::uint32_t i = 0; good() && i < n; ++i) {
      const std::uint32_t a = in_.u32(), b = in_.u32();
      queries.push_back({a, b, pose()});
    }
    if (!wrong_.empty()) return damaged(wrong_);
    if (!in_.at_end()) return damaged("its length is not what it states");
    return queries;
  }
  Result<std::vector<StepCommon>> answers() {
    std::vector<StepCommon> answers;
    if (in_.u32() != kAnswers) return damaged("it is not one of ours");
    const std::uint32_t n = count(16);
    for (std::uint32_t i = 0; good() && i < n; ++i) {
      const double volume = number(1e27), thickness = number();
      answers.push_back({volume, thickness});
    }
    if (!wrong_.empty()) return damaged(wrong_);
    if (!in_.at_end()) return damaged("its length is not what it states");
    return answers;
  }

 private:
  ByteReader in_;
  std::string wrong_;
};

}  // namespace

std::vector<std::byte> encode(const StepDocument& document) {
  ByteWriter out;
  out.u32(kDocument);
  put(out, document.refusal);
  const auto size = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  out.u32(size(document.parts));
  out.u32(size(document.instances));
  out.u32(size(document.statements));
  out.u32(size(document.not_solid));
  out.u32(size(document.notes));
  for (const StepPart& part : document.parts) put(out, part);
  for (const StepInstance& instance : document.instances) {
    put(out, instance.path);
    put(out, instance.products);
    out.u32(instance.part);
    put(out, instance.X_WP);
    out.u32(instance.colour);
  }
  for (const StepStatement& statement : document.statements) put(out, statement);
  for (const std::string& path : document.not_solid) put(out, path);
  for (const std::string& note : document.notes) put(out, note);
  return out.take();
}

bool is_step_document(std::span<const std::byte> bytes) {
  return ByteReader(bytes).u32() == kDocument;
}

Result<StepDocument> decode_step(std::span<const std::byte> bytes) {
  return StepReader(bytes).document();
}

std::vector<std::byte> encode(std::span<const StepCommonQuery> queries) {
  ByteWriter out;
  out.u32(kQueries);
  out.u32(static_cast<std::uint32_t>(queries.size()));
  for (const StepCommonQuery& query : queries) {
    out.u32(query.part_a);
    out.u32(query.part_b);
    put(out, query.X_AB);
  }
  return out.take();
}

Result<std::vector<StepCommonQuery>> decode_step_queries(std::span<const std::byte> bytes) {
  return StepReader(bytes).queries();
}

std::vector<std::byte> encode(std::span<const StepCommon> answers) {
  ByteWriter out;
  out.u32(kAnswers);
  out.u32(static_cast<std::uint32_t>(answers.size()));
  for (const StepCommon& answer : answers) {
    out.f64(answer.volume_mm3);
    out.f64(answer.thickness_mm);
  }
  return out.take();
}

Result<std::vector<StepCommon>> decode_step_commons(std::span<const std::byte> bytes) {
  return StepReader(bytes).answers();
}

}  // namespace mortise

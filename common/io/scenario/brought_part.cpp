#include "common/io/scenario/brought_part.h"

#include <algorithm>
#include <utility>

#include "common/io/scenario/product_information.h"
#include "common/io/step/given_parts.h"

namespace mortise {
namespace {

// Does the statement speak of the part, and of another one?
struct Spoken {
  bool of_part = false, of_others = false;
};

Spoken spoken_of(const StepStatement& statement, std::uint32_t part) {
  Spoken spoken;
  for (const auto* faces : {&statement.faces, &statement.other_faces})
    for (const StepFaceRef& face : *faces)
      (face.part == part ? spoken.of_part : spoken.of_others) = true;
  return spoken;
}

// The faces of the part, which is the first and only one from now on.
std::vector<StepFaceRef> faces_of(const std::vector<StepFaceRef>& faces, std::uint32_t part) {
  std::vector<StepFaceRef> own;
  for (const StepFaceRef& face : faces)
    if (face.part == part) own.push_back({0, face.face});
  return own;
}

Result<StepDocument> checked(std::span<const std::byte> bytes) {
  Result<StepDocument> document = decode_step(bytes);
  if (!document) return document;
  if (!document->refusal.empty() || document->parts.size() != 1 || !document->instances.empty())
    return fail(Code::kInvalidInput, "is not one part of a STEP file");
  const StepPart& part = document->parts.front();
  if (part.mesh.triangles.empty()) return fail(Code::kInvalidInput, "has no triangles");
  if (part.faces.size() > kMostPartFaces)
    return fail(Code::kInvalidInput, "has " + std::to_string(part.faces.size()) +
                                         " faces, more than " + std::to_string(kMostPartFaces) +
                                         "; split or simplify it");
  return document;
}

}  // namespace

std::vector<std::byte> brought_bytes(const StepDocument& document, std::uint32_t part) {
  StepDocument alone;
  alone.parts.push_back(document.parts[part]);
  for (const StepStatement& statement : document.statements) {
    const Spoken spoken = spoken_of(statement, part);
    if (!spoken.of_part) continue;
    StepStatement& own = alone.statements.emplace_back(statement);
    own.faces = faces_of(statement.faces, part);
    own.other_faces = faces_of(statement.other_faces, part);
    if (spoken.of_others) own.kind = StepStatement::Kind::kUnknown;
  }
  return encode(alone);
}

Result<TriangleMesh> brought_mesh(std::vector<std::byte> bytes) {
  Result<StepDocument> document = checked(bytes);
  if (!document) return document.error();
  TriangleMesh mesh = std::move(document->parts.front().mesh);
  mesh.stated = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  return mesh;
}

Result<BroughtPart> brought_part(const TriangleMesh& mesh) {
  if (!mesh.stated) return fail(Code::kInvalidInput, "nothing is stated of the mesh");
  const Result<StepDocument> document = checked(*mesh.stated);
  if (!document) return document.error();
  const StepPart& part = document->parts.front();
  if (part.mesh.points_mm.size() != mesh.points_mm.size() || part.mesh.triangles != mesh.triangles)
    return fail(Code::kInvalidInput, "what is stated is of another mesh");
  std::vector<StepPartGiven> given;
  given.push_back(given_part(part, part.name, groups_of_faces(*document, 0)));
  BroughtPart brought;
  std::vector<Scenario::AssemblySpec::Listed> listed;  // told by who reads the whole file
  std::vector<PartStatements> stated = statements_of(*document, given, listed);
  brought.given = std::move(given.front().part);
  brought.features = std::move(stated.front().features);
  return brought;
}

std::vector<Scenario::AssemblySpec::Listed> listed_when_brought(const StepDocument& document) {
  std::vector<StepPartGiven> given;
  for (std::uint32_t i = 0; i < document.parts.size(); ++i)
    given.push_back(
        given_part(document.parts[i], document.parts[i].name, groups_of_faces(document, i)));
  std::vector<Scenario::AssemblySpec::Listed> listed;
  (void)statements_of(document, given, listed);
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const StepStatement& statement = document.statements[i];
    const auto* face = !statement.faces.empty()         ? &statement.faces.front()
                       : !statement.other_faces.empty() ? &statement.other_faces.front()
                                                        : nullptr;
    if (!listed[i].used || face == nullptr || !spoken_of(statement, face->part).of_others) continue;
    listed[i].used = false;
    listed[i].reason = "it names faces of several parts";
  }
  return listed;
}

std::string told_of_unused(const std::vector<Scenario::AssemblySpec::Listed>& listed) {
  constexpr std::size_t kShown = 6;  // that a sentence bears
  const auto unused = std::ranges::count_if(listed, [](const auto& entry) { return !entry.used; });
  if (unused == 0) return {};
  std::string text = std::to_string(unused) + " of " + std::to_string(listed.size()) +
                     " tolerances that the file states are not used: ";
  std::size_t shown = 0;
  for (const Scenario::AssemblySpec::Listed& entry : listed) {
    if (entry.used) continue;
    if (shown == kShown) return text + ", …";
    text += (shown++ == 0 ? "" : ", ") + entry.text + " (" + entry.reason + ")";
  }
  return text;
}

}  // namespace mortise

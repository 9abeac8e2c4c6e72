#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/given_part.h"
#include "common/geometry/mesh.h"
#include "common/io/step/step_document.h"
#include "common/session/world/scenario.h"

/// A part of a STEP file on its way into a running session, with all that the file states of it:
/// its mesh, the surface of each face, its tolerances (PMI). In the words of the importer
/// (step_document.h), as a document that holds this part alone. The bytes go with the mesh wherever
/// that goes (TriangleMesh::stated): to the server, to one that stands by, into the log.
namespace mortise {

/// A file of such bytes is called so, beside the meshes of a saved session.
inline constexpr const char* kBroughtEnding = ".mstp";

/// The bytes of one part of an assembly. A statement that speaks of faces of several parts says
/// nothing any more, and is kept so that faces stay apart as they are in the assembly.
std::vector<std::byte> brought_bytes(const StepDocument& document, std::uint32_t part);

/// The mesh of these bytes, with them. They may come from anybody: every length, index, number and
/// limit is checked.
Result<TriangleMesh> brought_mesh(std::vector<std::byte> bytes);

struct BroughtPart {
  std::shared_ptr<const GivenPart> given;
  std::vector<Scenario::FeatureSpec> features;  ///< of which the file states something
};
/// What is stated of a mesh that has `stated`.
Result<BroughtPart> brought_part(const TriangleMesh& mesh);

/// What becomes of each statement of an assembly whose parts are brought one by one.
std::vector<Scenario::AssemblySpec::Listed> listed_when_brought(const StepDocument& document);

/// For whoever brings it: "2 of 3 tolerances that the file states are not used: #12 flatness (why),
/// #13 angle (why)"; empty: all are.
std::string told_of_unused(const std::vector<Scenario::AssemblySpec::Listed>& listed);

}  // namespace mortise

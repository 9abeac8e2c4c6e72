#pragma once
#include <STEPCAFControl_Reader.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/io/step/step_document.h"
#include "common/io/step/step_text.h"

namespace mortise {

/// A STEP file read and transferred: its distinct products that have solids, and where they are.
/// The same file gives the same parts under the same numbers.
struct StepTree {
  std::string refusal;               ///< not empty: nothing else is set
  std::vector<TopoDS_Shape> solids;  ///< of each part, in its own frame
  /// The same before a mirror image or a scale was made of it, with its faces in the same order.
  std::vector<TopoDS_Shape> as_read;
  std::vector<StepPart> parts;  ///< names and counts; no mesh
  std::vector<StepInstance> instances;
  std::vector<std::string> not_solid, notes;
  std::unique_ptr<const StepText> text;
  Handle(TDocStd_Document) document;
  STEPCAFControl_Reader reader;
};

/// May crash, hang or eat memory on hostile files: only called in a process of its own.
void read_step_tree(const std::filesystem::path& file, StepTree& tree);

}  // namespace mortise

#include "common/io/step/importer/step_tree.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Builder.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gp_Ax2.hxx>
#include <gp_Quaternion.hxx>
#include <iterator>
#include <map>
#include <set>

#include "common/io/step/importer/reading_notes.h"
#include "common/io/step/step_objections.h"

namespace mortise {
namespace {

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  const TCollection_ExtendedString& text = name->Get();
  std::string utf8(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter out = utf8.data();
  text.ToUTF8CString(out);
  utf8.resize(std::char_traits<char>::length(utf8.c_str()));
  return utf8;
}

// Names that a translator made up say nothing.
bool says_nothing(const std::string& name) {
  const bool numbers = name.find_first_not_of("0123456789 ") == std::string::npos;
  return numbers || name.find("=>") != std::string::npos || name.starts_with("NAUO") ||
         name == "SOLID" || name == "COMPOUND" || name == "SHELL" || name == "Open CASCADE";
}

std::string file_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class TreeReader {
 public:
  TreeReader(StepTree& tree, std::map<std::string, std::string> left_out)
      : tree_(tree),
        left_out_(std::move(left_out)),
        shapes_(XCAFDoc_DocumentTool::ShapeTool(tree.document->Main())),
        colours_(XCAFDoc_DocumentTool::ColorTool(tree.document->Main())) {}

  void run() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (int i = 1; i <= roots.Length() && tree_.refusal.empty(); ++i) {
      const TDF_Label& root = roots.Value(i);
      // One root that is an assembly adds nothing to a path.
      if (roots.Length() == 1 && shapes_->IsAssembly(root))
        children(root, TopLoc_Location(), "", name_of(root), kNoColour, 1);
      else
        visit(root, TopLoc_Location(), "", "", kNoColour, 1);
    }
    // One that was not met under its name stands among the others, and not as it should.
    for (const auto& [name, why] : left_out_)
      if (!met_.contains(name)) tree_.refusal = why;
    if (without_shape_ > 0)
      tree_.notes.push_back(std::to_string(without_shape_) + " places in the tree" +
                            std::string(kWithoutFaces));
  }

 private:
  void visit(const TDF_Label& label, TopLoc_Location location, const std::string& above,
             const std::string& products, std::uint32_t colour, int depth) {
    if (depth > static_cast<int>(kMostStepLevels)) {
      tree_.refusal = "its assemblies are nested deeper than " + std::to_string(kMostStepLevels) +
                      " levels, or contain each other; export it again";
      return;
    }
    TDF_Label product = label;
    if (shapes_->IsReference(label)) {
      location = location * shapes_->GetLocation(label);
      shapes_->GetReferredShape(label, product);
    }
    if (const auto why = left_out_.find(name_of(label)); why != left_out_.end()) {
      met_.insert(why->first);
      tree_.notes.push_back(joined(above, name_of(product)) + " was left out: " + why->second);
      return;
    }
    const std::string path = unique(above, label, product);
    const std::string of_product = joined(products, name_of(product));
    const std::uint32_t own = colour_of(label);
    if (own != kNoColour) colour = own;
    if (shapes_->IsAssembly(product)) {
      children(product, location, path, of_product, colour, depth + 1);
      return;
    }
    if (colour == kNoColour) colour = colour_of(product);
    add(product, location, path, of_product, colour);
  }

  void children(const TDF_Label& assembly, const TopLoc_Location& location, const std::string& path,
                const std::string& products, std::uint32_t colour, int depth) {
    TDF_LabelSequence components;
    shapes_->GetComponents(assembly, components);
    for (int i = 1; i <= components.Length() && tree_.refusal.empty(); ++i)
      visit(components.Value(i), location, path, products, colour, depth);
  }

  static std::string joined(const std::string& above, const std::string& name) {
    std::string clean = name.empty() ? "part" : name;
    std::replace(clean.begin(), clean.end(), '/', '_');
    return above.empty() ? clean : above + "/" + clean;
  }

  // The name of the instance, or of its product where that says more; numbered among its siblings.
  std::string unique(const std::string& above, const TDF_Label& label, const TDF_Label& product) {
    const std::string own = name_of(label), of_product = name_of(product);
    const std::string path = joined(above, says_nothing(own) ? of_product : own);
    std::string numbered = path;
    for (int i = 2; !paths_.insert(numbered).second; ++i) numbered = path + "_" + std::to_string(i);
    return numbered;
  }

  std::uint32_t colour_of(const TDF_Label& label) const {
    Quantity_Color colour;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
      if (colours_->GetColor(label, type, colour)) {
        const auto byte = [](double x) {
          return static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(x, 0.0, 1.0)));
        };
        Standard_Real r, g, b;
        colour.Values(r, g, b, Quantity_TOC_sRGB);
        return byte(r) << 16U | byte(g) << 8U | byte(b);
      }
    return kNoColour;
  }

  void add(const TDF_Label& product, const TopLoc_Location& location, const std::string& path,
           const std::string& products, std::uint32_t colour) {
    if (tree_.instances.size() + tree_.not_solid.size() >= kMostStepInstances) {
      tree_.refusal = "it has more than " + std::to_string(kMostStepInstances) + " instances";
      return;
    }
    const gp_Trsf placed = location.Transformation();
    const int part = part_of(product, placed);
    if (part == kNothing) ++without_shape_;
    if (part == kNoSolid) tree_.not_solid.push_back(path);
    if (part < 0) return;
    StepInstance instance;
    instance.path = path;
    instance.products = products;
    instance.part = static_cast<std::uint32_t>(part);
    instance.X_WP = rigid(placed);
    instance.colour = colour;
    tree_.instances.push_back(std::move(instance));
  }

  static bool is_rigid(const gp_Trsf& placed) {
    return !placed.IsNegative() && std::fabs(placed.ScaleFactor() - 1.0) < 1e-9;
  }

  // What a placement adds to a rigid one is done to the part itself: a mirror image in x, a scale.
  static gp_Trsf baked(const gp_Trsf& placed) {
    gp_Trsf own;
    const double scale = std::fabs(placed.ScaleFactor());
    if (placed.IsNegative()) own.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)));
    gp_Trsf size;
    size.SetScale(gp_Pnt(0, 0, 0), scale);
    return size * own;
  }

  static Pose rigid(const gp_Trsf& placed) {
    const gp_Trsf motion = is_rigid(placed) ? placed : placed * baked(placed).Inverted();
    const gp_Quaternion q = motion.GetRotation();
    const gp_XYZ& p = motion.TranslationPart();
    Pose X;
    X.p = {p.X(), p.Y(), p.Z()};
    X.q = Quat(q.W(), q.X(), q.Y(), q.Z()).normalized();
    return X;
  }

  // The number of the product's part. A product without faces (of an annotation, or a name alone)
  // is no body.
  static constexpr int kNoSolid = -1, kNothing = -2;
  int part_of(const TDF_Label& product, const gp_Trsf& placed) {
    TCollection_AsciiString entry;
    TDF_Tool::Entry(product, entry);
    std::string key = entry.ToCString();
    const bool bakes = !is_rigid(placed);
    if (bakes)
      key += (placed.IsNegative() ? " mirrored " : " scaled ") +
             std::to_string(std::lround(1e9 * std::fabs(placed.ScaleFactor())));
    const auto [known, fresh] = part_of_.try_emplace(key, kNothing);
    if (!fresh) return known->second;
    TopoDS_Shape shape = shapes_->GetShape(product);
    if (shape.IsNull() || !TopExp_Explorer(shape, TopAbs_FACE).More()) return kNothing;
    known->second = kNoSolid;
    shape.Location(TopLoc_Location());
    StepPart part;
    part.name = name_of(product);
    TopoDS_Compound solids;
    BRep_Builder builder;
    builder.MakeCompound(solids);
    for (TopExp_Explorer x(shape, TopAbs_SOLID); x.More(); x.Next()) {
      builder.Add(solids, x.Current());
      ++part.solids;
    }
    for (TopExp_Explorer x(shape, TopAbs_FACE, TopAbs_SOLID); x.More(); x.Next())
      ++part.loose_faces;
    if (part.solids == 0) return kNoSolid;
    part.mirrored = placed.IsNegative();
    TopoDS_Shape own = solids;
    if (bakes) own = BRepBuilderAPI_Transform(solids, baked(placed), true).Shape();
    known->second = static_cast<int>(tree_.parts.size());
    tree_.parts.push_back(std::move(part));
    tree_.solids.push_back(own);
    tree_.as_read.push_back(solids);
    return known->second;
  }

  StepTree& tree_;
  std::map<std::string, std::string> left_out_;  // why, by the name of the instance
  std::set<std::string> met_;                    // of these
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  std::map<std::string, int> part_of_;
  std::set<std::string> paths_;
  std::size_t without_shape_ = 0;
};

// The library keeps of a place only its name: those that are to be left out get one of their own.
std::map<std::string, std::string> marked_places(StepTree& tree) {
  std::map<std::string, std::string> why_of;
  const std::map<int, std::string> left_out = step_left_out(*tree.text);
  const Handle(StepData_StepModel) model =
      Handle(StepData_StepModel)::DownCast(tree.reader.Reader().WS()->Model());
  for (int i = 1; !left_out.empty() && i <= model->NbEntities(); ++i) {
    const auto usage = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
    const auto why = usage.IsNull() ? left_out.end() : left_out.find(model->IdentLabel(usage));
    if (why == left_out.end()) continue;
    const std::string mark = "left out by mortise: #" + std::to_string(why->first);
    usage->SetName(new TCollection_HAsciiString(mark.c_str()));
    why_of[mark] = why->second;
  }
  return why_of;
}

std::string nothing_read(const StepTree& tree) {
  if (!tree.not_solid.empty())
    return "none of its " + std::to_string(tree.not_solid.size()) +
           " bodies is a solid (surfaces or wires only); export exact solids";
  for (const std::string& note : tree.notes)
    if (note.find(" was left out: ") != std::string::npos) return note;
  return "it holds no shapes (tessellated only, or no geometry); export exact solids";
}

}  // namespace

void read_step_tree(const std::filesystem::path& file, StepTree& tree) {
  tree.text = std::make_unique<const StepText>(file_text(file));
  tree.refusal = step_refusal(*tree.text);
  if (!tree.refusal.empty()) return;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", tree.document);
  tree.reader.SetNameMode(true);
  tree.reader.SetColorMode(true);
  tree.reader.SetGDTMode(true);
  if (tree.reader.ReadFile(file.c_str()) != IFSelect_RetDone) {
    tree.refusal = "it is no STEP file, or it is cut off or damaged; export it again";
    return;
  }
  std::map<std::string, std::string> left_out = marked_places(tree);
  if (!tree.reader.Transfer(tree.document)) {
    tree.refusal = "nothing in it could be made a shape; export the assembly as AP214 or AP242";
    return;
  }
  TreeReader(tree, std::move(left_out)).run();
  for (std::string& note : reading_notes(tree)) tree.notes.push_back(std::move(note));
  if (tree.refusal.empty() && tree.parts.empty()) tree.refusal = nothing_read(tree);
}

}  // namespace mortise

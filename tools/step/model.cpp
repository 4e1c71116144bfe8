#include "tools/step/model.hpp"

#include <algorithm>
#include <BRep_Builder.hxx>
#include <cctype>
#include <cmath>
#include <functional>
#include <gp_Vec.hxx>
#include <Interface_Static.hxx>
#include <map>
#include <Quantity_ColorRGBA.hxx>
#include <stdexcept>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPConstruct.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Direction.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDataStd_TreeNode.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Compound.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_Material.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XCAFDoc_Volume.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

namespace teracell::step {
namespace {

// A text of blanks alone is none.
std::string unless_blank(const std::string& text) { return text.find_first_not_of(" \t\r\n") == std::string::npos ? "" : text; }

std::string text_of(const Handle(TCollection_HAsciiString) & text) { return text.IsNull() ? "" : unless_blank(text->ToCString()); }

// Whether the third axis, where it is given, points against the product of the other two.
bool mirrors(const Handle(StepGeom_CartesianTransformationOperator3d) & by) {
  if (!by->HasAxis1() || !by->HasAxis2() || !by->HasAxis3()) return false;
  const auto axis = [](const Handle(StepGeom_Direction) & d) {
    return gp_Vec(d->DirectionRatiosValue(1), d->DirectionRatiosValue(2), d->DirectionRatiosValue(3));
  };
  return axis(by->Axis1()).Crossed(axis(by->Axis2())).Dot(axis(by->Axis3())) < 0;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? unless_blank(TCollection_AsciiString(name->Get()).ToCString()) : "";
}

std::string address_of(const TDF_Label& label) {
  TCollection_AsciiString entry;
  TDF_Tool::Entry(label, entry);
  return entry.ToCString();
}

Matrix matrix_of(const TopLoc_Location& location) {
  const gp_Trsf t = location.Transformation();
  Matrix out;
  size_t i = 0;
  for (int row = 1; row <= 3; ++row)
    for (int column = 1; column <= 4; ++column) out[i++] = t.Value(row, column);
  return out;
}

// A colour as STEP has it, which is sRGB: "#rrggbb", or "#rrggbbaa" where it is not opaque.
std::string text_of(const Quantity_ColorRGBA& color) {
  std::string out =
      TCollection_AsciiString(color.Alpha() < 1 ? Quantity_ColorRGBA::ColorToHex(color) : Quantity_Color::ColorToHex(color.GetRGB())).ToCString();
  std::ranges::transform(out, out.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

// OpenCASCADE names things after their description, name or identifier, the first that holds a printable character of ASCII, so "ナット" counts
// as no name. An identifier is taken as it is: it becomes the name that an occurrence or a product has. An occurrence without one has that of
// its product; OpenCASCADE's own writer gives it a place in its document ("=>[0:1:1:2]").
void name_all(const Handle(XSControl_WorkSession) & session) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  const Handle(TCollection_HAsciiString) nothing = new TCollection_HAsciiString();
  for (int i = 1; i <= model->NbEntities(); ++i)
    if (const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i)); !product.IsNull() && !text_of(product->Name()).empty())
      product->SetId(product->Name());
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
    if (use.IsNull()) continue;
    const std::string own = text_of(use->Name());
    Handle(TCollection_HAsciiString) name = own.starts_with("=>[") ? nothing : use->Name();
    if (text_of(name).empty() && !use->RelatedProductDefinition().IsNull()) {
      const auto formation = use->RelatedProductDefinition()->Formation();
      if (!formation.IsNull() && !formation->OfProduct().IsNull()) name = formation->OfProduct()->Id();
    }
    use->SetId(name.IsNull() ? nothing : name);
    use->SetName(nothing);
    use->SetDescription(nothing);
  }
}

// A file of some kilobytes can describe more occurrences than there is memory, and OpenCASCADE makes each of them.
void refuse_too_many(const Handle(XSControl_WorkSession) & session) {
  constexpr double kMost = 1 << 20;
  const Handle(Interface_InterfaceModel) model = session->Model();
  std::unordered_map<const void*, std::vector<const void*>> below;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
    if (!use.IsNull()) below[use->RelatingProductDefinition().get()].push_back(use->RelatedProductDefinition().get());
  }
  constexpr int kDeepest = 512;
  std::unordered_map<const void*, double> known;
  const std::function<double(const void*, int)> places = [&](const void* product, int depth) -> double {
    if (depth > kDeepest) throw std::runtime_error("expected at most 512 levels of products in products, found more: does a product contain itself?");
    if (const auto found = known.find(product); found != known.end()) return found->second;
    double sum = 1;
    if (const auto uses = below.find(product); uses != below.end())
      for (const void* part : uses->second) sum += places(part, depth + 1);
    return known[product] = sum;
  };
  for (const auto& [product, uses] : below)
    if (places(product, 1) > kMost) throw std::runtime_error("expected at most 1,048,576 occurrences of products, found more");
}

// OpenCASCADE reads these operators as if they only moved and turned.
void refuse_scales(const Handle(XSControl_WorkSession) & session) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto use = Handle(StepRepr_MappedItem)::DownCast(model->Value(i));
    if (use.IsNull()) continue;
    const auto by = Handle(StepGeom_CartesianTransformationOperator3d)::DownCast(use->MappingTarget());
    if (by.IsNull()) continue;
    if (by->HasScale() && std::abs(by->Scale() - 1) > 1e-9)
      throw std::runtime_error("it places a shape by an operator that scales by " + std::to_string(by->Scale()) +
                               " (CARTESIAN_TRANSFORMATION_OPERATOR_3D), which the CAD kernel does not support");
    if (mirrors(by))
      throw std::runtime_error(
          "it places a shape by an operator that mirrors (CARTESIAN_TRANSFORMATION_OPERATOR_3D), which the CAD kernel does not support");
  }
}

class Reader {
 public:
  explicit Reader(const std::string& path) : document_(new TDocStd_Document("BinXCAF")) {
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    reader_.SetNameMode(true);
    reader_.SetColorMode(true);
    reader_.SetPropsMode(true);
    reader_.SetMatMode(true);
    reader_.SetLayerMode(false);
    reader_.SetSHUOMode(false);
    reader_.SetGDTMode(false);
    if (reader_.ReadFile(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("the CAD kernel can't read it as a STEP file");
    refuse_too_many(reader_.Reader().WS());
    name_all(reader_.Reader().WS());
    refuse_scales(reader_.Reader().WS());
    if (!reader_.Transfer(document_)) throw std::runtime_error("the CAD kernel finds no shape in it");
    colors_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    name_entities();
  }

  Model model() {
    TDF_LabelSequence roots;
    XCAFDoc_DocumentTool::ShapeTool(document_->Main())->GetFreeShapes(roots);
    for (const TDF_Label& root : roots) out_.roots.push_back({node_of(root, ""), matrix_of(XCAFDoc_ShapeTool::GetShape(root).Location()), ""});
    if (out_.shapes.empty()) throw std::runtime_error("the CAD kernel finds no solid and no face in it");
    return std::move(out_);
  }

 private:
  // The names of solids and shells, which tell apart those of one product.
  void name_entities() {
    const Handle(XSControl_WorkSession) session = reader_.Reader().WS();
    const Handle(Interface_InterfaceModel) model = session->Model();
    const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const auto item = Handle(StepRepr_RepresentationItem)::DownCast(model->Value(i));
      if (item.IsNull() || (!item->IsKind(STANDARD_TYPE(StepShape_SolidModel)) && !item->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel))))
        continue;
      const TopoDS_Shape shape = STEPConstruct::FindShape(process, item);
      if (!shape.IsNull()) entity_name_[shape.TShape().get()] = text_of(item->Name());
    }
  }

  std::string color_of(const TDF_Label& label) const {
    Quantity_ColorRGBA color;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen, XCAFDoc_ColorCurv})
      if (colors_->GetColor(label, type, color)) return text_of(color);
    return "";
  }

  std::string color_of(const TopoDS_Shape& shape) const {
    Quantity_ColorRGBA color;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
      if (colors_->GetColor(shape, type, color)) return text_of(color);
    return "";
  }

  static std::string material_of(const TDF_Label& label) {
    Handle(TDataStd_TreeNode) link;
    if (!label.FindAttribute(XCAFDoc::MaterialRefGUID(), link) || !link->HasFather()) return "";
    Handle(XCAFDoc_Material) material;
    return link->Father()->Label().FindAttribute(XCAFDoc_Material::GetID(), material) ? text_of(material->GetName()) : "";
  }

  // The node of a product. `color`: that of the occurrence, which is stronger than the product's.
  uint32_t node_of(const TDF_Label& label, const std::string& color) {
    const auto [known, fresh] = nodes_.try_emplace(address_of(label) + color, static_cast<uint32_t>(out_.nodes.size()));
    const uint32_t number = known->second;
    if (!fresh) return number;
    out_.nodes.emplace_back().name = name_of(label);
    if (XCAFDoc_ShapeTool::IsAssembly(label)) {
      TDF_LabelSequence parts;
      XCAFDoc_ShapeTool::GetComponents(label, parts);
      for (const TDF_Label& part : parts) {
        TDF_Label product;
        if (!XCAFDoc_ShapeTool::GetReferredShape(part, product)) continue;
        const std::string own = color_of(part), inherited = own.empty() ? color : own;
        const Node::Use use = {node_of(product, inherited), matrix_of(XCAFDoc_ShapeTool::GetLocation(part)), name_of(part)};
        out_.nodes[number].uses.push_back(use);
      }
    } else {
      add_shapes(label, color, number);
    }
    if (out_.nodes[number].name.empty()) out_.nodes[number].name = numbered(kind_of(out_.nodes[number]));
    return number;
  }

  const char* kind_of(const Node& node) const {
    if (!node.shape) return "assembly";
    const TopAbs_ShapeEnum type = out_.shapes[*node.shape].shape.ShapeType();
    return type == TopAbs_SOLID ? "solid" : type == TopAbs_SHELL ? "shell" : "faces";
  }

  // "solid 3" for the third product of a kind that has no name.
  std::string numbered(const std::string& kind) { return kind + ' ' + std::to_string(++unnamed_[kind]); }

  // A product's shape: one solid is the part itself, several are parts below it.
  void add_shapes(const TDF_Label& label, const std::string& color, uint32_t number) {
    const std::string product = name_of(label), material = material_of(label), of_product = color_of(label);
    const std::vector<uint32_t>& shapes = shapes_of(label);
    const auto describe = [&](Node& node, uint32_t shape) {
      node.shape = shape;
      node.product = product;
      node.material = material;
      const std::string own = color_of(out_.shapes[shape].shape);
      node.color = !color.empty() ? color : !own.empty() ? own : of_product;
    };
    if (shapes.size() == 1) return describe(out_.nodes[number], shapes[0]);
    std::map<std::string, int> count;
    for (const uint32_t shape : shapes) {
      Node& node = out_.nodes.emplace_back();
      describe(node, shape);
      const char* kind = kind_of(node);
      const int n = ++count[kind];
      const auto named = entity_name_.find(out_.shapes[shape].shape.TShape().get());
      node.name = named == entity_name_.end() || named->second.empty() ? std::string(kind) + ' ' + std::to_string(n) : named->second;
      out_.nodes[number].uses.push_back({static_cast<uint32_t>(out_.nodes.size() - 1), matrix_of({}), ""});
    }
  }

  const std::vector<uint32_t>& shapes_of(const TDF_Label& label) {
    const auto [known, fresh] = shapes_.try_emplace(address_of(label));
    if (!fresh) return known->second;
    std::vector<uint32_t>& out = known->second;
    const TopoDS_Shape whole = XCAFDoc_ShapeTool::GetShape(label).Located({});
    const auto add = [&](const TopoDS_Shape& shape) {
      Shape made;
      made.shape = shape;
      for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) ++made.faces;
      if (made.faces == 0) return;
      out.push_back(static_cast<uint32_t>(out_.shapes.size()));
      out_.shapes.push_back(std::move(made));
    };
    for (TopExp_Explorer solid(whole, TopAbs_SOLID); solid.More(); solid.Next()) add(solid.Current());
    for (TopExp_Explorer shell(whole, TopAbs_SHELL, TopAbs_SOLID); shell.More(); shell.Next()) add(shell.Current());
    TopoDS_Compound loose;
    BRep_Builder builder;
    builder.MakeCompound(loose);
    for (TopExp_Explorer face(whole, TopAbs_FACE, TopAbs_SHELL); face.More(); face.Next()) builder.Add(loose, face.Current());
    add(loose);
    double volume = 0;
    if (out.size() == 1 && XCAFDoc_Volume::Get(label, volume)) out_.shapes[out[0]].sender_volume = volume;
    for (const uint32_t shape : out) color_faces(out_.shapes[shape], color_of(label));
    return out;
  }

  void color_faces(Shape& shape, const std::string& of_product) const {
    std::string own = color_of(shape.shape);
    if (own.empty()) own = of_product;
    for (TopExp_Explorer face(shape.shape, TopAbs_FACE); face.More(); face.Next())
      if (const std::string color = color_of(face.Current().Located({})); !color.empty() && color != own)
        shape.face_color[face.Current().TShape().get()] = color;
  }

  STEPCAFControl_Reader reader_;
  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ColorTool) colors_;
  Model out_;
  std::unordered_map<const void*, std::string> entity_name_;       // by the TShape of a solid or a shell
  std::map<std::string, int> unnamed_;                             // how many products of a kind have no name
  std::unordered_map<std::string, uint32_t> nodes_;                // by the address of a product and its colour
  std::unordered_map<std::string, std::vector<uint32_t>> shapes_;  // by the address of a product
};

}  // namespace

Model read_model(const std::string& path) { return Reader(path).model(); }

}  // namespace teracell::step

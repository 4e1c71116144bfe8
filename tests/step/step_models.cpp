// step_models FOLDER: writes the STEP models of the tests with OpenCASCADE, and prints what they hold as one JSON object:
//   {"file.step": {"unit": the file's, "parts": [{"path", "instances", "volume", "area", "exact", "color", "material"}]}}
// Lengths, areas and volumes are in millimetres whatever the file's unit is, and those of one instance. "exact" says that they are formulas,
// "exact": false that they are OpenCASCADE's integrals over its own surfaces. The volume of an open part is null.
//
// A path has one name a level, from the root: the occurrence's own, else the product's. A product of several solids is a level of its own, and
// its solids are called by their own names or "solid N", counted from 1 over all solids of the product.
#include <BRep_Builder.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepPrimAPI_MakeWedge.hxx>
#include <cmath>
#include <cstdio>
#include <GC_MakeArcOfCircle.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>
#include <gp_Pln.hxx>
#include <GProp_GProps.hxx>
#include <Interface_Static.hxx>
#include <iomanip>
#include <iostream>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <numbers>
#include <Quantity_Color.hxx>
#include <sstream>
#include <Standard_Version.hxx>
#include <stdexcept>
#include <STEPCAFControl_Writer.hxx>
#include <StepData_StepModel.hxx>
#include <string>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <vector>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_Area.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XCAFDoc_Volume.hxx>

namespace {

constexpr double kPi = std::numbers::pi;

struct Measure {
  double volume, area;
  bool exact = true;
};

Measure of_box(double x, double y, double z) { return {x * y * z, 2 * (x * y + y * z + z * x)}; }
Measure of_sphere(double radius) { return {4 * kPi / 3 * std::pow(radius, 3), 4 * kPi * radius * radius}; }
Measure of_cylinder(double radius, double height) { return {kPi * radius * radius * height, 2 * kPi * radius * (radius + height)}; }

Measure integrated(const TopoDS_Shape& shape) {
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(shape, volume, 1e-9);
  BRepGProp::SurfaceProperties(shape, area, 1e-9);
  return {volume.Mass(), area.Mass(), false};
}

TopoDS_Shape compound_of(const std::vector<TopoDS_Shape>& shapes) {
  TopoDS_Compound out;
  BRep_Builder builder;
  builder.MakeCompound(out);
  for (const TopoDS_Shape& shape : shapes) builder.Add(out, shape);
  return out;
}

// What a Boolean operation made is a compound of one solid.
TopoDS_Shape solid_of(const TopoDS_Shape& made) { return TopExp_Explorer(made, TopAbs_SOLID).Current(); }

gp_Trsf moved(double x, double y, double z) {
  gp_Trsf out;
  out.SetTranslation({x, y, z});
  return out;
}

// A prism on z = 0 with a regular hexagon as its base. Its area is 2 * sqrt(3) * flats * height and twice the hexagon's.
TopoDS_Shape hexagonal_prism(double across_flats, double height) {
  BRepBuilderAPI_MakePolygon polygon;
  for (int i = 0; i < 6; ++i) {
    const double angle = kPi / 3 * i, radius = across_flats / std::sqrt(3);
    polygon.Add({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  polygon.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(), gp_Vec(0, 0, height)).Shape();
}
double of_hexagon(double across_flats) { return std::sqrt(3) / 2 * across_flats * across_flats; }

// One document, which becomes one file, and the parts that a reader must find in it.
class Model {
 public:
  Model() {
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document_);
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    colors_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
  }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  ~Model() { XCAFApp_Application::GetApplication()->Close(document_); }

  // A compound stays one product.
  TDF_Label product(const TopoDS_Shape& shape, const std::string& name, const std::string& color = "") {
    return described(shapes_->AddShape(shape, Standard_False), name, color);
  }
  TDF_Label assembly(const std::string& name) { return described(shapes_->NewShape(), name, ""); }
  TDF_Label place(const TDF_Label& assembly, const TDF_Label& product, const gp_Trsf& where, const std::string& name = "",
                  const std::string& color = "") {
    return described(shapes_->AddComponent(assembly, product, where), name, color);
  }
  void describe_inside(const TDF_Label& product, const TopoDS_Shape& inside, const std::string& name, const std::string& color) {
    described(shapes_->AddSubShape(product, inside), name, color);
  }

  // The density is in g/cm3. OpenCASCADE writes it without a unit.
  void make_of(const TDF_Label& product, const char* material, double density) {
    const auto text = [](const char* s) { return Handle(TCollection_HAsciiString)(new TCollection_HAsciiString(s)); };
    XCAFDoc_DocumentTool::MaterialTool(document_->Main())
        ->SetMaterial(product, text(material), text(""), density, text("density measure"), text("POSITIVE_RATIO_MEASURE"));
  }

  void expect(const std::string& path, int instances, const Measure& of, const std::string& color = "", const std::string& material = "") {
    const auto text_or_null = [](const std::string& text) { return text.empty() ? "null" : '"' + text + '"'; };
    std::ostringstream out;
    out << std::setprecision(17) << R"({"path": ")" << path << R"(", "instances": )" << instances << R"(, "volume": )";
    std::isnan(of.volume) ? out << "null" : out << of.volume;
    out << R"(, "area": )" << of.area << R"(, "exact": )" << (of.exact ? "true" : "false") << R"(, "color": )" << text_or_null(color)
        << R"(, "material": )" << text_or_null(material) << '}';
    parts_ += (parts_.empty() ? "\n    " : ",\n    ") + out.str();
  }

  // Returns the file's entry of the JSON object. `unit` is "mm", "inch" or "m".
  std::string write(const std::string& folder, const std::string& file, const std::string& unit = "mm") {
    shapes_->UpdateAssemblies();
    static const STEPCAFControl_Writer known;  // It makes the parameters known; a writer takes the unit when it is made.
    Interface_Static::SetCVal("write.step.unit", unit == "mm" ? "MM" : unit == "inch" ? "INCH" : "M");
    Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
    STEPCAFControl_Writer writer;
    writer.SetPropsMode(Standard_True);
#if OCC_VERSION_HEX >= 0x070800  // where it states the unit of the parameter and writes other numbers, unless it is told
    writer.ChangeWriter().Model()->SetWriteLengthUnit(unit == "mm" ? 1 : unit == "inch" ? 25.4 : 1000);
#endif
    if (!writer.Transfer(document_, STEPControl_AsIs) || writer.Write((folder + '/' + file).c_str()) != IFSelect_RetDone)
      throw std::runtime_error("can't write " + folder + '/' + file);
    return '"' + file + R"(": {"unit": ")" + unit + R"(", "parts": [)" + parts_ + "]}";
  }

 private:
  TDF_Label described(const TDF_Label& label, const std::string& name, const std::string& color) {
    if (label.IsNull()) throw std::runtime_error("no label for " + name);
    if (!name.empty()) TDataStd_Name::Set(label, TCollection_ExtendedString(name.c_str(), Standard_True));
    Quantity_Color value;
    if (!color.empty() && Quantity_Color::ColorFromHex(color.c_str(), value)) colors_->SetColor(label, value, XCAFDoc_ColorSurf);
    return label;
  }

  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  std::string parts_;
};

// A file of one part, named after the file.
std::string single(const std::string& folder, const std::string& name, const TopoDS_Shape& shape, const Measure& measure,
                   const std::string& unit = "mm") {
  Model model;
  model.product(shape, name);
  model.expect('/' + name, 1, measure);
  return model.write(folder, name + ".step", unit);
}

std::string sphere(const std::string& folder) { return single(folder, "sphere", BRepPrimAPI_MakeSphere(10).Shape(), of_sphere(10)); }

std::string torus(const std::string& folder) {
  return single(folder, "torus", BRepPrimAPI_MakeTorus(20, 5).Shape(), {2 * kPi * kPi * 20 * 25, 4 * kPi * kPi * 20 * 5});
}

// Two solids of one part that touch along the line x = 5, y = 0.
std::string cylinders(const std::string& folder) {
  Model model;
  const gp_Ax2 second(gp_Pnt(8, 0, 0), gp::DZ());
  model.product(compound_of({BRepPrimAPI_MakeCylinder(5, 20).Solid(), BRepPrimAPI_MakeCylinder(second, 3, 20).Solid()}), "cylinders");
  model.expect("/cylinders/solid 1", 1, of_cylinder(5, 20));
  model.expect("/cylinders/solid 2", 1, of_cylinder(3, 20));
  return model.write(folder, "cylinders.step");
}

// A solid with a second shell around its void.
std::string nested(const std::string& folder) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-15, -15, -15), 30, 30, 30).Shape();
  const Measure outer = of_box(30, 30, 30), inner = of_sphere(10);
  return single(folder, "nested", BRepAlgoAPI_Cut(box, BRepPrimAPI_MakeSphere(10).Shape()).Shape(),
                {outer.volume - inner.volume, outer.area + inner.area});
}

std::string pipe(const std::string& folder) {
  const double outer = 10, inner = 9.95, length = 200, ring = kPi * (outer * outer - inner * inner);
  const TopoDS_Shape shape =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(outer, length).Shape(), BRepPrimAPI_MakeCylinder(inner, length).Shape()).Shape();
  return single(folder, "pipe", shape, {ring * length, 2 * ring + 2 * kPi * (outer + inner) * length});
}

// A lattice of 1000 occurrences of one bolt. Each is turned about z by an angle of its own.
std::string bolts(const std::string& folder) {
  // The head is above z = 0, the shank below it down to -14, and its chamfer from there to -15.
  const double flats = 8, head = 4, r = 2.5, shank = 14, tip = 1.5, chamfer = 1;
  const TopoDS_Shape straight = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -shank), gp::DZ()), r, shank).Shape();
  const TopoDS_Shape end = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, -shank - chamfer), gp::DZ()), tip, r, chamfer).Shape();
  const TopoDS_Shape shape = BRepAlgoAPI_Fuse(BRepAlgoAPI_Fuse(hexagonal_prism(flats, head), straight).Shape(), end).Shape();
  const double volume = of_hexagon(flats) * head + kPi * r * r * shank + kPi / 3 * chamfer * (r * r + r * tip + tip * tip);
  const double area = 2 * of_hexagon(flats) + 2 * std::sqrt(3) * flats * head - kPi * r * r + 2 * kPi * r * shank +
                      kPi * (r + tip) * std::hypot(r - tip, chamfer) + kPi * tip * tip;
  Model model;
  const TDF_Label root = model.assembly("bolts"), bolt = model.product(solid_of(shape), "bolt", "#c0c0c8");
  for (int i = 0; i < 1000; ++i) {
    gp_Trsf turn;
    turn.SetRotation(gp::OZ(), 2 * kPi * i / 1000);
    model.place(root, bolt, moved(20 * (i % 10), 20 * (i / 10 % 10), 30 * (i / 100)) * turn);
  }
  model.expect("/bolts/bolt", 1000, {volume, area}, "#c0c0c8");
  return model.write(folder, "bolts.step");
}

std::string assembly(const std::string& folder) {
  Model model;
  TopoDS_Shape plate = BRepPrimAPI_MakeBox(60, 40, 5).Shape();
  for (const double x : {10, 50})
    for (const double y : {10, 30})
      plate = BRepAlgoAPI_Cut(plate, BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, -1), gp::DZ()), 3, 7).Shape()).Shape();
  const Measure box = of_box(60, 40, 5), of_plate = {box.volume - 4 * kPi * 9 * 5, box.area - 8 * kPi * 9 + 4 * 2 * kPi * 3 * 5};
  const TDF_Label plate_label = model.product(solid_of(plate), "плита", "#8090a0");
  model.make_of(plate_label, "Алюминий", 2.7);

  const TopoDS_Shape nut = BRepAlgoAPI_Cut(hexagonal_prism(10, 5), BRepPrimAPI_MakeCylinder(3, 5).Shape()).Shape();
  const double ring = of_hexagon(10) - kPi * 9;
  const Measure of_nut = {ring * 5, 2 * ring + (2 * std::sqrt(3) * 10 + 2 * kPi * 3) * 5};
  const TDF_Label nut_label = model.product(solid_of(nut), "ナット", "#b0a060");
  model.make_of(nut_label, "Steel", 7.85);

  const TDF_Label holder = model.assembly("держатель");
  model.place(holder, plate_label, {});
  model.place(holder, nut_label, moved(10, 10, 5), "левая гайка");
  model.place(holder, nut_label, moved(50, 10, 5));

  // Two faces of the cover are red.
  const TopoDS_Shape cover = BRepPrimAPI_MakeBox(20, 30, 4).Shape();
  const TDF_Label cover_label = model.product(cover, "крышка", "#808080");
  TopExp_Explorer face(cover, TopAbs_FACE);
  for (int i = 0; i < 2; ++i, face.Next()) model.describe_inside(cover_label, face.Current(), "", "#ff0000");

  const TopoDS_Shape rib = BRepPrimAPI_MakeBox(10, 2, 6).Solid(), ball = BRepPrimAPI_MakeSphere(gp_Pnt(20, 0, 0), 4).Solid();
  const TopoDS_Shape pin = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(30, 0, 0), gp::DZ()), 2, 9).Solid();
  const TDF_Label triple = model.product(compound_of({rib, ball, pin}), "тройка", "#20a040");
  model.describe_inside(triple, rib, "ребро", "");

  gp_Trsf skew;
  skew.SetRotation(gp_Ax1(gp_Pnt(5, -3, 2), gp_Dir(1, 2, 3)), 37 * kPi / 180);
  const TDF_Label root = model.assembly("машина");
  model.place(root, holder, {});
  model.place(root, holder, moved(0, 0, 50));
  model.place(root, nut_label, moved(100, 0, 0) * skew);
  model.place(root, nut_label, moved(100, 40, 0), "синяя гайка", "#0000ff");
  model.place(root, cover_label, moved(0, 100, 0));
  model.place(root, triple, moved(0, 0, 100));

  model.expect("/машина/держатель/плита", 2, of_plate, "#8090a0", "Алюминий");
  model.expect("/машина/держатель/левая гайка", 2, of_nut, "#b0a060", "Steel");
  model.expect("/машина/держатель/ナット", 2, of_nut, "#b0a060", "Steel");
  model.expect("/машина/ナット", 1, of_nut, "#b0a060", "Steel");
  model.expect("/машина/синяя гайка", 1, of_nut, "#0000ff", "Steel");
  model.expect("/машина/крышка", 1, of_box(20, 30, 4), "#808080");
  model.expect("/машина/тройка/ребро", 1, of_box(10, 2, 6), "#20a040");
  model.expect("/машина/тройка/solid 2", 1, of_sphere(4), "#20a040");
  model.expect("/машина/тройка/solid 3", 1, of_cylinder(2, 9), "#20a040");
  return model.write(folder, "assembly.step");
}

// The same box of 1 x 2 x 3 inches in a file in inches and in one in metres.
std::string in_unit(const std::string& folder, const std::string& name, const std::string& unit) {
  return single(folder, name, BRepPrimAPI_MakeBox(25.4, 50.8, 76.2).Shape(), of_box(25.4, 50.8, 76.2), unit);
}
std::string units(const std::string& folder) { return in_unit(folder, "units", "inch"); }
std::string metres(const std::string& folder) { return in_unit(folder, "metres", "m"); }

// Two roots that are no solids: a single face, and a box without its top.
std::string sheet(const std::string& folder) {
  Model model;
  model.product(BRepBuilderAPI_MakeFace(gp_Pln(), 0, 10, 0, 20).Face(), "face");
  BRepPrimAPI_MakeBox box(gp_Pnt(30, 0, 0), 10, 20, 5);
  TopoDS_Shell open;
  BRep_Builder builder;
  builder.MakeShell(open);
  for (const TopoDS_Face& face : {box.BottomFace(), box.LeftFace(), box.RightFace(), box.FrontFace(), box.BackFace()}) builder.Add(open, face);
  model.product(open, "open box");
  model.expect("/face", 1, {NAN, 200});
  model.expect("/open box", 1, {NAN, 200 + 2 * 50 + 2 * 100});
  return model.write(folder, "sheet.step");
}

// A wedge with a blind hole, which no rotation turns into its mirror image, and a mirrored copy of its geometry.
std::string mirrored(const std::string& folder) {
  const TopoDS_Shape hole = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(3, 3, 2), gp::DZ()), 1, 4).Shape();
  const TopoDS_Shape wedge = solid_of(BRepAlgoAPI_Cut(BRepPrimAPI_MakeWedge(10, 8, 6, 2).Shape(), hole).Shape());
  const double trapezoid = (10 + 2) / 2.0 * 8;
  const Measure measure = {trapezoid * 6 - 4 * kPi, 2 * trapezoid + (10 + 2 + 8 + std::hypot(8, 8)) * 6 + 2 * kPi * 4};
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp_Pnt(-2, 0, 0), gp_Dir(1, 0, 0.5)));
  Model model;
  const TDF_Label root = model.assembly("pair");
  model.place(root, model.product(wedge, "wedge"), {});
  model.place(root, model.product(BRepBuilderAPI_Transform(wedge, mirror, Standard_True).Shape(), "mirrored wedge"), {});
  model.expect("/pair/wedge", 1, measure);
  model.expect("/pair/mirrored wedge", 1, measure);
  return model.write(folder, "mirrored.step");
}

// A part with validation properties. Those of a liar say a volume that is 20 % too large.
std::string claimed(const std::string& folder, const std::string& name, double factor) {
  Model model;
  const Measure measure = of_box(10, 20, 30);
  const TDF_Label part = model.product(BRepPrimAPI_MakeBox(10, 20, 30).Shape(), name);
  XCAFDoc_Volume::Set(part, factor * measure.volume);
  XCAFDoc_Area::Set(part, measure.area);
  model.expect('/' + name, 1, measure);
  return model.write(folder, name + ".step");
}
std::string validated(const std::string& folder) { return claimed(folder, "validated", 1); }
std::string lying(const std::string& folder) { return claimed(folder, "lying", 1.2); }

// A plate with 30 x 30 holes, both rims of which are rounded: 2706 faces. They are made one by one, because 900 cuts would take minutes.
std::string big(const std::string& folder) {
  constexpr int n = 30;
  const double side = 10 * n, height = 10, r = 2, f = 1, rim = r + f;
  BRepBuilderAPI_Sewing sewing(1e-6);
  BRepPrimAPI_MakeBox box(side, side, height);
  for (const TopoDS_Face& face : {box.LeftFace(), box.RightFace(), box.FrontFace(), box.BackFace()}) sewing.Add(face);
  const auto middle = [](int hole, double z) { return gp_Pnt(10 * (hole % n) + 5, 10 * (hole / n) + 5, z); };
  for (const double z : {0., height}) {
    BRepBuilderAPI_MakeFace face(gp_Pln(gp_Ax3(gp_Pnt(0, 0, z), gp::DZ(), gp::DX())), 0, side, 0, side);
    for (int hole = 0; hole < n * n; ++hole) {
      const TopoDS_Wire ring = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(middle(hole, z), gp::DZ()), rim)));
      face.Add(TopoDS::Wire(ring.Reversed()));
    }
    sewing.Add(face.Face());
  }
  // The profile of a hole: an arc from the bottom, a line, and an arc to the top.
  const double c = f * (1 - std::sqrt(0.5));
  for (int hole = 0; hole < n * n; ++hole) {
    const auto at = [&](double rho, double z) { return middle(hole, z).Translated(gp_Vec(rho, 0, 0)); };
    const TopoDS_Edge lower = BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(rim, 0), at(r + c, c), at(r, f)).Value());
    const TopoDS_Edge upper = BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(r, height - f), at(r + c, height - c), at(rim, height)).Value());
    const TopoDS_Wire profile = BRepBuilderAPI_MakeWire(lower, BRepBuilderAPI_MakeEdge(at(r, f), at(r, height - f)), upper);
    sewing.Add(BRepPrimAPI_MakeRevol(profile, gp_Ax1(middle(hole, 0), gp::DZ())).Shape());
  }
  sewing.Perform();
  TopoDS_Solid plate = BRepBuilderAPI_MakeSolid(TopoDS::Shell(TopExp_Explorer(sewing.SewedShape(), TopAbs_SHELL).Current()));
  BRepLib::OrientClosedSolid(plate);
  // By Pappus' theorem: what a rounded rim takes away is a turned square without a quarter of a disk, and its face is a turned quarter of a circle.
  const double taken = 2 * kPi * (f * f * (r + f / 2) - kPi * f * f / 4 * (rim - 4 * f / (3 * kPi)));
  const double rounded = 2 * kPi * (kPi * f / 2) * (rim - 2 * f / kPi);
  const Measure whole = of_box(side, side, height);
  const double volume = whole.volume - n * n * (kPi * r * r * height + 2 * taken);
  const double area = whole.area + n * n * (2 * kPi * r * (height - 2 * f) + 2 * rounded - 2 * kPi * rim * rim);
  return single(folder, "big", plate, {volume, area});
}

// A vase through circles and ellipses.
std::string bspline(const std::string& folder) {
  BRepOffsetAPI_ThruSections sections(Standard_True);
  const double radii[][2] = {{10, 10}, {14, 9}, {8, 6}, {12, 12}};
  for (int i = 0; i < 4; ++i) {
    const gp_Ax2 axes(gp_Pnt(0, 2 * i, 12 * i), gp::DZ(), gp::DX());
    sections.AddWire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Elips(axes, radii[i][0], radii[i][1])).Edge()));
  }
  sections.Build();
  return single(folder, "bspline", sections.Shape(), integrated(sections.Shape()));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("usage: step_models FOLDER");
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));  // They write to standard output.
  XCAFDoc_ShapeTool::SetAutoNaming(Standard_False);
  std::string out;
  for (const auto model : {sphere, torus, cylinders, nested, pipe, bolts, assembly, units, metres, sheet, mirrored, validated, lying, big, bspline})
    out += (out.empty() ? "  " : ",\n  ") + model(argv[1]);
  std::cout << "{\n" << out << "\n}\n";
  return std::cout.flush() ? 0 : 1;
} catch (const Standard_Failure& e) {
  std::cerr << "step_models: " << e.DynamicType()->Name() << ": " << e.GetMessageString() << '\n';
  return 1;
} catch (const std::exception& e) {
  std::cerr << "step_models: " << e.what() << '\n';
  return 1;
}

// The XML file of openEMS: materials as boxes, and the planes as lines of the grid. Its CSXCAD of Debian 12 can't read a DiscMaterial (the
// profile openems of HDF5), but it reads boxes.
#include <cmath>

#include <fmt/format.h>

#include "store/base/output_file.hpp"
#include "store/text/color.hpp"
#include "store/text/xml.hpp"
#include "tools/export/media.hpp"
#include "tools/export/openems/boxes.hpp"
#include "tools/export/place.hpp"
#include "tools/export/solvers.hpp"

namespace teracell::exports {
namespace {

constexpr size_t kMostBoxes = 100'000;

class Xml {
 public:
  explicit Xml(const Export& e) : e_(e), file_(e.output) {}

  void write(const std::vector<Medium>& media, const std::vector<MaterialBox>& boxes, double metre) {
    add("<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n<openEMS>\n"
        "  <!-- Cells by teracell. What a run needs besides is yours: an excitation, time steps, boundary conditions, probes. -->\n"
        "  <FDTD NumberOfTimesteps=\"0\" endCriteria=\"1e-5\">\n"
        "    <Excitation Type=\"0\" f0=\"0\" fc=\"0\"/>\n"
        "    <BoundaryCond xmin=\"0\" xmax=\"0\" ymin=\"0\" ymax=\"0\" zmin=\"0\" zmax=\"0\"/>\n  </FDTD>\n"
        "  <ContinuousStructure CoordSystem=\"0\">\n");
    add(fmt::format("    <RectilinearGrid DeltaUnit=\"{}\" CoordSystem=\"0\">\n", metre));
    for (int d = 0; d < 3; ++d) {
      const char name = "XYZ"[d];
      add(fmt::format("      <{}Lines>{}", name, plane_of(e_, d, 0)));
      for (int64_t i = 1; i <= size_of(e_.box)[d]; ++i) add(fmt::format(",{}", plane_of(e_, d, i)));
      add(fmt::format("</{}Lines>\n", name));
    }
    add("    </RectilinearGrid>\n    <Properties>\n");
    for (size_t i = 0; i < boxes.size();) {
      size_t end = i;
      while (end < boxes.size() && boxes[end].material == boxes[i].material) ++end;
      add_material(boxes[i].material, media[boxes[i].material], std::span(boxes).subspan(i, end - i));
      i = end;
    }
    add("    </Properties>\n  </ContinuousStructure>\n</openEMS>\n");
  }
  void commit() { file_.commit(); }

 private:
  void add(const std::string& text) { file_.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()}); }
  void add_point(const char* name, const std::array<int32_t, 3>& p) {
    add(fmt::format("<{} X=\"{}\" Y=\"{}\" Z=\"{}\"/>", name, plane_of(e_, 0, p[0]), plane_of(e_, 1, p[1]), plane_of(e_, 2, p[2])));
  }
  void add_material(uint32_t id, const Medium& m, std::span<const MaterialBox> boxes) {
    const MaterialInfo& info = e_.reader.meta().materials[id];
    const bool metal = std::isinf(m.sigma);
    add(fmt::format("      <{} ID=\"{}\" Name=\"{}\">\n", metal ? "Metal" : "Material", id, xml_text(info.name)));
    if (const auto c = parse_color(info.color))
      for (const char* what : {"FillColor", "EdgeColor"})
        add(fmt::format("        <{} R=\"{}\" G=\"{}\" B=\"{}\" a=\"{}\"/>\n", what, (*c)[0], (*c)[1], (*c)[2], (*c)[3]));
    if (!metal) add(fmt::format("        <Property Epsilon=\"{}\" Mue=\"{}\" Kappa=\"{}\" Sigma=\"0\"/>\n", m.epsilon, m.mu, m.sigma));
    add("        <Primitives>\n");
    for (const MaterialBox& box : boxes) {
      // Edges between a metal and another material conduct, which openEMS leaves to the priorities.
      add(fmt::format("          <Box Priority=\"{}\">", metal ? 2 : 1));
      add_point("P1", box.lo);
      add_point("P2", box.hi);
      add("</Box>\n");
    }
    add(fmt::format("        </Primitives>\n      </{}>\n", metal ? "Metal" : "Material"));
  }

  const Export& e_;
  OutputFile file_;
};

void write_openems(const Export& asked) {
  const Export e = for_layers(asked);
  const double metre = metres(e.reader.meta().units, "openEMS");
  const std::vector<Medium> media = media_of(e, false);
  std::vector<bool> in_mesh;
  for (const Medium& m : media) in_mesh.push_back(m.given);
  Xml xml(e);
  LayerReader reader(e, in_mesh);
  Layer layer;
  BoxMerger merger(kMostBoxes);
  const int64_t layers = size_of(e.box)[2];
  for (int64_t z = 0; z < layers; ++z) {
    e.progress(static_cast<double>(z) / static_cast<double>(layers));
    reader.read(z, layer);
    merger.add(layer, static_cast<int32_t>(z));
  }
  xml.write(media, merger.finish(), metre);
  e.progress(1);
  xml.commit();
}

}  // namespace

ExportFormat openems_format() { return {"openems", {}, "boxes of materials in an XML file of openEMS", write_openems, false, media_options()}; }

}  // namespace teracell::exports

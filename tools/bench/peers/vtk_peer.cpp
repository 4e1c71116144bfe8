// VTK: vtkOBJReader -> vtkPolyDataToImageStencil -> vtkImageStencilToImage. The time to beat is that of the whole process.
// Usage: vtk_peer mesh.obj N [out.raw]
//
// The image, one byte per cell, is VTK's product and stays in memory: writing 10^9 bytes would only slow this peer. With
// out.raw it is written (C order [z][y][x]), so that cells can be compared.
#include <vtkImageData.h>
#include <vtkImageStencilToImage.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPolyData.h>
#include <vtkPolyDataToImageStencil.h>

#include <cstdio>

#include "tools/bench/peers/mesh_domain.hpp"

namespace teracell::bench {
namespace {

void run(const Arguments& arguments) {
  const Stopwatch whole;
  const int64_t n = whole_number(arguments[1]);
  vtkNew<vtkOBJReader> reader;
  reader->SetFileName(arguments[0].c_str());
  reader->Update();
  double bounds[6];
  reader->GetOutput()->GetBounds(bounds);
  const CubicDomain domain = cubic_domain({bounds[0], bounds[2], bounds[4]}, {bounds[1], bounds[3], bounds[5]}, n);
  const int last = static_cast<int>(n) - 1;

  vtkNew<vtkPolyDataToImageStencil> stencil;
  stencil->SetInputConnection(reader->GetOutputPort());
  stencil->SetOutputOrigin(domain.centre(0, 0), domain.centre(1, 0), domain.centre(2, 0));
  stencil->SetOutputSpacing(domain.step, domain.step, domain.step);
  stencil->SetOutputWholeExtent(0, last, 0, last, 0, last);
  vtkNew<vtkImageStencilToImage> image;
  image->SetInputConnection(stencil->GetOutputPort());
  image->SetInsideValue(1);
  image->SetOutsideValue(0);
  image->SetOutputScalarTypeToUnsignedChar();
  image->Update();
  const double seconds = whole.seconds();

  const auto* cells = static_cast<const uint8_t*>(image->GetOutput()->GetScalarPointer());
  if (arguments.size() > 2) std::ofstream(arguments[2], std::ios::binary).write(reinterpret_cast<const char*>(cells), n * n * n);
  std::printf("{\"peer\": \"vtk\", \"seconds\": %.4f, \"centre_cell\": %d}\n", seconds, int{cells[(n / 2 * n + n / 2) * n + n / 2]});
}

}  // namespace
}  // namespace teracell::bench

int main(int argc, char** argv) { return teracell::bench::peer_main(argc, argv, "vtk_peer mesh.obj N [out.raw]", 2, 3, teracell::bench::run); }

// OpenCASCADE alone: step_peer FILE.step DEFLECTION DEGREES reads the file with names and colours, tessellates all of it on all threads, and prints
// the seconds of both.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <BRepMesh_IncrementalMesh.hxx>
#include <OSD_Parallel.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); };
  const auto began = Clock::now();
  Handle(TDocStd_Document) document = new TDocStd_Document("peer");
  STEPCAFControl_Reader reader;
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  if (reader.ReadFile(argv[1]) != IFSelect_RetDone || !reader.Transfer(document)) return 1;
  const double read = seconds_since(began);
  const auto read_at = Clock::now();
  OSD_Parallel::SetUseOcctThreads(true);
  TDF_LabelSequence shapes;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(shapes);
  for (int i = 1; i <= shapes.Length(); ++i) {
    IMeshTools_Parameters parameters;
    parameters.Deflection = std::atof(argv[2]);
    parameters.Angle = std::atof(argv[3]) * 3.14159265358979323846 / 180;
    parameters.InParallel = true;
    BRepMesh_IncrementalMesh(XCAFDoc_ShapeTool::GetShape(shapes.Value(i)), parameters);
  }
  std::printf("{\"read\": %.6f, \"tessellate\": %.6f}\n", read, seconds_since(read_at));
  std::fflush(stdout);
  std::_Exit(0);  // what it would take to give memory back is no part of the work
}

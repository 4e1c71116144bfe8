// The files of a polyMesh folder, laid out from counts. Lists are binary with labels of 32 bits and scalars of 64.
#pragma once
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "tools/export/openfoam/counts.hpp"

namespace teracell::exports::foam {

// ---- Streams.
//
// Many places in many files that are written to in turn. What is put is kept in buffers, which together have a bounded size; no file is
// open but while bytes are written.

class Stream;

// The streams that have a buffer. It must outlive them. Not thread-safe.
class Streams {
  friend class Stream;
  std::vector<Stream*> buffered_;
  size_t bytes_ = 0;
};

struct Place {
  std::shared_ptr<const std::filesystem::path> file;
  uint64_t at;
};

// Bytes that follow each other from a place of a file on. Destroyed without close(), it forgets what is not written yet.
class Stream {
 public:
  Stream(Streams& all, Place place) : all_(all), place_(std::move(place)) {}
  Stream(const Stream&) = delete;
  ~Stream() { release(); }
  // REQUIRES: T is small and has no padding. Little endian, like every machine this runs on.
  template <class T>
  void put(const T& value) {
    if (capacity_ - size_ < sizeof(T)) make_room();
    std::memcpy(buffer_.get() + size_, &value, sizeof(T));
    size_ += sizeof(T);
  }
  // Writes what was put.
  void close();

 private:
  void make_room();
  void flush();
  void release();

  Streams& all_;
  Place place_;
  std::unique_ptr<uint8_t[]> buffer_;
  size_t size_ = 0, capacity_ = 0;
};

// ---- Files.

// What 32-bit labels of OpenFOAM can hold: the largest number and longest list, and the faces of a mesh, whose lists of points are four times as
// long.
inline constexpr int64_t kMostLabel = (int64_t{1} << 31) - 1, kMostFaces = kMostLabel / 4;

struct NamedPatch {
  std::string name;
  std::string type;  // of OpenFOAM
};

// What a part of the mesh is called, and which patches and zones it has. All parts have the same, be they empty.
struct MeshNames {
  std::map<uint32_t, NamedPatch> patches;     // by what lies beyond
  std::map<uint32_t, std::string> zones;     // by material; empty: no zones
  bool addressing = false;                   // whether parts tell their numbers in the whole mesh, for reconstructPar
};

// Streams to the lists of one part of the mesh. Points, cells and faces of a group are put in their order.
class MeshFiles {
 public:
  struct Group {
    Group(Streams& streams, const Place& faces_at, const Place& owner_at) : faces(streams, faces_at), owner(streams, owner_at) {}
    Stream faces, owner;
    std::optional<Stream> address;  // in the whole mesh
  };

  // Makes the folder and all that does not depend on single cells.
  MeshFiles(const std::filesystem::path& folder, uint32_t part, const PartCounts& counts, const MeshNames& names, Streams& streams);
  void close();

  Group& group(FaceGroup g) { return groups_.at(g); }
  Stream& zone(uint32_t material) { return zones_.at(material); }
  std::optional<Stream> points, neighbour, point_address, cell_address;

 private:
  std::map<FaceGroup, Group> groups_;
  std::map<uint32_t, Stream> zones_;
};

}  // namespace teracell::exports::foam

#include "tools/sample/stadium.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "mesher/scene/scene.hpp"
#include "store/base/error.hpp"
#include "tools/sample/solid.hpp"

namespace teracell::sample {
namespace {

// Metres throughout. x runs along the pitch, z = 0 is the ground. Everything is placed by station (around the oval),
// d (outwards from the line along the foot of the lower tier) and z.
constexpr int kBay = 5;  // stations from one frame of the structure to the next
constexpr int kBays = 52, kQuarterBays = 13;
constexpr int kStations = kBays * kBay, kQuarter = kQuarterBays * kBay;

// A rounded rectangle of circular arcs that meet without a kink: a wide one at the ends, a tight one in the corners,
// the widest along the sides. Lines at equal d are true parallels, so treads keep their depth all around.
class Oval {
 public:
  Oval() {
    constexpr double kEnd = 18, kCorner = 62;                           // degrees of the normal where the arcs meet
    constexpr int kEndStations = 3 * kBay, kCornerStations = 4 * kBay;  // the sides have the rest
    constexpr double kEndRadius = 70, kCornerRadius = 24, kHalfLength = 68;
    const auto [end_c, end_s] = direction(kEnd);
    const auto [corner_c, corner_s] = direction(kCorner);
    const double end_x = kHalfLength - kEndRadius;
    const double corner_x = end_x + (kEndRadius - kCornerRadius) * end_c, corner_y = (kEndRadius - kCornerRadius) * end_s;
    const double side_radius = kCornerRadius + corner_x / corner_c;  // its centre lies on x = 0
    const double side_y = corner_y - (side_radius - kCornerRadius) * corner_s;

    std::vector<Station> quarter;
    for (int i = 0; i <= kQuarter; ++i) {
      const int in_corner = i - kEndStations, on_side = in_corner - kCornerStations;
      if (in_corner <= 0) quarter.push_back(on_arc(end_x, 0, kEndRadius, kEnd * i / kEndStations));
      else if (on_side <= 0) quarter.push_back(on_arc(corner_x, corner_y, kCornerRadius, kEnd + (kCorner - kEnd) * in_corner / kCornerStations));
      else quarter.push_back(on_arc(0, side_y, side_radius, kCorner + (90 - kCorner) * on_side / (kQuarter - kEndStations - kCornerStations)));
    }
    for (int s = 0; s < kStations; ++s) {  // mirrored, so that the symmetry is exact
      const int q = s / kQuarter, r = s % kQuarter;
      Station station = quarter[q % 2 == 0 ? r : kQuarter - r];
      if (q == 1 || q == 2) station.x = -station.x, station.nx = -station.nx;
      if (q >= 2) station.y = -station.y, station.ny = -station.ny;
      stations_.push_back(station);
    }
  }

  // `aside` steps off the station, counter-clockwise.
  Vec3 at(int station, double d, double z, double aside = 0) const {
    const Station& s = stations_[(station + kStations) % kStations];
    return {s.x + d * s.nx - aside * s.ny, s.y + d * s.ny + aside * s.nx, z};
  }

 private:
  struct Station {
    double x, y, nx, ny;
  };
  static std::pair<double, double> direction(double degrees) {
    const mesher::Matrix turn = mesher::rotation({0, 0, 1}, degrees);
    return {turn[0], turn[4]};
  }
  static Station on_arc(double x, double y, double radius, double degrees) {
    const auto [c, s] = direction(degrees);
    return {x + radius * c, y + radius * s, c, s};
  }
  std::vector<Station> stations_;
};

// An outline in (d, z), a ladder like Section.
struct Profile {
  std::vector<std::array<double, 2>> low, high;
};

Profile rectangle(double d0, double d1, double z0, double z1) { return {{{d0, z0}, {d1, z0}}, {{d0, z1}, {d1, z1}}}; }

// Between two curves z(d).
template <typename Low, typename High>
Profile strip(double d0, double d1, int rungs, Low low, High high) {
  Profile p;
  for (int i = 0; i <= rungs; ++i) {
    const double d = d0 + (d1 - d0) * i / rungs;
    p.low.push_back({d, low(d)});
    p.high.push_back({d, high(d)});
  }
  return p;
}

// Rows of seats on a stepped slab that grows steeper towards the back, as sight lines want it.
struct Tier {
  double d, z, rise, growth;
  int rows;
  static constexpr double kTread = 1, kThickness = 2.2;

  double height(double row) const { return z + rise * row + growth * row * row / 2; }
  double underside(double at_d) const { return std::max(-0.5, height((at_d - d) / kTread) - kThickness); }
  Profile profile(int from, int to) const {
    Profile p;
    const int rungs = 2 * (to - from);
    for (int j = 0; j < rungs; ++j) {
      const int row = from + j / 2;
      const double under = d + kTread * (from + (to - from) * static_cast<double>(j) / (rungs - 1));
      p.high.push_back({d + kTread * (row + j % 2), height(row)});
      p.low.push_back({under, underside(under)});
    }
    return p;
  }
};

constexpr Tier kLower = {0, 1.2, 0.42, 0.008, 25};
constexpr Tier kUpper = {21, 19, 0.6, 0.012, 22};

double roof(double d) {  // its underside
  const double u = (d - 3) / 51;
  return 42 + 7 * u - 4 * u * u;
}
double truss(double d) { return roof(d) - (d < 46 ? 1 + 4 * (d - 4) / 42 : 5 - 3 * (d - 46) / 7); }  // its lower chord

class Stadium {
 public:
  Solid ground() const {
    Solid solid;
    solid.box({-150, -120, -3}, {150, 120, 0});
    return solid;
  }

  // Ways through the rows: a stair mouth in every bay, and in each corner a tunnel from the pitch.
  Solid lower_tier() const {
    constexpr int kMouth = 10, kAbove = 14;
    Solid solid;
    const Profile front = kLower.profile(0, kMouth), middle = kLower.profile(kMouth, kAbove);
    const std::vector<int> tunnels = mirrored({4});
    for (size_t i = 0; i < tunnels.size(); ++i) {
      const int next = i + 1 < tunnels.size() ? tunnels[i + 1] : tunnels[0] + kBays;
      sweep(solid, front, tunnels[i] * kBay + 4, next * kBay + 1);
    }
    for (int bay = 0; bay < kBays; ++bay) sweep(solid, middle, bay * kBay + 3, bay * kBay + kBay + 2);
    ring(solid, kLower.profile(kAbove, kLower.rows));
    return solid;
  }

  Solid upper_tier() const {
    constexpr int kMouth = 8, kAbove = 12;
    Solid solid;
    ring(solid, kUpper.profile(0, kMouth));
    const Profile middle = kUpper.profile(kMouth, kAbove);
    for (int bay = 0; bay < kBays; ++bay) sweep(solid, middle, bay * kBay + 3, bay * kBay + kBay + 2);
    ring(solid, kUpper.profile(kAbove, kUpper.rows));
    ring(solid, rectangle(kUpper.d - 0.4, kUpper.d + 0.6, kUpper.z - 2, kUpper.z + 1));  // parapet
    return solid;
  }

  // Radial walls under the lower tier, columns behind it, raking beams that carry the upper tier; floors, and what
  // stands on them: a ring wall with doors, boxes between the tiers, stair cores.
  Solid frames() const {
    Solid solid;
    const auto under_lower = [](double d) { return kLower.underside(d) + 0.4; };
    const Profile wall = strip(
        9, 25, 8, [](double) { return -0.5; }, under_lower);
    const Profile raker = strip(
        21.4, 43, 8, [](double d) { return kUpper.underside(d) - 1.6; }, [](double d) { return kUpper.underside(d) + 0.4; });
    const std::vector<int> tunnels = mirrored({4}), cores = mirrored({2, 6, 10});
    const auto among = [](const std::vector<int>& bays, int bay) { return std::find(bays.begin(), bays.end(), bay) != bays.end(); };
    for (int bay = 0; bay < kBays; ++bay) {
      const int frame = bay * kBay;
      plate(solid, wall, frame, 1);
      plate(solid, raker, frame, 1);
      for (const double d : {27.0, 34.5, 42.0}) plate(solid, rectangle(d - 0.8, d + 0.8, -0.5, kUpper.underside(d)), frame, 1.6);
      plate(solid, rectangle(26.4, 33, 15, 23), frame, 1);
      sweep(solid, rectangle(32, 33, 15, 23), frame + 1, frame + 4);
      if (!among(tunnels, bay)) sweep(solid, rectangle(26.4, 27.6, -0.5, 14), frame + 1, frame + 4);
      if (!among(cores, bay)) continue;
      for (const int side : {1, 4}) plate(solid, rectangle(34, 43, -0.5, 31), frame + side, 1);
      sweep(solid, rectangle(34, 35, -0.5, 31), frame + 1, frame + 4);
    }
    for (const auto& [d, z] : {std::pair{18.0, 7.0}, {24.6, 14.0}, {31.5, 23.0}, {42.0, 31.0}}) ring(solid, rectangle(d, 50, z, z + 1));
    return solid;
  }

  // Piers at the frames, a wall between them on the ground but for the gates, bands at the floors, fins in between.
  Solid facade() const {
    Solid solid;
    const std::vector<int> gates = mirrored({1, 4, 8, 11});
    for (int bay = 0; bay < kBays; ++bay) {
      plate(solid, rectangle(48.5, 51.2, -0.5, 42), bay * kBay, 1.6);
      for (int fin = 1; fin < kBay; ++fin) plate(solid, rectangle(49.8, 51, 8, 36), bay * kBay + fin, 0.8);
      if (std::find(gates.begin(), gates.end(), bay) == gates.end()) sweep(solid, rectangle(49.6, 51, -0.5, 7), bay * kBay, bay * kBay + kBay);
    }
    for (const auto& [z0, z1] : {std::pair{6.0, 9.0}, {14.0, 16.0}, {22.5, 24.5}, {30.5, 32.5}, {35.0, 37.0}})
      ring(solid, rectangle(49.5, 51, z0, z1));
    return solid;
  }

  // A sheet on radial trusses that cantilever over the seats, held at the back by legs that spread in Vs.
  Solid roof_ring() const {
    Solid solid;
    ring(solid, strip(3, 54, 16, roof, [](double d) { return roof(d) + 1; }));
    for (const auto& [d0, d1, depth] : {std::array{3.0, 4.4, 2.0}, {24.4, 25.6, 2.6}, {45.4, 46.6, 5.0}, {50.4, 52.0, 2.0}})
      ring(solid, strip(
                      d0, d1, 1, [below = depth](double d) { return roof(d) - below; }, [](double d) { return roof(d) + 0.2; }));

    const Profile chord = strip(4, 53, 12, truss, [](double d) { return truss(d) + 0.9; });
    for (int bay = 0; bay < kBays; ++bay) {
      const int frame = bay * kBay;
      plate(solid, chord, frame, 1);
      for (int panel = 0; panel < 6; ++panel) {  // W-shaped webs
        const double d = 10 + 6 * panel;
        solid.bar(oval_.at(frame, d, truss(d) + 0.4), oval_.at(frame, d + 3, roof(d + 3) + 0.3), 0.45, 0.45);
        solid.bar(oval_.at(frame, d + 3, roof(d + 3) + 0.3), oval_.at(frame, d + 6, truss(d + 6) + 0.4), 0.45, 0.45);
      }
      plate(solid, rectangle(48.6, 50, 41.5, roof(49) + 0.3), frame, 1.4);  // the pier goes on to the roof
      plate(solid, rectangle(56.2, 58.8, -0.5, 1), frame, 3);               // footing
      for (const int lean : {-2, 2}) solid.bar(oval_.at(frame, 57.5, 0), oval_.at(frame + lean, 51.2, 44.2), 0.9, 0.7);
    }
    return solid;
  }

  Solid floodlights() const {
    Solid solid;
    for (const int station : {25, kStations / 2 - 25, kStations / 2 + 25, kStations - 25}) {
      plate(solid, rectangle(63.5, 68.5, -0.5, 1.5), station, 5);
      solid.bar(oval_.at(station, 66, 0), oval_.at(station, 66, 50), 1.8, 1);
      plate(solid, {{{64.6, 46.5}, {66.2, 46.5}}, {{62.6, 55.5}, {64.2, 55.5}}}, station, 12);
    }
    return solid;
  }

  Solid scoreboards() const {
    Solid solid;
    for (const int station : {0, kStations / 2}) {
      plate(solid, {{{7, 30.5}, {8.5, 30.5}}, {{5.8, 38.5}, {7.3, 38.5}}}, station, 20);
      for (const double aside : {-7.0, 7.0}) solid.bar(oval_.at(station, 6.6, 38, aside), oval_.at(station, 6.6, roof(6.6) + 0.4, aside), 0.5, 0.5);
    }
    return solid;
  }

  // A road tanker on the track in front of the side stand; the charge is what it carries.
  static constexpr double kTruckX = 17, kTruckY = -42.5, kTankZ = 3.3;
  Solid truck() const {
    Solid solid;
    const double x = kTruckX, y = kTruckY;
    solid.box({x - 7, y - 1.2, 0.9}, {x + 8, y + 1.2, 1.7});
    solid.box({x + 7.6, y - 1.4, 0.8}, {x + 10.2, y + 1.4, 3.8});
    for (const double axle : {-5.6, -4.0, -2.4, 5.4, 8.9})
      for (const double side : {-1.45, 0.75}) solid.bar({x + axle, y + side, 0.65}, {x + axle, y + side + 0.7, 0.65}, 0.7, 0.7);
    for (const double saddle : {-4.5, 0.0, 4.5}) solid.box({x + saddle - 0.5, y - 1.3, 1.5}, {x + saddle + 0.5, y + 1.3, 2.3});
    return solid;
  }
  Solid charge() const {
    Solid solid;
    solid.capsule({kTruckX, kTruckY, kTankZ}, 4.6, 1.8);
    return solid;
  }

 private:
  // The bays that mirror the given ones of the first quarter, ascending.
  static std::vector<int> mirrored(const std::vector<int>& bays) {
    std::vector<int> all;
    for (const int bay : bays)
      for (const int half : {0, kBays / 2}) all.insert(all.end(), {half + bay, half + 2 * kQuarterBays - 1 - bay});
    std::sort(all.begin(), all.end());
    return all;
  }

  Section section(const Profile& profile, int station, double aside = 0) const {
    Section s;
    for (const auto& [d, z] : profile.low) s.low.push_back(oval_.at(station, d, z, aside));
    for (const auto& [d, z] : profile.high) s.high.push_back(oval_.at(station, d, z, aside));
    return s;
  }
  // Clockwise, the way in which a profile with d to the right and z up is seen counter-clockwise from ahead.
  void sweep(Solid& solid, const Profile& profile, int from, int to) const {
    std::vector<Section> sections;
    for (int station = to; station >= from; --station) sections.push_back(section(profile, station));
    solid.loft(sections);
  }
  void ring(Solid& solid, const Profile& profile) const {
    std::vector<Section> sections;
    for (int station = kStations - 1; station >= 0; --station) sections.push_back(section(profile, station));
    solid.loft(sections, true);
  }
  void plate(Solid& solid, const Profile& profile, int station, double width) const {
    solid.loft({section(profile, station, width / 2), section(profile, station, -width / 2)});
  }

  Oval oval_;
};

constexpr const char* kSceneJson = R"json({
  "units": "m",
  "grid": {"min": [-150, -120, -3], "max": [150, 120, 57], "cells": [300, 240, 60]},
  "background": "air",
  "materials": {
    "air": {"color": "#00000000"},
    "explosive": {"color": "#d55e00"},
    "grandstand": {"color": "#56b4e9"},
    "structure": {"color": "#5b6470"}
  },
  "bodies": [
    {"name": "lower tier", "mesh": "lower-tier.stl", "material": "grandstand", "priority": 0},
    {"name": "upper tier", "mesh": "upper-tier.stl", "material": "grandstand", "priority": 0},
    {"name": "ground", "mesh": "ground.stl", "material": "structure", "priority": 1},
    {"name": "frames", "mesh": "frames.stl", "material": "structure", "priority": 1},
    {"name": "facade", "mesh": "facade.stl", "material": "structure", "priority": 1},
    {"name": "roof", "mesh": "roof.stl", "material": "structure", "priority": 1},
    {"name": "floodlights", "mesh": "floodlights.stl", "material": "structure", "priority": 1},
    {"name": "scoreboards", "mesh": "scoreboards.stl", "material": "structure", "priority": 1},
    {"name": "truck", "mesh": "truck.stl", "material": "structure", "priority": 1},
    {"name": "charge", "mesh": "charge.stl", "material": "explosive", "priority": 2}
  ]
}
)json";

}  // namespace

void write_stadium(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error))
    throw IoError(fmt::format("{}: expected a folder, or none yet, found something else", folder.string()));
  const bool new_folder = std::filesystem::create_directories(folder, error);
  if (error) throw IoError(fmt::format("{}: the folder can't be made: {}", folder.string(), error.message()));
  const Stadium stadium;
  std::vector<std::filesystem::path> written;
  const auto stl = [&](const char* name, const Solid& solid) {
    solid.write_stl(folder / name);
    written.push_back(folder / name);
  };
  try {
    stl("lower-tier.stl", stadium.lower_tier());
    stl("upper-tier.stl", stadium.upper_tier());
    stl("ground.stl", stadium.ground());
    stl("frames.stl", stadium.frames());
    stl("facade.stl", stadium.facade());
    stl("roof.stl", stadium.roof_ring());
    stl("floodlights.stl", stadium.floodlights());
    stl("scoreboards.stl", stadium.scoreboards());
    stl("truck.stl", stadium.truck());
    stl("charge.stl", stadium.charge());
    write_whole(folder / "scene.json", kSceneJson);
  } catch (...) {  // a full disk: half a scene is of no use
    for (const auto& path : written) std::filesystem::remove(path, error);
    if (new_folder) std::filesystem::remove(folder, error);
    throw;
  }
}

}  // namespace teracell::sample

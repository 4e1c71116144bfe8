// A stored grid served to other people's clients, its cells by brute force, and what their clients do with an answer.
#pragma once
#include <nlohmann/json.hpp>

#include "server/routes.hpp"
#include "store/color.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {

class ServedCells {
 public:
  // Random cells of `labels` labels (below 64) on `grid`; label i > 0 is of material i + shift: ids may pass a byte.
  ServedCells(const Grid& grid, int ray_axis, uint32_t labels, uint32_t shift = 0, const std::string& id = "g");

  // By way of handle(), as any client gets it.
  Response get(const std::string& target);
  Response get(const Request& request);
  nlohmann::ordered_json json(const std::string& target);  // REQUIREs 200 and JSON
  // Of every cell of a level, from the cells of level 0, C order: the strongest material; the blend of its materials.
  std::vector<uint32_t> materials(int level) const;
  std::vector<Rgba> colors(int level) const;

  const Metadata& meta() const { return meta_; }
  const std::filesystem::path& file() const { return path_; }

 private:
  TempFolder folder_;
  std::filesystem::path path_;
  Metadata meta_;
  std::vector<Label> cells_;
  std::unique_ptr<Service> service_;
};

// 70 x 130 x 67 cells of 0.1 from (-3, 1, 2.5) on, the first of x the fifth of a larger grid.
Grid odd_grid();
// The same with graded y.
Grid graded_grid();

// Of a zlib or gzip stream.
std::string inflated(const std::string& bytes, size_t expected);
// Ids of one or two bytes, little endian.
std::vector<uint32_t> ids_of(const std::string& bytes, size_t width);

struct Png {
  int64_t width = 0, height = 0;
  std::vector<Rgba> pixels;  // row by row from the top
};
Png png_of(const std::string& bytes);

// REQUIREs 404 without a byte.
void require_missing(const Response& response);

}  // namespace teracell::testing

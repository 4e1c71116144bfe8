// A grid of random cells as clients of the protocols get it, its cells by brute force, and what clients do with an answer.
#pragma once
#include "server/service/service.hpp"
#include "store/text/color.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {

class ServedCells {
 public:
  // Random cells of `labels` labels (below 64) on `grid`; label i > 0 has material i + shift, so that ids may exceed 255.
  ServedCells(const Grid& grid, int ray_axis, uint32_t labels, uint32_t shift = 0, const std::string& id = "g");

  // What handle() answers.
  server::Response get(const std::string& target);
  server::Response get(const server::Request& request);
  nlohmann::ordered_json json(const std::string& target);  // REQUIREs 200 and JSON
  // For every cell of a level in C order, computed from the cells of level 0: its strongest material, and the blend of its
  // materials.
  std::vector<uint32_t> materials(int level) const;
  std::vector<Rgba> colors(int level) const;

  const Metadata& meta() const { return meta_; }
  const std::filesystem::path& file() const { return path_; }

 private:
  TempFolder folder_;
  std::filesystem::path path_;
  Metadata meta_;
  std::vector<Label> cells_;
  std::unique_ptr<server::Service> service_;
};

// 70 x 130 x 67 cells of width 0.1 with the origin (-3, 1, 2.5). Along x the first cell is number 5 from the origin.
Grid odd_grid();
// The same with graded y.
Grid graded_grid();

// What a zlib or gzip stream holds. REQUIREs `expected` bytes.
std::string inflated(const std::string& bytes, size_t expected);
// Ids of one or two bytes, little endian.
std::vector<uint32_t> ids_of(const std::string& bytes, size_t width);

// The cells of an array of `n` from its blocks of `c`, all in C order [z][y][x]. REQUIREs that what is beyond the array is 0.
std::vector<uint32_t> joined_blocks(const std::vector<int64_t>& n, const std::vector<int64_t>& c,
                                    const std::function<std::vector<uint32_t>(int64_t kz, int64_t ky, int64_t kx)>& block);

// REQUIREs status 404 and an empty body.
void require_missing(const server::Response& response);
// Of each path.
void require_missing(ServedCells& served, const std::vector<std::string>& paths);

}  // namespace teracell::testing

// A ZIP package, such as a 3MF file: its files are unpacked as a stream, by Minizip, which comes with zlib.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "mesher/surface/contents.hpp"

namespace teracell::mesher {

class ZipPackage {
 public:
  // Throws InputError when this is no package. `contents` must outlive it.
  ZipPackage(std::string name, const Contents& contents);
  ~ZipPackage();
  const std::string& name() const { return name_; }
  bool has(const std::string& file) const;
  // Calls take(some bytes) until the end, or until it returns false. Throws InputError for what can't be unpacked (no such file,
  // damaged, encrypted, compressed in an unknown way) and for what unpacks to so many times its size that it can only be a trap.
  void read(const std::string& file, const std::function<bool(std::string_view)>& take) const;

 private:
  struct Source;
  struct Close {
    void operator()(void*) const;
  };
  std::string name_;
  std::unique_ptr<Source> source_;
  std::unique_ptr<void, Close> zip_;
};

}  // namespace teracell::mesher

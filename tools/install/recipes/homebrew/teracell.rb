# For a tap of Homebrew: Formula/teracell.rb. "../fill" writes version, url and sha256.
class Teracell < Formula
  desc "Trillion-cell Cartesian grids from CAD surfaces"
  url "https://not-published.invalid/teracell-0.1.0.tar.gz"
  version "0.1.0"
  sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  license :cannot_represent

  depends_on "boost" => :build
  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "node" => :build
  depends_on "pkgconf" => :build
  depends_on "curl"
  depends_on "expat"
  depends_on "fmt"
  depends_on "hdf5"
  # What is left for macOS: CONTRIBUTING.md, "Building".
  depends_on :linux
  depends_on "minizip"
  depends_on "xxhash"
  depends_on "zlib-ng-compat"
  depends_on "zstd"

  # Homebrew has no formula of stb.
  resource "stb" do
    url "https://github.com/nothings/stb/raw/f58f558c120e9b32c217290b80bad1a0729fbb2c/stb_image_write.h"
    sha256 "cbd5f0ad7a9cf4468affb36354a1d2338034f2c12473cf1a8e32053cb6914a05"
  end

  def install
    (buildpath/"stb-include/stb").install resource("stb")
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", *std_cmake_args, "-DTERACELL_UNITY=ON", "-DTERACELL_WEB=ON", "-DTERACELL_LIBRARY=ON",
           "-DSTB_INCLUDE_DIR=#{buildpath}/stb-include"
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"teracell", "sample", "stadium", "-o", "stadium"
    system bin/"teracell", "mesh", "stadium/scene.json", "--cells", "200", "-o", "stadium.tcell"
    assert_match "sound", shell_output("#{bin}/teracell verify stadium.tcell")
    system bin/"teracell", "export", "stadium.tcell", "--region", "0,0,0,8,8,8", "-o", "box.h5"
    assert_path_exists testpath/"box.h5"
  end
end

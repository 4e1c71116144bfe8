#!/usr/bin/ruby
# tests/install/homebrew.rb: builds and tests as the formula of Homebrew says, with Debian's packages in place of Homebrew's. It needs ruby and what
# packages.sh lists for a build. It stands in for the part of Homebrew's language that the formula uses, so it can't say whether Homebrew's packages fit.
require "digest"
require "fileutils"
require "pathname"

TOP = Pathname(__dir__).parent.parent
FOLDER = TOP/"build/recipes/homebrew"
HEADER = Pathname("/usr/include/stb/stb_image_write.h")

class Pathname
  def install(resource)
    raise "the formula's #{basename} is not that of libstb-dev" if Digest::SHA256.file(HEADER).hexdigest != resource.sha256
    mkpath
    FileUtils.cp(HEADER, self)
  end
end

class Resource
  def initialize(&block) = instance_eval(&block)
  def url(value) = @url = value
  def sha256(value = nil) = value ? @sha256 = value : @sha256
end

class Formula
  class << self
    attr_reader :resources, :tests
    %i[desc url version sha256 license depends_on].each { |name| define_method(name) { |*_| } }
    def resource(name, &block) = (@resources ||= {})[name] = Resource.new(&block)
    def test(&block) = @tests = block
  end
  def buildpath = FOLDER/"work"
  def testpath = FOLDER/"test"
  def prefix = FOLDER/"prefix"
  def bin = prefix/"bin"
  def resource(name) = self.class.resources.fetch(name)
  def std_cmake_args = ["-DCMAKE_INSTALL_PREFIX=#{prefix}", "-DCMAKE_INSTALL_LIBDIR=lib", "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF"]
  def system(*command) = Kernel.system(*command.map(&:to_s)) || raise("failed: #{command.join(" ")}")
  def shell_output(command) = `#{command}`.tap { raise "failed: #{command}" unless $?.success? }
  def assert_match(expected, text) = text.include?(expected) || raise("no #{expected} in #{text}")
  def assert_path_exists(path) = path.exist? || raise("there is no #{path}")
end

load TOP/"tools/install/recipes/homebrew/teracell.rb"
FileUtils.rm_rf(FOLDER)
formula = Teracell.new
[formula.buildpath, formula.testpath].each(&:mkpath)
formula.system("sh", "-c", "git -C #{TOP} archive HEAD | tar -x -C #{formula.buildpath}")
# Elsewhere pkg-config knows no hdf5-serial, so that CMake itself has to find HDF5.
(FOLDER/"pkg-config").write("#!/bin/sh\ncase \"$*\" in *hdf5-serial*) exit 1 ;; esac\nexec /usr/bin/pkg-config \"$@\"\n")
(FOLDER/"pkg-config").chmod(0o755)
ENV["PKG_CONFIG"] = (FOLDER/"pkg-config").to_s
Dir.chdir(formula.buildpath) { formula.install }
Dir.chdir(formula.testpath) { formula.instance_eval(&Teracell.tests) }
puts "homebrew: built and tested"

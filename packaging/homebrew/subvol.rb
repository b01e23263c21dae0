# SPDX-License-Identifier: Apache-2.0
class Subvol < Formula
  desc "Subdivision volumes: refine, splat, export, and compare hexahedral meshes"
  homepage "https://opensubvol.example"
  url "https://opensubvol.example/releases/subvol-0.2.0.tar.xz"
  sha256 "REPLACE_BY_SHA256SUMS"
  license "Apache-2.0"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "eigen" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "pkgconf" => :build
  depends_on "cairo"
  depends_on "ceres-solver"
  depends_on "embree"
  depends_on "glm"
  depends_on "highway"
  depends_on "libepoxy"
  depends_on "libpng"
  depends_on :linux
  depends_on "lz4"
  depends_on "muparser"
  depends_on "openexr"
  depends_on "openimageio"
  depends_on "openvdb"
  depends_on "pugixml"
  depends_on "tbb"
  depends_on "xz"

  def install
    system "cmake", "-G", "Ninja", "-S", ".", "-B", "build", "-DSUBVOL_TESTS=OFF", "-DSUBVOL_WINDOW=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"subvol", "info", "model:ball"
  end
end

// SPDX-License-Identifier: Apache-2.0
// PLY, STL and OFF through OpenMesh's readers, into a PolygonSoup rather than an OpenMesh mesh: so faces arrive
// with the file's own indices, none is refused as non-manifold, and what came is compared with what the file
// claims. The readers see the file through a memory stream of the classic locale.
#include "scene/mesh_formats.hpp"

#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OFFReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/IO/reader/STLReader.hh>
#include <cmath>
#include <istream>
#include <locale>
#include <streambuf>

#include "scene/mesh_quiet.hpp"

namespace clray {

namespace {

namespace om = OpenMesh;
using om::EdgeHandle;
using om::FaceHandle;
using om::HalfedgeHandle;
using om::Vec2f;
using om::Vec3d;
using om::Vec3f;
using om::Vec3uc;
using om::Vec4f;
using om::Vec4uc;
using om::VertexHandle;

/// Reads from memory that it does not own; the readers also seek.
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(const std::string& content) {
    char* begin = const_cast<char*>(content.data());
    setg(begin, begin, begin + content.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg ? 0 : (from == std::ios_base::cur ? gptr() : egptr()) - eback();
    if (base + offset < 0 || base + offset > egptr() - eback()) return pos_type(off_type(-1));
    setg(eback(), eback() + base + offset, egptr());
    return pos_type(base + offset);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(off_type(position), std::ios_base::beg, mode);
  }
};

/// Takes vertices and faces as a reader brings them; everything else a file may hold is left out.
class SoupImporter : public om::IO::BaseImporter {
 public:
  explicit SoupImporter(PolygonSoup& soup) : soup_(soup) {}

  VertexHandle add_vertex(const Vec3f& p) override { return add_vertex(Vec3d(p[0], p[1], p[2])); }
  VertexHandle add_vertex(const Vec3d& p) override {
    soup_.vertices.emplace_back(p[0], p[1], p[2]);
    return VertexHandle(static_cast<int>(soup_.vertices.size() - 1));
  }
  VertexHandle add_vertex() override { return add_vertex(Vec3d(0.0)); }
  void set_point(VertexHandle v, const Vec3f& p) override { soup_.vertices.at(v.idx()) = Vec3(p[0], p[1], p[2]); }
  FaceHandle add_face(const VHandles& corners) override {
    soup_.first.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
    for (const VertexHandle v : corners) soup_.corners.push_back(static_cast<std::uint32_t>(v.idx()));
    return FaceHandle(static_cast<int>(soup_.first.size() - 1));
  }

  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_normal(VertexHandle, const Vec3f&) override {}
  void set_normal(VertexHandle, const Vec3d&) override {}
  void set_color(VertexHandle, const Vec3uc&) override {}
  void set_color(VertexHandle, const Vec4uc&) override {}
  void set_color(VertexHandle, const Vec3f&) override {}
  void set_color(VertexHandle, const Vec4f&) override {}
  void set_texcoord(VertexHandle, const Vec2f&) override {}
  void set_status(VertexHandle, const om::Attributes::StatusInfo&) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
  void set_texcoord(VertexHandle, const Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
  void set_status(HalfedgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_color(EdgeHandle, const Vec3uc&) override {}
  void set_color(EdgeHandle, const Vec4uc&) override {}
  void set_color(EdgeHandle, const Vec3f&) override {}
  void set_color(EdgeHandle, const Vec4f&) override {}
  void set_status(EdgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_normal(FaceHandle, const Vec3f&) override {}
  void set_normal(FaceHandle, const Vec3d&) override {}
  void set_color(FaceHandle, const Vec3uc&) override {}
  void set_color(FaceHandle, const Vec4uc&) override {}
  void set_color(FaceHandle, const Vec3f&) override {}
  void set_color(FaceHandle, const Vec4f&) override {}
  void set_status(FaceHandle, const om::Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}
  size_t n_vertices() const override { return soup_.vertices.size(); }
  size_t n_faces() const override { return soup_.first.size(); }
  size_t n_edges() const override { return 0; }

 private:
  PolygonSoup& soup_;
};

om::IO::BaseReader& reader_of(const std::string& format) {
  if (format == "ply") return om::IO::PLYReader();
  if (format == "stl") return om::IO::STLReader();
  return om::IO::OFFReader();
}

FormatClaim check(const std::string& format, const std::string& content, const std::string& path) {
  if (format == "ply") return check_ply(content, path);
  if (format == "stl") return check_stl(content, path);
  return check_off(content, path);
}

// OpenMesh holds positions of these formats in float; a vertex that is not the file's to float rounding (relative
// 2^-23, or the spacing of subnormals) shows a reader that lost its place.
void take_double_points(PolygonSoup& soup, FormatClaim& claim, const std::string& path) {
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double exact = claim.points[i][k];
      if (!(std::fabs(soup.vertices[i][k] - exact) <= std::fabs(exact) * 0x1p-23 + 0x1p-148)) {
        fail_input(path, 0,
                   "OpenMesh read vertex " + std::to_string(i + 1) +
                       " elsewhere than the file has it; a plainer file was expected");
      }
    }
  }
  soup.vertices = std::move(claim.points);
}

// What arrived is what the file claims, whatever a reader may have passed over.
void check_arrival(PolygonSoup& soup, FormatClaim& claim, bool is_stl, const std::string& path) {
  if (is_stl ? soup.faces() > claim.faces : soup.vertices.size() != claim.vertices || soup.faces() != claim.faces) {
    fail_input(path, 0,
               "OpenMesh read " + std::to_string(soup.vertices.size()) + " vertices and " +
                   std::to_string(soup.faces()) + " faces; " + std::to_string(claim.vertices) + " and " +
                   std::to_string(claim.faces) + " were expected");
  }
  if (!is_stl) take_double_points(soup, claim, path);
  for (std::size_t f = 0; f < soup.faces(); ++f) {
    if (soup.face_end(f) - soup.first[f] < 3)
      fail_input(path, 0, "OpenMesh read a face under three corners; three were expected");
  }
  for (const std::uint32_t corner : soup.corners) {
    if (corner >= soup.vertices.size())
      fail_input(path, 0, "OpenMesh read an index beyond the vertices; one of them was expected");
  }
  soup.collapsed = claim.faces - soup.faces();
  if (soup.faces() == 0) fail_input(path, 0, "no faces with an area; at least one was expected");
}

}  // namespace

PolygonSoup read_with_openmesh(const std::string& path, const std::string& format) {
  const std::string content = read_mesh_file(path);
  FormatClaim claim = check(format, content, path);
  if (claim.faces == 0) fail_input(path, 0, "no faces; at least one was expected");
  if (claim.vertices > kMaxVertices || claim.faces > kMaxVertices) {
    fail_input(path, 0, "more than 2^31 vertices or faces; fewer were expected");
  }
  PolygonSoup soup;
  soup.slots.push_back("");
  {
    const QuietOpenMesh quiet;
    MemoryBuffer buffer(claim.plain.empty() ? content : claim.plain);
    std::istream stream(&buffer);
    stream.imbue(std::locale::classic());
    SoupImporter importer(soup);
    om::IO::Options options;
    if (claim.binary) options += om::IO::Options::Binary;
    bool read = false;
    try {
      read = reader_of(format).read(stream, importer, options);
    } catch (const std::exception& error) {
      fail_input(path, 0, "OpenMesh cannot read this " + format + " file (" + error.what() + ")");
    }
    if (!read) fail_input(path, 0, "OpenMesh cannot read this " + format + " file; a valid one was expected");
  }
  check_arrival(soup, claim, format == "stl", path);
  return soup;
}

}  // namespace clray

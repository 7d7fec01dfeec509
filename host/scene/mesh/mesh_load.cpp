// SPDX-License-Identifier: Apache-2.0
// load_mesh(): picks the reader by extension, scales to metres, triangulates, measures, and counts edges from the
// file's own indices. Every face of the file that has an area stays in the Mesh, in its order.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/mesh/foreign_format.hpp"
#include "scene/mesh/mesh_readers.hpp"
#include "scene/mesh/mesh_soup.hpp"
#include "scene/mesh/mesh_triangulate.hpp"
#include "shared/portable.h"
#include "text/input_file.hpp"
#include "text/text.hpp"

namespace clray {

namespace {

// Areas and the tracer's fp32 boxes would overflow beyond it.
constexpr double kMaxCoordinate_m = 1.0e15;

void scale_to_metres(std::vector<Vec3>& vertices, double unit, const std::string& path) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    Vec3& v = vertices[i];
    v *= unit;
    if (!(std::fabs(v.x) <= kMaxCoordinate_m && std::fabs(v.y) <= kMaxCoordinate_m &&
          std::fabs(v.z) <= kMaxCoordinate_m)) {
      fail_input(
          path, 0,
          "vertex " + std::to_string(i + 1) + " lies beyond 1e15 m; a body in metres was expected (see --length-unit)");
    }
  }
}

void triangulate_faces(const PolygonSoup& soup, Mesh& mesh, const std::string& path) {
  const std::size_t count = soup.corners.size() - 2 * soup.faces();
  mesh.triangles.reserve(count);
  mesh.triangle_slot.reserve(count);
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> local;
  std::uint64_t crossing = 0, first_crossing = 0;
  for (std::size_t f = 0; f < soup.faces(); ++f) {
    const std::uint32_t* corner = soup.corners.data() + soup.first[f];
    const std::size_t n = soup.face_end(f) - soup.first[f];
    local.clear();
    if (n == 3) {
      local.push_back({0, 1, 2});
    } else {
      points.clear();
      for (std::size_t i = 0; i < n; ++i) points.push_back(mesh.vertices[corner[i]]);
      try {
        if (triangulate(points, local) == Triangulation::crossing && crossing++ == 0) first_crossing = f + 1;
      } catch (const Error& error) {
        throw Error(error.code(), "face " + std::to_string(f + 1) + ": " + error.message(), path);
      }
    }
    const std::uint32_t slot = soup.face_slot.empty() ? 0 : soup.face_slot[f];
    for (const auto& t : local) {
      mesh.triangles.push_back({corner[t[0]], corner[t[1]], corner[t[2]]});
      mesh.triangle_slot.push_back(slot);
    }
  }
  if (crossing > 0) {
    mesh.warnings.push_back(path + ": " +
                            text::counted(crossing, "polygon crosses itself or has no plane",
                                          "polygons cross themselves or have no plane") +
                            " (first: face " + std::to_string(first_crossing) +
                            "); a fan from the first corner is taken");
  }
}

// Edges by their smaller vertex, each as one number: larger vertex, direction. Few edges share a vertex, so that only
// short runs are sorted.
void count_edges(const PolygonSoup& soup, std::size_t vertices, MeshReport& report) {
  static_assert(kMaxVertices <= std::size_t{1} << 31);
  const auto each_edge = [&](const auto& take) {
    for (std::size_t f = 0; f < soup.faces(); ++f) {
      const std::size_t end = soup.face_end(f);
      for (std::size_t i = soup.first[f]; i < end; ++i) {
        const std::uint32_t a = soup.corners[i], b = soup.corners[i + 1 < end ? i + 1 : soup.first[f]];
        if (a != b) take(std::min(a, b), std::max(a, b) << 1 | (a < b ? 0u : 1u));
      }
    }
  };
  std::vector<std::size_t> ends(vertices + 1, 0);  // first of the vertex before, while edges are put in
  each_edge([&](std::uint32_t smaller, std::uint32_t) { ++ends[smaller + 1]; });
  for (std::size_t v = 1; v <= vertices; ++v) ends[v] += ends[v - 1];
  std::vector<std::uint32_t> edges(ends[vertices]);
  each_edge([&](std::uint32_t smaller, std::uint32_t edge) { edges[ends[smaller]++] = edge; });
  for (std::size_t v = 0, begin = 0; v < vertices; begin = ends[v++]) {
    const auto first = edges.begin() + static_cast<std::ptrdiff_t>(begin);
    std::sort(first, edges.begin() + static_cast<std::ptrdiff_t>(ends[v]));
    for (std::size_t i = begin, end; i < ends[v]; i = end) {
      for (end = i + 1; end < ends[v] && edges[end] >> 1 == edges[i] >> 1; ++end) continue;
      const std::size_t faces = end - i;
      if (faces == 1) ++report.boundary_edges;
      if (faces > 2 || (faces == 2 && edges[i] == edges[i + 1])) ++report.non_manifold_edges;
    }
  }
}

PolygonSoup read_soup(const std::string& path) {
  const std::string extension = extension_of(path);
  const auto reader = extension == ".obj"   ? read_obj
                      : extension == ".ply" ? read_ply
                      : extension == ".stl" ? read_stl
                      : extension == ".off" ? read_off
                                            : nullptr;
  if (reader == nullptr) {
    const std::string foreign = foreign_format(path);
    fail_input(path, 0,
               (foreign.empty() ? "the extension '" + extension + "' is no mesh format" : foreign) +
                   "; .obj, .ply, .stl or .off was expected");
  }
  const std::string content = text::read_input_file(path);
  if (content.empty()) fail_input(path, 1, "the file is empty; a mesh was expected");
  PolygonSoup soup = reader(path, content);
  soup.short_faces.warn(path, "a face with fewer than three corners is left out", soup.warnings);
  if (soup.faces() + soup.collapsed == 0) fail_input(path, 0, "no faces; at least one of three corners was expected");
  return soup;
}

// Twice the area of a triangle, and whether rounding of its corners alone could make it: the height over the longest
// edge is at most four units in the last place of the coordinates. Corners that lie on one line in decimal need not do
// so after rounding to double.
double twice_area(const Vec3& a, const Vec3& b, const Vec3& c, bool& degenerate) {
  const vec3 u = v3(b.x - a.x, b.y - a.y, b.z - a.z), v = v3(c.x - a.x, c.y - a.y, c.z - a.z);
  const double twice = v3_length(v3_cross(u, v));
  double largest = 0.0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::fabs(a[k]), std::fabs(b[k]), std::fabs(c[k])});
  const double longest = std::max({v3_length(u), v3_length(v), v3_length(v3_sub(u, v))});
  degenerate = twice <= 4.0 * 0x1p-52 * largest * longest;
  return twice;
}

void measure(Mesh& mesh) {
  double sum = 0.0, lost = 0.0;  // compensated (Neumaier 1974): ten million terms keep all digits
  for (const auto& t : mesh.triangles) {
    bool degenerate = false;
    const double area = 0.5 * twice_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], degenerate);
    mesh.report.degenerate += degenerate;
    const double total = sum + area;
    lost += sum >= area ? (sum - total) + area : (area - total) + sum;
    sum = total;
  }
  mesh.report.area_m2 = sum + lost;
  mesh.report.triangles = mesh.triangles.size();
}

/// Polygons in metres as a mesh: triangles, edges and areas counted.
std::shared_ptr<const Mesh> mesh_of(PolygonSoup soup, double length_unit_m, const std::string& path) {
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices = std::move(soup.vertices);
  mesh->material_slots = std::move(soup.slots);
  mesh->file_materials = std::move(soup.file_materials);
  mesh->warnings = std::move(soup.warnings);
  scale_to_metres(mesh->vertices, length_unit_m, path);
  mesh->report.faces = soup.faces() + soup.collapsed;
  count_edges(soup, mesh->vertices.size(), mesh->report);
  triangulate_faces(soup, *mesh, path);
  mesh->report.degenerate = soup.collapsed;
  measure(*mesh);
  if (!(mesh->report.area_m2 > 0.0)) fail_input(path, 0, "all faces are without area; a surface was expected");
  return mesh;
}

}  // namespace

std::shared_ptr<const Mesh> make_mesh(std::vector<Vec3> vertices,
                                      const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::string place = "mesh in memory";
  if (triangles.empty()) fail_input(place, 0, "no faces; at least one of three corners was expected");
  if (vertices.size() > kMaxVertices) fail_input(place, 0, "more than 2^31 vertices; fewer were expected");
  PolygonSoup soup;
  soup.slots = {""};
  soup.corners.reserve(3 * triangles.size());
  for (const auto& triangle : triangles) {
    const std::size_t start = soup.corners.size();
    for (const std::uint32_t vertex : triangle) {
      if (vertex >= vertices.size())
        fail_input(place, 0, fmt::format("a triangle has vertex {}; there are {}", vertex, vertices.size()));
      soup.corners.push_back(vertex);
    }
    soup.end_face(start, place, 0);
  }
  soup.vertices = std::move(vertices);
  return mesh_of(std::move(soup), 1.0, place);
}

std::shared_ptr<const Mesh> load_mesh(const std::string& path, double length_unit_m) {
  if (!(length_unit_m > 0.0 && std::isfinite(length_unit_m))) {
    fail_input(path, 0,
               "a length unit of " + std::to_string(length_unit_m) + " m; a finite number above 0 was expected");
  }
  return mesh_of(read_soup(path), length_unit_m, path);
}

}  // namespace clray

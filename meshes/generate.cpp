// SPDX-License-Identifier: Apache-2.0
// Writes the three bodies of the paper (hexagonal prism, cylinder, box-wing satellite) as OBJ and MTL files into
// the folder given. Body frame, metres; a station at +z sees each from the side. Dimensions: README.md. Only
// + - * / and sqrt are used, so the files have the same bytes on every machine.
// Source of the shapes and of rho, d, n: Wilkman, Ray-tracer for modeling interactions of light with space objects.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

struct Point {
  double x, y, z;
};

struct Face {
  std::string material;  // written where it changes
  std::vector<int> corners;
};

struct Body {
  std::string name, title, library;
  std::vector<Point> points;
  std::vector<Face> faces;
};

/// A material whose mean Kd + Ks is rho and whose Kd / (Kd + Ks) is d.
std::string material(const std::string& name, const char* kd, const char* ks, int n) {
  const auto grey = [](const char* value) { return std::string(value) + " " + value + " " + value; };
  return "newmtl " + name + "\nKd " + grey(kd) + "\nKs " + grey(ks) + "\nNs " + std::to_string(n) + "\nillum 2\n";
}

/// A prism about y from polygon corners in the plane of z and x (counter-clockwise seen from +y).
Body prism(const std::vector<std::array<double, 2>>& ring_zx, double height, const std::string& material_name) {
  Body body;
  const int n = static_cast<int>(ring_zx.size());
  for (const double y : {-height / 2, height / 2}) {
    for (const auto& c : ring_zx) body.points.push_back({c[1], y, c[0]});
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    body.faces.push_back({material_name, {i, j, n + j, n + i}});
  }
  Face bottom{material_name, {}}, top{material_name, {}};
  for (int i = 0; i < n; ++i) {
    bottom.corners.push_back(n - 1 - i);
    top.corners.push_back(n + i);
  }
  body.faces.push_back(bottom);
  body.faces.push_back(top);
  return body;
}

/// 2^k directions of the unit circle, the first at angle 0, by repeated bisection of the quarter turns.
std::vector<std::array<double, 2>> circle(int count) {
  std::vector<std::array<double, 2>> directions = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  while (static_cast<int>(directions.size()) < count) {
    std::vector<std::array<double, 2>> finer;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const auto& a = directions[i];
      const auto& b = directions[(i + 1) % directions.size()];
      const double x = a[0] + b[0], y = a[1] + b[1], length = std::sqrt(x * x + y * y);
      finer.push_back(a);
      finer.push_back({x / length, y / length});
    }
    directions = finer;
  }
  return directions;
}

Body hexprism() {
  const double h = std::sqrt(3.0) / 2;
  Body body = prism({{h, -0.5}, {h, 0.5}, {0, 1}, {-h, 0.5}, {-h, -0.5}, {0, -1}}, 1.0, "hull");
  body.name = "hexprism";
  body.title = "hexagonal prism, 1 m tall along y, 2 m across its corners, one facet facing +z";
  body.library = material("hull", "0.4", "0.1", 50);
  return body;
}

Body cylinder() {
  constexpr int kFacets = 256;
  const auto directions = circle(2 * kFacets);
  std::vector<std::array<double, 2>> ring;
  for (int i = 0; i < kFacets; ++i) ring.push_back(directions[2 * i + 1]);
  Body body = prism(ring, 3.0, "hull");
  body.name = "cylinder";
  body.title = "cylinder of 256 facets, 3 m tall along y, radius 1 m to its corners, one facet facing +z";
  body.library = material("hull", "0.4", "0.1", 50);
  return body;
}

Body box_wing() {
  Body body;
  body.name = "box_wing";
  body.title = "box-wing satellite: a box of 2 m and two wings of 3 m by 1.2 m on a line 30 degrees from x toward z";
  body.library = material("box", "0.1", "0.4", 50) + "\n" + material("wing", "0.1", "0.4", 50);
  for (int i = 0; i < 8; ++i) body.points.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  const std::vector<std::vector<int>> sides = {{4, 5, 7, 6}, {1, 0, 2, 3}, {5, 1, 3, 7},
                                               {0, 4, 6, 2}, {6, 7, 3, 2}, {0, 1, 5, 4}};
  for (const auto& side : sides) body.faces.push_back({"box", side});
  const double cosine = std::sqrt(3.0) / 2, sine = 0.5;
  constexpr double kInner = 2.4, kOuter = 5.4, kHalfWidth = 0.6;
  for (const double sign : {1.0, -1.0}) {
    const int first = static_cast<int>(body.points.size());
    const double low = sign > 0 ? kInner : -kOuter, high = sign > 0 ? kOuter : -kInner;
    body.points.push_back({low * cosine, -kHalfWidth, low * sine});
    body.points.push_back({high * cosine, -kHalfWidth, high * sine});
    body.points.push_back({high * cosine, kHalfWidth, high * sine});
    body.points.push_back({low * cosine, kHalfWidth, low * sine});
    body.faces.push_back({"wing", {first, first + 1, first + 2, first + 3}});
  }
  return body;
}

bool write_text(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return false;
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && written;
}

bool write_body(const Body& body, const std::string& folder) {
  const std::string header =
      "# SPDX-License-Identifier: Apache-2.0\n# " + body.title + "; written by meshes/generate.cpp\n";
  std::string text = header + "mtllib " + body.name + ".mtl\no " + body.name + "\n";
  char line[128];
  for (const Point& p : body.points) {
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", p.x, p.y, p.z);
    text += line;
  }
  std::string current;
  for (const Face& face : body.faces) {
    if (face.material != current) text += "usemtl " + (current = face.material) + "\n";
    text += "f";
    for (const int corner : face.corners) text += " " + std::to_string(corner + 1);
    text += "\n";
  }
  return write_text(folder + "/" + body.name + ".obj", text) &&
         write_text(folder + "/" + body.name + ".mtl", header + body.library);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: generate FOLDER\n");
    return 2;
  }
  for (const Body& body : {hexprism(), cylinder(), box_wing()}) {
    if (!write_body(body, argv[1])) {
      std::fprintf(stderr, "%s/%s: cannot be written\n", argv[1], body.name.c_str());
      return 5;
    }
  }
  return 0;
}

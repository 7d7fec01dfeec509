// SPDX-License-Identifier: Apache-2.0
// Which faces of a beam may be seen in a rectangle across it: those that meet it, and that no face hides which covers
// it all (Warnock 1969). Planes are linear, so the corners of the rectangle decide.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "exact/beam_faces.hpp"

namespace clray {

struct Rectangle {
  double x0, x1, y0, y1;

  std::array<Rectangle, 4> quarters() const;
  double area() const { return (x1 - x0) * (y1 - y0); }
};

class SeenFaces {
 public:
  explicit SeenFaces(const BeamFaces& beam);

  /// Appends to *kept those among `faces` that may be seen in a rectangle.
  void keep(const Rectangle& r, const std::vector<std::uint32_t>& faces, std::vector<std::uint32_t>* kept) const;
  /// Whether a face covers a rectangle.
  bool covers(std::uint32_t face, const Rectangle& r) const { return place(face, r) == covering; }

 private:
  enum Place { outside, meeting, covering };
  /// A face's edges and depth as a rectangle asks for them.
  struct Edges {
    std::array<double, 3> dx, dy, tiny;  // direction, and what rounding may add to a side
    double depth_error;
  };

  Place place(std::uint32_t face, const Rectangle& r) const;
  double depth_at(std::uint32_t face, double x, double y) const;
  double least_depth(std::uint32_t face, const Rectangle& r) const;
  double greatest_depth(std::uint32_t face, const Rectangle& r) const;
  bool hidden(std::uint32_t face, std::uint32_t cover, const Rectangle& r) const;

  const BeamFaces& beam_;
  std::vector<Edges> edges_;
};

}  // namespace clray

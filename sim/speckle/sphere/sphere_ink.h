// The ink of a sphere on the lines of its picture. Internal to the renderer.
#pragma once

#include <array>
#include <vector>

#include "sim/speckle/sphere/sphere.h"
#include "sim/speckle/sphere/sphere_view.h"

namespace impactdic::sim::speckle {

// One line stands for a stretch of rows `step` high, in whose middle it lies.
struct InkedLine {
  double y = 0, step = 0;  // px
  int row = 0;             // of cells, that it belongs to
  SphereLine cut;
  std::vector<Span> ink;    // of caps; overlapping, in no order
  std::vector<Span> drawn;  // of strips; each counts 1 / kFinerLines
};
inline constexpr int kFinerLines = 8;

// Joins what overlaps; ascending.
void join(std::vector<Span>& spans);

// The width that the first line of a shape must have, so that the sum over all lines is the shape's
// area. The shape's width starts as the root of the distance from its end; the plain sum errs by
// step^1.5 there, and by the generalised Euler-Maclaurin formula (Navot 1961) with Hurwitz' zeta
// function the error is known. `square`: the squared widths of the first three lines, which of an
// ellipse are a polynomial of the second degree; `y`: where they lie; `step`: of the first line.
double first_width(const std::array<double, 3>& square, const std::array<double, 3>& y,
                   double step);

class SphereInk {
 public:
  SphereInk(const SphereView& view, const SpeckleSphere& sphere);
  // Cuts the sphere and its ink by the lines, whose y and step are given, ascending.
  void draw(std::vector<InkedLine>& lines) const;

 private:
  struct HalfSpace {
    Eigen::Vector3d w;
    double b;
  };
  struct Cap {
    HalfSpace inside;
    Span rows;
  };

  void cut(InkedLine& line) const;
  void draw_cap(const Cap& cap, std::vector<InkedLine>& lines, std::vector<Stretches>& seen) const;
  void draw_strips(InkedLine& line) const;

  const SphereView& view_;
  std::vector<Cap> caps_;
  std::vector<std::array<HalfSpace, 4>> strips_;
};

}  // namespace impactdic::sim::speckle

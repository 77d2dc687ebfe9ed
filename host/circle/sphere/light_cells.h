// The samples of a sphere in cells, and how a light that is fitted to them changes. Internal to
// host/circle/sphere.
#pragma once

#include <Eigen/Dense>
#include <cstring>
#include <vector>

#include "host/circle/rim/rim_levels.h"
#include "host/circle/sphere/sphere_light.h"

namespace impactdic::circle {

// Two circles of samples a cell.
inline constexpr int kRingsOfCell = 2;

bool is_finite(const SphereLight& light);

class LightCells {
 public:
  // `with_brightness`: how bright each cell is, is asked for. The samples must outlive this.
  LightCells(const SphereSamples& samples, double ground, bool with_brightness);
  bool has_enough() const;

 protected:
  using Terms = Eigen::Matrix<double, kLightTerms, 1>;
  using Matrix = Eigen::Matrix<double, kLightTerms, kLightTerms>;
  // A part of a sector between two circles.
  struct Cell {
    std::size_t begin, end;  // directions
    int ring;                // first of kRingsOfCell
    double x, y, z;
    double bright;  // that one sample in twenty exceeds
    double mean;    // of all samples
  };
  // Normal equations of a step: row by row, of which those columns count that are no less.
  struct Normal {
    static constexpr int kFours = (kLightTerms + 3) / 4;
    FourPlaces rows[kLightTerms][kFours] = {};
    Terms b = Terms::Zero();
    double& diagonal(int m) { return reinterpret_cast<double*>(rows[m])[m]; }
    void add(const Terms& slope, double weight, double off) {
      FourPlaces u[kFours] = {};
      std::memcpy(u, slope.data(), kLightTerms * sizeof(double));
      for (int i = 0; i < kLightTerms; ++i) {
        const double by = weight * slope[i];
        for (int k = i / 4; k < kFours; ++k) rows[i][k] += by * u[k];
      }
      b += weight * off * slope;
    }
    Terms solution() const {
      Matrix a;
      for (int i = 0; i < kLightTerms; ++i) {
        for (int m = i; m < kLightTerms; ++m) a(m, i) = a(i, m) = rows[i][m / 4][m % 4];
      }
      return Eigen::LDLT<Matrix>(a).solve(b);
    }
  };

  // How the level changes with the terms.
  static Terms slope_of(const SphereLight& light, double x, double y, double z);
  double brightest(const SphereLight& light) const;
  // No shading of a kind unless it shows: `share` of the usual weights.
  void hold(const SphereLight& light, double share, Normal& normal) const;
  static SphereLight stepped(const SphereLight& light, Terms step);
  // So many times as bright.
  static SphereLight times(const SphereLight& light, double by, double shown);

  const SphereSamples& samples_;
  const double ground_;
  std::vector<Cell> cells_;
};

}  // namespace impactdic::circle

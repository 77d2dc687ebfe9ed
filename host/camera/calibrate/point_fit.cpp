#include "host/camera/calibrate/point_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/camera/calibrate/find_target.h"
#include "host/camera/calibrate/markers.h"

namespace impactdic::camera {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// Shift (2), blur, radius of a dot; black, its slopes, what white is more, its slopes.
constexpr int kUnknowns = 10, kShaped = 4;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;

constexpr double kLeastBand_px = 8, kBand = 0.25;  // about an edge: in px, in pitches
constexpr double kLeastBlur_px = 0.15, kStartBlur_px = 0.7;
constexpr int kMostFitSteps = 40, kPixelsEach = 4;
constexpr double kStill_px = 1e-5, kWorstSd_px = 0.3, kLeastContrast = 3;

// The distance to an edge, px, and its slope along the picture's axes.
struct Edge {
  double distance = 0;
  Vector2d normal{0, 0};
};

struct Pixel {
  Vector2d off{0, 0};  // from the point
  double level = 0;
  std::array<Edge, 2> edges;        // of a corner: the two lines; of a dot: its outline
  std::array<double, 2> margins{};  // from these lines to the marker, px
  double by_radius = 0;             // of a dot's distance, px/m
};

// How much of a spot is white (of a dot: ink), and its slopes.
struct Share {
  double value = 0;
  Vector2d by_place{0, 0};
  double by_blur = 0, by_distance = 0;

  Share& operator+=(const Share& other) {
    value += other.value, by_place += other.by_place;
    by_blur += other.by_blur, by_distance += other.by_distance;
    return *this;
  }
};

// One side of a blurred edge.
Share side(double distance, const Vector2d& normal, double blur) {
  constexpr double kFar = 6;
  const double z = distance / blur;
  if (std::abs(z) > kFar) return {z > 0 ? 1.0 : 0.0, {0, 0}, 0, 0};
  const double density = std::exp(-z * z / 2) / std::sqrt(2 * kPi) / blur;
  return {std::erfc(-z / std::sqrt(2.0)) / 2, density * normal, -density * z, density};
}

Share both(const Share& a, const Share& b) {
  return {a.value * b.value, a.value * b.by_place + b.value * a.by_place,
          a.value * b.by_blur + b.value * a.by_blur, 0};
}

Share less(const Share& a, double share, const Share& b) {
  return {a.value - share * b.value, a.by_place - share * b.by_place, a.by_blur - share * b.by_blur,
          0};
}

// The quadrants of a corner that are white, less the markers that stand in them.
Share corner_share(const Pixel& pixel, const Vector2d& place, double blur, double white_sign,
                   bool marked) {
  Share white;
  for (const double s : {1.0, -1.0}) {
    const std::array<double, 2> signs = {s, white_sign * s};
    std::array<Share, 2> sides, marker;
    for (std::size_t k = 0; k < 2; ++k) {
      const Edge& edge = pixel.edges[k];
      const Vector2d normal = signs[k] * edge.normal;
      const double distance = signs[k] * edge.distance + normal.dot(place);
      sides[k] = side(distance, normal, blur);
      if (marked) marker[k] = side(distance - pixel.margins[k], normal, blur);
    }
    white += both(sides[0], sides[1]);
    if (marked) white = less(white, 1, both(marker[0], marker[1]));
  }
  return white;
}

class Patch {
 public:
  Patch(const Image<float>& picture, const BoardSight& sight, const PointPattern& pattern,
        std::size_t point, const Vector2d& board_m)
      : pattern_(pattern), white_sign_(pattern.white_sign(point)) {
    expected_ = sight.to_picture(board_m);
    if (!expected_.allFinite()) return;
    Vector2d low = expected_, high = expected_;
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const Vector2d at = sight.to_picture(board_m + pattern.pitch_m() * Vector2d(x, y));
        low = low.cwiseMin(at), high = high.cwiseMax(at);
      }
    }
    if (!low.allFinite() || !high.allFinite()) return;
    const int right = std::min(picture.width() - 1, static_cast<int>(std::ceil(high.x())));
    const int below = std::min(picture.height() - 1, static_cast<int>(std::ceil(high.y())));
    for (int y = std::max(0, static_cast<int>(low.y())); y <= below; ++y) {
      for (int x = std::max(0, static_cast<int>(low.x())); x <= right; ++x) {
        Matrix2d slope;
        const Vector2d from = sight.to_board({x, y}, &slope) - board_m;
        if (!(from.cwiseAbs().maxCoeff() < pattern.pitch_m() / 2)) continue;
        Pixel pixel;
        pixel.off = Vector2d(x, y) - expected_;
        pixel.level = picture(x, y);
        const bool counts =
            pattern.dot() ? set_outline(from, slope, pixel) : set_lines(from, slope, pixel);
        if (counts) pixels_.push_back(pixel);
      }
    }
    reach_ = std::max(1.0, (high - low).maxCoeff() / 2);
  }

  std::size_t pixels() const { return pixels_.size(); }
  const Vector2d& expected() const { return expected_; }

  // Sum of squared residuals; adds the normal equations.
  double chi_square(const Unknowns& at, Square* normal, Unknowns* side) const {
    double sum = 0;
    if (normal != nullptr) normal->setZero(), side->setZero();
    for (const Pixel& pixel : pixels_) {
      const Share share = mean(pixel, at);
      const double x = pixel.off.x() / reach_, y = pixel.off.y() / reach_;
      const double white = at[7] + at[8] * x + at[9] * y;
      const double off = pixel.level - (at[4] + at[5] * x + at[6] * y) - white * share.value;
      sum += off * off;
      if (normal == nullptr) continue;
      Unknowns row;
      row << -white * share.by_place, white * share.by_blur,
          white * share.by_distance * pixel.by_radius, 1, x, y, share.value, share.value * x,
          share.value * y;
      normal->selfadjointView<Eigen::Lower>().rankUpdate(row);
      *side += off * row;
    }
    if (normal != nullptr) *normal = normal->selfadjointView<Eigen::Lower>();
    return sum;
  }

 private:
  // `from` the point, on the target. False: the pixel takes no part.
  bool set_lines(const Vector2d& from, const Matrix2d& slope, Pixel& pixel) const {
    double band = 0;
    for (int k = 0; k < 2; ++k) {
      const auto n = static_cast<std::size_t>(k);
      const double unit = slope.row(k).norm();  // m/px across this edge
      pixel.edges[n] = {from[k] / unit, slope.row(k).transpose() / unit};
      pixel.margins[n] = pattern_.margin_m() / unit;
      band = std::max({band, kLeastBand_px, kBand * pattern_.pitch_m() / unit});
    }
    const double nearest = from.cwiseAbs().minCoeff();
    const bool in_white = from.x() * from.y() * white_sign_ > 0;
    const bool beyond =
        pattern_.marked() && in_white && nearest > pattern_.margin_m() + pattern_.known_border_m();
    const bool near =
        std::min(std::abs(pixel.edges[0].distance), std::abs(pixel.edges[1].distance)) < band;
    return near && !beyond;
  }

  bool set_outline(const Vector2d& from, const Matrix2d& slope, Pixel& pixel) const {
    const double radius = from.norm();
    if (!(radius < pattern_.pitch_m() / 2) || radius == 0) return false;
    const Vector2d outwards = slope.transpose() * from / radius;
    const double unit = outwards.norm();
    pixel.edges[0] = {(pattern_.dot_radius_m() - radius) / unit, -outwards / unit};
    pixel.by_radius = 1 / unit;
    const double band = std::max(kLeastBand_px, kBand * pattern_.pitch_m() / unit);
    return std::abs(pixel.edges[0].distance) < band;
  }

  // Over the pixel.
  Share mean(const Pixel& pixel, const Unknowns& at) const {
    static const double kGauss = 0.5 / std::sqrt(3.0);
    Share sum;
    for (const double x : {-kGauss, kGauss}) {
      for (const double y : {-kGauss, kGauss}) {
        const Vector2d place = Vector2d(x, y) - at.head<2>();
        if (pattern_.dot()) {
          const Edge& edge = pixel.edges[0];
          const double distance = edge.distance + edge.normal.dot(place) + pixel.by_radius * at[3];
          sum += side(distance, edge.normal, at[2]);
        } else {
          sum += corner_share(pixel, place, at[2], white_sign_, pattern_.marked());
        }
      }
    }
    return {sum.value / kPixelsEach, sum.by_place / kPixelsEach, sum.by_blur / kPixelsEach,
            sum.by_distance / kPixelsEach};
  }

  const PointPattern& pattern_;
  double white_sign_, reach_ = 1;
  Vector2d expected_;
  std::vector<Pixel> pixels_;
};

// The step of damped least squares; `held`: a dot's radius where there is no dot.
Unknowns step_of(Square normal, const Unknowns& side, double damping, bool held) {
  if (held) normal(3, 3) = 1;
  normal.diagonal() *= 1 + damping;
  const Unknowns scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Square unit = scale.asDiagonal() * normal * scale.asDiagonal();
  return scale.cwiseProduct(unit.ldlt().solve(scale.cwiseProduct(side)));
}

// Grey levels that fit best with the shape as it is.
void set_levels(const Patch& patch, Unknowns& at) {
  constexpr int kLevels = kUnknowns - kShaped;
  Square normal;
  Unknowns side;
  at.tail<kLevels>().setZero();
  patch.chi_square(at, &normal, &side);
  const Eigen::Matrix<double, kLevels, kLevels> levels =
      normal.bottomRightCorner<kLevels, kLevels>();
  at.tail<kLevels>() = levels.ldlt().solve(side.tail<kLevels>());
}

struct Settled {
  Unknowns at;
  Square normal;
  double chi_square = 0;
  bool still = false;
};

Settled settled(const Patch& patch, const Vector2d& shift, bool dot) {
  Settled found;
  found.at.setZero();
  found.at.head<2>() = shift;
  found.at[2] = kStartBlur_px;
  set_levels(patch, found.at);
  Unknowns side;
  found.chi_square = patch.chi_square(found.at, &found.normal, &side);
  double damping = 1e-3;
  for (int step = 0; step < kMostFitSteps && damping < 1e8; ++step) {
    const Unknowns change = step_of(found.normal, side, damping, !dot);
    Unknowns next = found.at + change;
    next[2] = std::max(next[2], kLeastBlur_px);
    const double chi = patch.chi_square(next, nullptr, nullptr);
    if (!(chi <= found.chi_square)) {
      damping *= 10;
      continue;
    }
    found.at = next;
    found.chi_square = patch.chi_square(next, &found.normal, &side);
    damping = std::max(damping * 0.1, 1e-12);
    found.still = change.head<2>().norm() < kStill_px;
    if (found.still) break;
  }
  return found;
}

}  // namespace

PointPattern::PointPattern(const CalibrateRequest& request)
    : dot_(request.target == CalibrationTarget::kDots),
      columns_(dot_ ? request.columns : request.columns - 1),
      pitch_m_(request.pitch_mm * 1e-3) {
  if (dot_) dot_radius_m_ = dot_diameter_mm(request) * 0.5e-3;
  if (request.target == CalibrationTarget::kCharuco) marker_share_ = camera::marker_share(request);
}

double PointPattern::known_border_m() const {
  constexpr double kMostCells = 9;  // along a side of the finest markers, with the border
  return marker_share_ * pitch_m_ / kMostCells / 2;
}

double PointPattern::white_sign(std::size_t point) const {
  const std::size_t columns = static_cast<std::size_t>(columns_);
  return (point % columns + point / columns) % 2 == 0 ? -1 : 1;
}

std::optional<FittedPoint> fit_point(const Image<float>& picture, const BoardSight& sight,
                                     const PointPattern& pattern, const Sighting& seen,
                                     const Vector2d& board_m) {
  const Patch patch(picture, sight, pattern, seen.point, board_m);
  constexpr std::size_t kFewestPixels = 4 * kUnknowns;
  if (patch.pixels() < kFewestPixels) return {};
  const Vector2d start = seen.at_px - patch.expected();
  const Settled found = settled(patch, start, pattern.dot());
  const double freedom = static_cast<double>(patch.pixels()) - kUnknowns + (pattern.dot() ? 0 : 1);
  const double variance = found.chi_square / freedom;
  if (!found.still || !(std::abs(found.at[7]) > kLeastContrast * std::sqrt(variance))) return {};
  Square normal = found.normal;
  if (!pattern.dot()) normal(3, 3) = 1;
  const Square inverse = normal.ldlt().solve(Square::Identity());
  const Matrix2d covariance = variance * inverse.topLeftCorner<2, 2>();
  if (!(covariance.trace() > 0) || !(covariance.trace() < 2 * kWorstSd_px * kWorstSd_px)) return {};
  return FittedPoint{patch.expected() + found.at.head<2>(),
                     (covariance + covariance.transpose()) / 2, found.at[2]};
}

}  // namespace impactdic::camera

#include "host/run/metres/lens/lens_check.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "host/base/statistics.h"
#include "host/clip/track_row.h"
#include "host/run/metres/lens/flight_rows.h"

namespace impactdic::run {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kFewestFrames = 8;  // of a flight
constexpr double kChance = 5;             // deviations beyond which a bend is one
constexpr double kOutlier = 4;
// Bends that pass for none: below these nothing that is stated is moved by more than registration
// itself leaves.
constexpr double kLeastCorner = 1e-3, kLeastShare = 5e-4, kLeastStep_px = 2e-3;
// Deviations that are stated hold the noise alone.
constexpr double kLeastCentreSd_px = 0.003, kLeastStepSd_px = 0.0005;
constexpr double kSteady = 2;  // scatter over what is stated, of a path that is one flight
// Lenses that film a ball's flight bend by less; what bends more is the path.
constexpr double kMostCorner = 0.3;
constexpr double kFallTolerance = 0.2;
// What a radius may be off by otherwise, as its texture turns; and deviations that are chance then.
constexpr double kOutlineBias_px = 0.02, kOutlineChance = 4;
constexpr double kSmallLens = 0.05;  // what a lens that is taken for a small one is off by, of it
constexpr double kNearest_widths =
    3;                         // from where balls are filmed, in widths of the picture there
constexpr int kPerFlight = 6;  // place, speed and acceleration, along x and y

// What a lens of corner share 1 does to a place, and to a small step there.
struct Bending {
  Vector2d middle;
  double half;  // of the picture's diagonal
  Vector2d place(const Vector2d& at) const {
    const Vector2d off = at - middle;
    return off * off.squaredNorm() / (half * half);
  }
  Vector2d step(const Vector2d& at, const Vector2d& by) const {
    const Vector2d off = at - middle;
    return (by * off.squaredNorm() + 2 * off * off.dot(by)) / (half * half);
  }
};

// Two for each row that was measured: of the centre and, in its place where there are motions, of
// them. Over a ball's extent a lens enlarges circles and motions differently, so that they do not
// share a speed. They are made anew whenever they are asked for: a clip may be long.
class Equations {
 public:
  Equations(const TrackRows& rows, const std::vector<FlightRows>& flights, bool motions,
            const Bending& bending)
      : rows_(rows), flights_(flights), motions_(motions), bending_(bending) {
    for (const FlightRows& flight : flights) paths_.push_back(path_of(flight));
  }

  Eigen::Index unknowns() const {
    return static_cast<Eigen::Index>(kPerFlight * flights_.size() + 1);
  }

  // use(slope, value), both over the deviation, in order.
  template <typename Use>
  void each(const Use& use) const {
    for (std::size_t f = 0; f < flights_.size(); ++f) {
      for (std::size_t i = flights_[f].first; i <= flights_[f].last; ++i) {
        const TrackRow row = rows_[i];
        if (!counts(row)) continue;
        const Eigen::Vector3d powers = powers_at(flights_[f], i);
        const Seen seen = seen_in(row);
        const Vector2d bend = bend_of(row, paths_[f].transpose() * powers);
        for (int axis = 0; axis < 2; ++axis) {
          Eigen::VectorXd slope = Eigen::VectorXd::Zero(unknowns());
          const auto at = static_cast<Eigen::Index>(kPerFlight * f);
          slope.segment<3>(at + 3 * axis) = powers;
          slope[unknowns() - 1] = bend[axis];
          slope /= seen.sd[axis];
          use(slope, seen.value[axis] / seen.sd[axis]);
        }
      }
    }
  }

 private:
  using Path = Eigen::Matrix<double, 3, 2>;  // place, speed and acceleration, along x and y

  struct Seen {
    Vector2d value, sd;
  };

  bool counts(const TrackRow& row) const { return row.circle_ok && (!motions_ || row.motion_ok); }

  Seen seen_in(const TrackRow& row) const {
    const RimCentre rim = rim_centre(row);
    if (motions_) {
      return {{row.dx_px, row.dy_px},
              Vector2d(row.dx_sd_px, row.dy_sd_px).cwiseMax(kLeastStepSd_px)};
    }
    return {{rim.x_px, rim.y_px}, Vector2d(rim.x_sd_px, rim.y_sd_px).cwiseMax(kLeastCentreSd_px)};
  }

  Eigen::Vector3d powers_at(const FlightRows& flight, std::size_t i) const {
    const auto t = static_cast<double>(i - flight.first);
    return motions_ ? Eigen::Vector3d(0, 1, t + 0.5) : Eigen::Vector3d(1, t, t * t / 2);
  }

  // Of a row whose centre or motion is `on_path` but for its noise. What was measured itself would
  // go along with its noise, and look like a lens.
  Vector2d bend_of(const TrackRow& row, const Vector2d& on_path) const {
    if (!motions_) return bending_.place(on_path);
    const RimCentre rim = rim_centre(row);
    return bending_.step(Vector2d(rim.x_px, rim.y_px) + on_path / 2, on_path);
  }

  // Of one flight without a lens.
  Path path_of(const FlightRows& flight) const {
    Eigen::Matrix3d normal = 1e-12 * Eigen::Matrix3d::Identity();
    Path side = Path::Zero();
    for (std::size_t i = flight.first; i <= flight.last; ++i) {
      const TrackRow row = rows_[i];
      if (!counts(row)) continue;
      const Eigen::Vector3d powers = powers_at(flight, i);
      const Seen seen = seen_in(row);
      const double weight = 1 / seen.sd.squaredNorm();
      normal += weight * powers * powers.transpose();
      side += weight * powers * seen.value.transpose();
    }
    return normal.ldlt().solve(side);
  }

  TrackRows rows_;
  const std::vector<FlightRows>& flights_;
  bool motions_;
  Bending bending_;
  std::vector<Path> paths_;
};

// Least squares, once more without what does not fit; the last unknown with its deviation, which
// the residuals' own scatter enlarges.
std::optional<Measured> last_unknown(const Equations& equations, double& scatter,
                                     Eigen::VectorXd& all) {
  const Eigen::Index size = equations.unknowns();
  std::vector<bool> used;
  equations.each([&](const Eigen::VectorXd&, double) { used.push_back(true); });
  Measured found;
  for (int round = 0; round < 3; ++round) {
    // Motions do not tell places: those stay where they are, at 0.
    Eigen::MatrixXd normal = 1e-12 * Eigen::MatrixXd::Identity(size, size);
    Eigen::VectorXd side = Eigen::VectorXd::Zero(size);
    std::size_t count = 0, at = 0;
    equations.each([&](const Eigen::VectorXd& slope, double value) {
      if (!used[at++]) return;
      normal += slope * slope.transpose();
      side += slope * value;
      ++count;
    });
    if (count < 2 * static_cast<std::size_t>(size)) return std::nullopt;
    const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Eigen::MatrixXd> solver(scale.asDiagonal() * normal * scale.asDiagonal());
    all = scale.asDiagonal() * solver.solve(scale.asDiagonal() * side);
    const auto each_off = [&](const auto& use) {
      at = 0;
      equations.each([&](const Eigen::VectorXd& slope, double value) {
        use(at, std::abs(value - slope.dot(all)));
        ++at;
      });
    };
    double squares = 0;
    each_off([&](std::size_t i, double off) { squares += used[i] ? off * off : 0.0; });
    scatter = std::sqrt(squares / static_cast<double>(count - size));
    const Eigen::VectorXd last = Eigen::VectorXd::Unit(size, size - 1);
    const double variance = solver.solve(last)[size - 1] * scale[size - 1] * scale[size - 1];
    found = {all[size - 1], std::sqrt(std::max(variance, 0.0)) * std::max(1.0, scatter)};
    each_off(
        [&](std::size_t i, double off) { used[i] = off <= kOutlier * std::max(1.0, scatter); });
  }
  if (!std::isfinite(found.value) || !(found.sd > 0)) return std::nullopt;
  return found;
}

// Whether a path of these speeds and accelerations (x, y) may change its speed by `share` without
// a lens: one that turns by an angle, as on a circle, changes what a straight line through it sees
// by the angle's square.
bool may_turn_by_itself(const Eigen::VectorXd& path, double frames, double share,
                        const std::optional<FallInPicture>& gravity) {
  const Vector2d acceleration(path[2], path[5]);
  const Vector2d speed = Vector2d(path[1], path[4]) + acceleration * frames / 2;
  if (gravity) {
    const Vector2d fall(gravity->x, gravity->y);
    if ((acceleration - fall).norm() < kFallTolerance * fall.norm()) return false;
  }
  const double across = std::abs(speed.x() * acceleration.y() - speed.y() * acceleration.x());
  const double turn = across / std::max(speed.squaredNorm(), 1e-300) * frames;
  return turn * turn > share;
}

}  // namespace

std::optional<LensBend> bend_of_flights(const TrackRows& rows, const ImpactAnalysis& analysis,
                                        int width, int height,
                                        const std::optional<FallInPicture>& gravity) {
  std::vector<FlightRows> flights = flights_of(rows, analysis, kFewestFrames);
  // A bent flight passes for none: all rows, if they turn out to be a steady one through a lens.
  const bool guessed = flights.empty();
  if (guessed) {
    if (rows.size() < kFewestFrames + 2 || analysis.status != ImpactStatus::kNone) {
      return std::nullopt;
    }
    flights.push_back({0, rows.size() - 2});
  }
  const Bending bending{{(width - 1) / 2.0, (height - 1) / 2.0}, std::hypot(width, height) / 2};
  const TrackRows first = rows.part(flights[0].first, flights[0].last);
  const bool motions =
      std::any_of(first.begin(), first.end(), [](const TrackRow& row) { return row.motion_ok; });
  double scatter = 0;
  Eigen::VectorXd paths;
  const std::optional<Measured> corner =
      last_unknown(Equations(rows, flights, motions, bending), scatter, paths);
  if (!corner || (guessed && scatter > kSteady)) return std::nullopt;
  if (std::abs(corner->value) > kMostCorner) return std::nullopt;
  LensBend bend{*corner, 0, 0};
  for (std::size_t f = 0; f < flights.size(); ++f) {
    const FlightRows& flight = flights[f];
    double least = 1e300, most = -1e300;
    for (std::size_t i = flight.first; i <= flight.last; ++i) {
      const TrackRow row = rows[i];
      if (!row.circle_ok) continue;
      const Vector2d centre(row.cx_px, row.cy_px);
      bend.largest_px =
          std::max(bend.largest_px, std::abs(corner->value) * bending.place(centre).norm());
      if (!row.motion_ok) continue;
      const Vector2d motion(row.dx_px, row.dy_px);
      const double length = motion.norm();
      if (std::abs(corner->value) * bending.step(centre, motion).norm() < kLeastStep_px) continue;
      const double share =
          corner->value * bending.step(centre, motion).dot(motion) / (length * length);
      least = std::min(least, share), most = std::max(most, share);
    }
    if (!(most > least)) continue;
    const Eigen::VectorXd path =
        paths.segment<kPerFlight>(static_cast<Eigen::Index>(kPerFlight * f));
    const auto frames = static_cast<double>(flight.last - flight.first);
    if (may_turn_by_itself(path, frames, most - least, gravity)) continue;
    bend.speed_share = std::max(bend.speed_share, most - least);
  }
  return bend;
}

namespace {

// A frame's ball: when within its flight (-1 … 1), how far from the picture's middle (square, of
// half the diagonal), and the mean radius over its own.
struct Outline {
  std::size_t flight;
  double time, aside, smallness;
  double sd_px, weight = 1;
  bool used = true;
};

std::vector<Outline> outlines_of(const TrackRows& rows, const std::vector<FlightRows>& flights,
                                 const Bending& bending, double mean_r_px) {
  std::vector<Outline> outlines;
  for (std::size_t f = 0; f < flights.size(); ++f) {
    const auto [first, last] = flights[f];
    for (std::size_t i = first; i <= last; ++i) {
      const TrackRow row = rows[i];
      if (!row.circle_ok || !(row.r_px > 0)) continue;
      const Vector2d off = Vector2d(row.cx_px, row.cy_px) - bending.middle;
      outlines.push_back(
          {f, 2 * static_cast<double>(i - first) / static_cast<double>(last - first) - 1,
           off.squaredNorm() / (bending.half * bending.half), mean_r_px / row.r_px});
    }
  }
  return outlines;
}

// Least squares of smallness by flight, time and place: the slope by the place with the deviation
// that the scatter gives it, and the place's rms beside what flight and time explain of it.
struct OutlineFit {
  Measured slope;
  double aside_rms, scatter;
};
std::optional<OutlineFit> fit_outlines(std::vector<Outline> outlines, std::size_t flights) {
  const auto size = static_cast<Eigen::Index>(2 * flights + 1);
  OutlineFit fit{};
  for (int round = 0; round < 3; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd side = Eigen::VectorXd::Zero(size);
    const auto slope_of = [&](const Outline& one) {
      Eigen::VectorXd slope = Eigen::VectorXd::Zero(size);
      slope.segment<2>(static_cast<Eigen::Index>(2 * one.flight)) << 1, one.time;
      slope[size - 1] = one.aside;
      slope *= one.weight;
      return slope;
    };
    double count = 0;
    for (const Outline& one : outlines) {
      if (!one.used) continue;
      const Eigen::VectorXd slope = slope_of(one);
      normal += slope * slope.transpose();
      side += slope * (one.weight * one.smallness);
      ++count;
    }
    if (count < static_cast<double>(size + 6)) return std::nullopt;
    const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
    const Eigen::VectorXd all = solver.solve(side);
    const double inverse = solver.solve(Eigen::VectorXd::Unit(size, size - 1))[size - 1];
    const auto off = [&](const Outline& one) {
      return one.weight * one.smallness - slope_of(one).dot(all);
    };
    double squares = 0;
    for (const Outline& one : outlines) squares += one.used ? off(one) * off(one) : 0;
    const double scatter = std::sqrt(squares / (count - static_cast<double>(size)));
    if (!(inverse > 0) || !std::isfinite(all[size - 1])) return std::nullopt;
    fit = {{all[size - 1], scatter * std::sqrt(inverse)}, 1 / std::sqrt(inverse * count), scatter};
    for (Outline& one : outlines) one.used = std::abs(off(one)) <= kOutlier * scatter;
  }
  return fit;
}

}  // namespace

std::optional<Measured> corner_by_outline(const TrackRows& rows, const ImpactAnalysis& analysis,
                                          int width, int height) {
  std::vector<FlightRows> flights = flights_of(rows, analysis, kFewestFrames);
  const bool guessed = flights.empty();
  if (guessed && analysis.status == ImpactStatus::kNone && rows.size() > kFewestFrames) {
    flights.push_back({0, rows.size() - 1});
  }
  double sum = 0, count = 0;
  for (const auto& [first, last] : flights) {
    for (std::size_t i = first; i <= last; ++i) {
      const TrackRow row = rows[i];
      if (row.circle_ok && row.r_px > 0) sum += row.r_px, ++count;
    }
  }
  if (count == 0) return std::nullopt;
  const double mean_r_px = sum / count;
  const Bending bending{{(width - 1) / 2.0, (height - 1) / 2.0}, std::hypot(width, height) / 2};
  const auto fit = fit_outlines(outlines_of(rows, flights, bending, mean_r_px), flights.size());
  if (!fit) return std::nullopt;
  const double steady =
      kSteady * kOutlineBias_px / mean_r_px + kSmallLens * std::abs(fit->slope.value);
  if (guessed && fit->scatter > steady) return std::nullopt;
  const double bias = kOutlineBias_px / mean_r_px / fit->aside_rms;
  return Measured{-fit->slope.value / 2, std::hypot(fit->slope.sd, bias) / 2};
}

std::string outline_warning(const std::optional<Measured>& corner, int width, int height,
                            bool corrected) {
  if (!corner || std::abs(corner->value) > kMostCorner) return "";
  // The outline of a sphere at the angle a off the axis is larger by tan²(a) / 4 in the mean.
  const double tangent = std::hypot(width, height) / 2 / (kNearest_widths * width);
  const double near = corner->value > 0 && !corrected ? tangent * tangent / 8 : 0;
  if (std::abs(corner->value) <= kOutlineChance * corner->sd + kLeastCorner + near) return "";
  char text[320];
  std::snprintf(
      text, sizeof text,
      "the ball's outline changes with its place as through a lens with %.2f +- %.2f %% of "
      "distortion at the picture's corners: %s",
      100 * corner->value, 100 * corner->sd,
      corrected ? "was the camera calibrated with this lens and picture?"
                : "calibrate the camera (impactdic calibrate, --camera)");
  return text;
}

std::string lens_warning(const std::optional<LensBend>& bend, bool corrected) {
  if (!bend) return "";
  const Measured& corner = bend->corner;
  const bool there = std::abs(corner.value) > kChance * corner.sd + kLeastCorner;
  if (!there || bend->speed_share < kLeastShare) return "";
  char text[320];
  std::snprintf(
      text, sizeof text,
      "the flights bend as through a lens with %.2f +- %.2f %% of distortion at the "
      "picture's corners, which moves the ball by up to %.2f px and its speed by %.2f %%: "
      "%s",
      100 * corner.value, 100 * corner.sd, bend->largest_px, 100 * bend->speed_share,
      corrected ? "was the camera calibrated with this lens and picture?"
                : "calibrate the camera (impactdic calibrate, --camera)");
  return text;
}

}  // namespace impactdic::run

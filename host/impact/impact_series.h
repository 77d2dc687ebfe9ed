// A track turned into the surface's axes, in pixels and frames. Internal to the impact analysis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/clip/track_row.h"
#include "host/clip/track_rows.h"
#include "host/sphere/source_response.h"

namespace impactdic::impact {

// The motion of a sphere from one instant to the next, beside what a flat ball has. Pairs are
// components t, n. Errors of the radius are taken out of the deviations: they are alike in all
// rows.
struct SphereStep {
  bool ok = false;
  std::array<double, 2> turn{};                    // rad, about t and n
  std::array<double, 2> step_sd{};                 // px
  std::array<double, 2> turn_sd{};                 // rad, were the step known
  std::array<std::array<double, 2>, 2> by_step{};  // rad a px: what a wrong step makes of each turn
  // For each px by which the radius is told too large.
  std::array<double, 2> step_to_radius{}, turn_to_radius{};
  // The same of the radius over the camera's distance; roll: about b.
  std::array<double, 2> step_to_nearness{}, turn_to_nearness{};
  double roll_to_nearness = 0;
};

// What the rows of a sphere were measured with.
struct SphereKnown {
  // Deviation of the radius; nullopt: not known, no more than as a rim shows it, and left in the
  // rows' deviations.
  std::optional<double> radius_sd_px;
  double nearness_sd = 0;           // of the radius over the camera's distance
  std::array<double, 2> axis_px{};  // the optical axis in the rows
};

class SphereSteps {
 public:
  // `rows` must outlive the object.
  SphereSteps(const TrackRows& rows, double surface_angle_rad, const SphereKnown& known);
  double radius_sd_px() const { return known_.radius_sd_px.value_or(kOfRim_px); }
  double nearness_sd() const { return known_.nearness_sd; }
  // What errors make of a motion that `row`'s ball begins, axes and units as there.
  sphere::SourceResponse response(const TrackRow& row, const Eigen::Vector3d& turn, double dx_px,
                                  double dy_px) const;
  double radius_px() const { return radius_px_; }
  const TrackRows& rows() const { return rows_; }
  // Of the surface's angle.
  double cosine() const { return c_; }
  double sine() const { return s_; }
  // Of row `i` to the next. Costs some ten microseconds.
  SphereStep operator[](std::size_t i) const;

 private:
  TrackRows rows_;
  static constexpr double kOfRim_px = 0.5;
  double c_, s_;  // cosine and sine of the surface's angle
  double radius_px_;
  SphereKnown known_;
};

// Row i of the track is the instant i. Local axes: t along the surface, n out of it, both px.
// What was not measured is NaN. In memory is only what is looked at from end to end.
class ImpactSeries {
 public:
  // `surface_angle_rad` counter-clockwise from image-right; `rows` must outlive the series.
  ImpactSeries(const TrackRows& rows, double surface_angle_rad, const SphereKnown& known);
  // Takes differences of the centres for steps, as where no motion was measured.
  void use_centres();
  // Whether most of the rows first … last - 1 have no motion.
  bool is_motion_lost(std::size_t first, std::size_t last) const;

  std::vector<double> position_n, step_n;  // of the rim's centre; the ball's motion from i to i + 1
  std::optional<SphereSteps> sphere;       // nullopt: a flat ball
  bool from_circle = false;                // no motion is used: steps are differences of positions

  double position_t(std::size_t i) const;
  double position_sd(std::size_t i) const;
  // How far along t and n the rim's centre lies beside the ball's in the rows first … last, on the
  // mean of those that say so; 0 where none does.
  std::array<double, 2> rim_off(std::size_t first, std::size_t last) const;
  double step_t(std::size_t i) const;
  double step_sd(std::size_t i) const;
  double turn(std::size_t i) const;  // rad, from i to i + 1
  double turn_sd(std::size_t i) const;
  // Along t and n, px, of a place of the picture.
  std::array<double, 2> local(double x_px, double y_px) const {
    return {c_ * x_px - s_ * y_px, -s_ * x_px - c_ * y_px};
  }
  // Of a flat ball against a keyframe; angle_rad is NaN where it was not placed.
  BodyPose pose(std::size_t i) const { return rows_[i].pose; }
  // What the circle states that the pose of row `i` leads back to; NaN where no row has it.
  double origin_sd(std::size_t i) const;
  std::size_t size() const { return position_n.size(); }

 private:
  // A circle that lies elsewhere on the body than the others tells no place. What contradicts it is
  // a flat ball's motion, which keyframes bear out.
  bool has_place(const TrackRow& row, std::size_t i) const;
  bool has_motion(const TrackRow& row, std::size_t i) const;

  TrackRows rows_;
  std::vector<bool> is_elsewhere_;
  double c_, s_;  // cosine and sine of the surface's angle
};

// `count` values that scatter by `scatter` of the deviation which each of them states: the share of
// its square that they must have in common, beyond chance (three deviations). A steady ball meets
// the same fraction of a pixel in every frame, with the same bias of the interpolation: a mean over
// many frames is no better than that.
double common_share(double scatter, std::size_t count);

}  // namespace impactdic::impact

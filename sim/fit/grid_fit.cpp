#include "sim/fit/grid_fit.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <boost/math/interpolators/cardinal_cubic_b_spline.hpp>
#include <cmath>
#include <limits>

#include "sim/contact/impact.h"

namespace impactdic::sim::fit {
namespace {

using Spline = boost::math::interpolators::cardinal_cubic_b_spline<double>;

constexpr int kFiner = 10;  // the spline's table over the grid's

struct MeasuredContact {
  std::vector<double> time_s, deflection_m;  // from the touch
  double largest_m = 0, final_vn_m_s = 0;
};

MeasuredContact contact_of(const MeasuredTrack& track, const MeasuredShot& shot) {
  MeasuredContact measured;
  const double angle = shot.surface_angle_deg * kRadPerDeg;
  const double height = -std::sin(angle) * shot.touch_x_m + std::cos(angle) * shot.touch_y_m;
  for (std::size_t i = 0; i < track.time_s.size(); ++i) {
    const double time = track.time_s[i] - shot.contact_start_s.value;
    if (time < 0 || time > shot.contact_s.value || std::isnan(track.x_m[i])) continue;
    const double qn = -std::sin(angle) * track.x_m[i] + std::cos(angle) * track.y_m[i];
    measured.time_s.push_back(time);
    measured.deflection_m.push_back(height - qn);
    measured.largest_m = std::max(measured.largest_m, height - qn);
  }
  measured.final_vn_m_s = shot.after.vn_m_s.value;
  return measured;
}

// A spline through the sum along both axes: along the damping at each stiffness, then across.
class SurfaceSpline {
 public:
  explicit SurfaceSpline(const ErrorSurface& surface) : surface_(surface) {
    const std::size_t columns = surface.damping_n_s_per_m.size();
    for (std::size_t i = 0; i < surface.stiffness.size(); ++i) {
      std::vector<double> row(columns);
      for (std::size_t j = 0; j < columns; ++j) row[j] = sum(i, j);
      along_.emplace_back(row.begin(), row.end(), surface.damping_n_s_per_m[0],
                          surface.damping_n_s_per_m[1] - surface.damping_n_s_per_m[0]);
    }
  }
  double sum(std::size_t i, std::size_t j) const {
    const std::size_t at = i * surface_.damping_n_s_per_m.size() + j;
    return surface_.displacement[at] + surface_.velocity[at];
  }
  // Across the stiffness at one damping.
  Spline at_damping(double damping) const {
    std::vector<double> column;
    for (const Spline& row : along_) column.push_back(row(damping));
    return {column.begin(), column.end(), surface_.stiffness[0],
            surface_.stiffness[1] - surface_.stiffness[0]};
  }

 private:
  const ErrorSurface& surface_;
  std::vector<Spline> along_;
};

// The least value near the least node: ever finer tables about it.
void find_minimum(const SurfaceSpline& spline, ErrorSurface& s, std::size_t least_i,
                  std::size_t least_j) {
  double step_k = s.stiffness[1] - s.stiffness[0];
  double step_b = s.damping_n_s_per_m[1] - s.damping_n_s_per_m[0];
  double k = s.stiffness[least_i], b = s.damping_n_s_per_m[least_j];
  for (int level = 0; level < 6; ++level) {
    double least = std::numeric_limits<double>::infinity(), best_k = k, best_b = b;
    for (int j = -kFiner; j <= kFiner; ++j) {
      const double at_b = b + j * step_b / kFiner;
      if (at_b < s.damping_n_s_per_m.front() || at_b > s.damping_n_s_per_m.back()) continue;
      const Spline across = spline.at_damping(at_b);
      for (int i = -kFiner; i <= kFiner; ++i) {
        const double at_k = k + i * step_k / kFiner;
        if (at_k < s.stiffness.front() || at_k > s.stiffness.back()) continue;
        const double value = across(at_k);
        if (value < least) least = value, best_k = at_k, best_b = at_b;
      }
    }
    k = best_k, b = best_b;
    step_k /= 5, step_b /= 5;
  }
  s.spline_stiffness = k;
  s.spline_damping = b;
}

void add_fine_table(const SurfaceSpline& spline, ErrorSurface& s) {
  const auto finer = [](const std::vector<double>& nodes) {
    std::vector<double> fine;
    const double step = (nodes[1] - nodes[0]) / kFiner;
    for (std::size_t i = 0; i < (nodes.size() - 1) * kFiner + 1; ++i) {
      fine.push_back(std::min(nodes[0] + static_cast<double>(i) * step, nodes.back()));
    }
    return fine;
  };
  s.fine_stiffness = finer(s.stiffness);
  s.fine_damping = finer(s.damping_n_s_per_m);
  s.fine_sum.resize(s.fine_stiffness.size() * s.fine_damping.size());
  for (std::size_t j = 0; j < s.fine_damping.size(); ++j) {
    const Spline across = spline.at_damping(s.fine_damping[j]);
    for (std::size_t i = 0; i < s.fine_stiffness.size(); ++i) {
      s.fine_sum[i * s.fine_damping.size() + j] = across(s.fine_stiffness[i]);
    }
  }
}

struct NodeError {
  double displacement, velocity;
};

NodeError node_error(const ImpactJob& job, const MeasuredContact& measured) {
  const ImpactResult impact = contact::simulate_impact(job, {0, measured.time_s});
  NodeError error{0, 1};
  for (std::size_t i = 0; i < measured.time_s.size(); ++i) {
    // Out of contact the model's ball flies on: its "deflection" is then a height, as the camera's.
    const double model = -impact.trajectory[i].state.qn_m;
    error.displacement += std::abs(model - measured.deflection_m[i]);
  }
  error.displacement /= static_cast<double>(measured.time_s.size()) * measured.largest_m;
  if (impact.separated) {
    error.velocity = std::abs(impact.final.vn_m_s - measured.final_vn_m_s) / measured.final_vn_m_s;
  }
  return error;
}

}  // namespace

ErrorSurface error_surface(const MeasuredTrack& track, const MeasuredShot& shot,
                           const ImpactJob& laws, const FitGrid& grid) {
  const MeasuredContact measured = contact_of(track, shot);
  ErrorSurface s;
  for (int i = 0; i <= grid.stiffness_steps; ++i) {
    s.stiffness.push_back(grid.stiffness_max * i / grid.stiffness_steps);
  }
  for (int j = 0; j <= grid.damping_steps; ++j) {
    s.damping_n_s_per_m.push_back(grid.damping_max_n_s_per_m * j / grid.damping_steps);
  }
  ImpactJob job = job_of_shot(laws, shot);
  double least = std::numeric_limits<double>::infinity();
  std::size_t least_i = 0, least_j = 0;
  for (std::size_t i = 0; i < s.stiffness.size(); ++i) {
    job.contact.stiffness = i == 0 ? s.stiffness[1] / 1000 : s.stiffness[i];
    for (std::size_t j = 0; j < s.damping_n_s_per_m.size(); ++j) {
      job.contact.damping_n_s_per_m = s.damping_n_s_per_m[j];
      const NodeError error = node_error(job, measured);
      s.displacement.push_back(error.displacement);
      s.velocity.push_back(error.velocity);
      if (error.displacement + error.velocity < least) {
        least = error.displacement + error.velocity;
        least_i = i, least_j = j;
      }
    }
  }
  s.grid_stiffness = s.stiffness[least_i];
  s.grid_damping = s.damping_n_s_per_m[least_j];
  const SurfaceSpline spline(s);
  find_minimum(spline, s, least_i, least_j);
  add_fine_table(spline, s);
  return s;
}

ShotFit fit_grid(const MeasuredTrack& track, const MeasuredShot& shot, const FitRequest& job,
                 ErrorSurface& surface) {
  surface = error_surface(track, shot, job.impact, job.grid);
  ShotFit fit;
  fit.shot = shot;
  const auto add = [&](FitParameter p, double value, double largest) {
    ParameterEstimate estimate;
    estimate.parameter = p;
    estimate.key = key_of(p, job.impact.normal);
    estimate.value = value;
    estimate.sd = estimate.ci95_low = estimate.ci95_high = kNotMeasured;
    estimate.determined = value > 0 && value < largest;
    estimate.verdict = estimate.determined
                           ? "least node's neighbourhood; the published way gives no deviation"
                           : "the least error lies at the edge of the grid: widen the grid";
    fit.parameters.push_back(estimate);
  };
  add(FitParameter::kStiffness, surface.spline_stiffness, job.grid.stiffness_max);
  add(FitParameter::kDamping, surface.spline_damping, job.grid.damping_max_n_s_per_m);
  fit.covariance.assign(4, kNotMeasured);
  fit.free_parameters = 2;
  fit.aic = fit.chi_square = fit.reduced_chi_square = fit.rms_m = kNotMeasured;
  return fit;
}

}  // namespace impactdic::sim::fit

#include "host/run/impact_figures.h"

#include <cmath>

#include "host/impact/impact_phases.h"

namespace impactdic::run {
namespace {

constexpr double kGravity_m_s2 = 9.81;
// Drag on a ball and rounded angles: the fall may differ by this part without meaning anything.
constexpr double kFallTolerance = 0.05;

Measured in(const Measured& m, double unit) { return {m.value * unit, m.sd * std::abs(unit)}; }

// From analysed frames to the clocks of the clip.
class Converter {
 public:
  Converter(const std::vector<TrackRow>& rows, const SiScale& scale) : scale_(scale) {
    if (!rows.empty()) first_ = static_cast<double>(rows[0].frame);
    if (rows.size() > 1) step_ = static_cast<double>(rows[1].frame - rows[0].frame);
    in_si_ = scale.metre_per_px > 0 && scale.fps > 0;
  }

  bool in_si() const { return in_si_; }
  double metre() const { return scale_.metre_per_px > 0 ? scale_.metre_per_px : kNotMeasured; }
  double second() const { return scale_.fps > 0 ? 1 / scale_.fps : kNotMeasured; }

  ImpactInstant instant(const Measured& m) const {
    if (!std::isfinite(m.value)) return {};
    const double rate = scale_.fps > 0 ? scale_.fps : kNotMeasured;
    return {first_ + step_ * m.value, step_ * m.sd, m.value / rate, m.sd / rate};
  }
  ImpactMotion motion(const FlightMotion& m) const {
    if (m.last == 0) return {};
    const double speed = in_si_ ? scale_.metre_per_px * scale_.fps : 1;
    ImpactMotion motion;
    motion.known = true;
    motion.first_frame = first_ + step_ * static_cast<double>(m.first);
    motion.last_frame = first_ + step_ * static_cast<double>(m.last);
    motion.vx = in(m.vx, speed);
    motion.vy = in(m.vy, speed);
    motion.vt = in(m.vt, speed);
    motion.vn = in(m.vn, speed);
    motion.spin = in(m.spin, in_si_ ? scale_.fps : 1);
    return motion;
  }
  void fall(const Measured& fall, ImpactFigures& figures) const {
    const double unit = in_si_ ? scale_.metre_per_px * scale_.fps * scale_.fps : kNotMeasured;
    figures.gravity_m_s2 = in(fall, unit);
    const double off = std::abs(fall.value * unit - kGravity_m_s2);
    const double allowed = 3 * fall.sd * unit + kFallTolerance * kGravity_m_s2;
    if (std::isfinite(off)) figures.gravity_agrees = off <= allowed;
  }

 private:
  const SiScale& scale_;
  double first_ = 0, step_ = 1;
  bool in_si_ = false;
};

}  // namespace

void analyse_impact(const TrackRequest& request, const std::vector<TrackRow>& rows,
                    const SiScale& scale, ImpactAnalysis& analysis, ImpactFigures& figures) {
  impact::ImpactOptions options;
  options.surface_angle_rad = scale.surface_angle_rad;
  options.gravity_angle_rad = request.gravity_angle_deg * kRadPerDeg;
  if (request.inertia_factor > 0) options.inertia_factor = request.inertia_factor;
  if (scale.metre_per_px > 0 && scale.fps > 0) {
    options.gravity = kGravity_m_s2 / scale.metre_per_px / (scale.fps * scale.fps);
  }
  analysis = impact::analyse_impact(rows, options);
  const Converter convert(rows, scale);
  figures = {};
  figures.status = analysis.status;
  figures.inertia_factor = options.inertia_factor;
  if (!figures.found()) return;
  figures.in_si = convert.in_si();
  figures.t0 = convert.instant(analysis.start.instant);
  figures.t_max_compression = convert.instant(analysis.turn);
  figures.t_end = convert.instant(analysis.end.instant);
  figures.start_exponent = analysis.start.exponent;
  figures.end_exponent = analysis.end.exponent;
  figures.start_law_holds = analysis.start.law_holds;
  figures.end_law_holds = analysis.end.law_holds;
  figures.contact_frames = analysis.duration;
  figures.contact_s = in(analysis.duration, convert.second());
  figures.before = convert.motion(analysis.before);
  figures.after = convert.motion(analysis.after);
  figures.restitution = analysis.restitution;
  figures.friction_published = analysis.friction_published;
  figures.friction = analysis.friction;
  figures.rolling_cap = analysis.rolling_cap;
  figures.max_deflection_px = analysis.max_deflection;
  figures.max_deflection_m = in(analysis.max_deflection, convert.metre());
  figures.closure = analysis.closure;
  convert.fall(analysis.fall, figures);
  figures.centre_against_motion_px_per_frame = analysis.disagreement;
  figures.centre_scatter = analysis.position_scatter;
  figures.motion_scatter = analysis.step_scatter;
}

}  // namespace impactdic::run

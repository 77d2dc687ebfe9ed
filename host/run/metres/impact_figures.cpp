#include "host/run/metres/impact_figures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/impact/impact_phases.h"
#include "host/run/metres/space_figures.h"

namespace impactdic::run {
namespace {

// What a coder of video moves a ball by beside its path, and for several frames alike. It moves by
// quarters of a pixel, and takes what changes little to stand still. [bench/coded_film.py: three
// of 400 films without an impact showed one, their balls up to 0.08 px off.]
constexpr double kCodedPathSd_px = 0.03;

// Drag on a ball and rounded angles: the fall may differ by this part without meaning anything.
constexpr double kGivenFallTolerance = 0.05;

Measured in(const Measured& m, double unit) { return {m.value * unit, m.sd * std::abs(unit)}; }

double norm(const ErrorParts& parts) {
  double squares = 0;
  for (const double part : parts) squares += part * part;
  return std::sqrt(squares);
}

// From analysed frames to the clocks of the clip, from px to metres.
class Converter {
 public:
  Converter(const TrackRows& rows, const SiScale& scale, const ImpactAnalysis& analysis,
            ImpactFigures& figures)
      : scale_(scale), analysis_(analysis), figures_(figures) {
    number_frames(rows);
    in_si_ = scale.metre_per_px > 0 && scale.fps > 0;
    if (scale.metre_per_px > 0) metre_sd_ = scale.metre_per_px_sd / scale.metre_per_px;
    if (scale.fps > 0) rate_sd_ = scale.fps_sd / scale.fps;
  }

  void convert() {
    const ImpactAnalysis& a = analysis_;
    figures_.in_si = in_si_;
    figures_.t0 = instant(a.start.instant);
    figures_.t_max_compression = instant(a.turn);
    figures_.t_end = instant(a.end.instant);
    figures_.before = motion(a.before, ImpactFigure::kVxBefore);
    figures_.after = motion(a.after, ImpactFigure::kVxAfter);
    figures_.restitution = figure(ImpactFigure::kRestitution, a.restitution, 0, 0);
    figures_.friction_published =
        figure(ImpactFigure::kFrictionPublished, a.friction_published, 0, 0);
    figures_.friction = figure(ImpactFigure::kFriction, a.friction, 0, 0);
    figures_.rolling_cap = figure(ImpactFigure::kRollingCap, a.rolling_cap, 0, 0);
    figures_.closure = a.closure;
    figures_.closure.inertia_factor =
        figure(ImpactFigure::kClosingInertia, a.closure.inertia_factor, 0, 0);
    figures_.contact_frames = a.duration;
    figures_.contact_s = figure(ImpactFigure::kContactDuration, a.duration, 0, -1);
    figures_.max_deflection_px = a.max_deflection;
    figures_.max_deflection_m = figure(ImpactFigure::kMaxDeflection, a.max_deflection, 1, 0);
    figures_.space = to_si(a.space, scale_);
    fall();
  }

  // Of a clip without an impact.
  void convert_flight() {
    figures_.in_si = in_si_;
    figures_.flight = motion(analysis_.flight, std::nullopt);
  }

 private:
  // A figure that goes with these powers of scale and rate, with its budget. Figures that need one
  // which is not known are NaN.
  Measured figure(ImpactFigure which, const Measured& m, int metres, int rate) {
    double unit = 1;
    if (metres != 0) unit *= scale_.metre_per_px > 0 ? scale_.metre_per_px : kNotMeasured;
    if (rate != 0) unit *= scale_.fps > 0 ? std::pow(scale_.fps, rate) : kNotMeasured;
    const double value = m.value * unit;
    if (!std::isfinite(value)) return {};
    const FigureBudget& budget = analysis_.budgets[static_cast<std::size_t>(which)];
    ErrorParts parts = budget.parts;
    for (double& part : parts) part *= std::abs(unit);
    if (in_si_) {  // gravity in px/frame^2 is 9.81 m/s^2 over scale and squared rate
      const double by_gravity = budget.per_gravity * unit;
      parts[static_cast<std::size_t>(ErrorSource::kScale)] =
          std::abs(metres * value - by_gravity) * metre_sd_;
      parts[static_cast<std::size_t>(ErrorSource::kTime)] =
          std::abs(rate * value - 2 * by_gravity) * rate_sd_;
    } else {
      parts[static_cast<std::size_t>(ErrorSource::kScale)] = std::abs(metres * value) * metre_sd_;
      parts[static_cast<std::size_t>(ErrorSource::kTime)] = std::abs(rate * value) * rate_sd_;
    }
    figures_.budgets[static_cast<std::size_t>(which)] = parts;
    return {value, norm(parts)};
  }

  // The same without a budget.
  Measured plain(const Measured& m, int metres, int rate) const {
    const double unit = std::pow(scale_.metre_per_px, metres) * std::pow(scale_.fps, rate);
    const double value = m.value * unit;
    return {value, std::hypot(m.sd * unit, metres * value * metre_sd_, rate * value * rate_sd_)};
  }

  // Rows of missing frames have the number of the one before: they lie evenly up to the next.
  void number_frames(const TrackRows& rows) {
    stored_.reserve(rows.size());
    for (const TrackRow& row : rows) stored_.push_back(static_cast<double>(row.frame));
    for (std::size_t i = 0, next = 1; i < stored_.size(); i = next++) {
      while (next < stored_.size() && stored_[next] == stored_[i]) ++next;
      if (next == stored_.size()) break;
      const double step = (stored_[next] - stored_[i]) / static_cast<double>(next - i);
      for (std::size_t k = i + 1; k < next; ++k) stored_[k] += step * static_cast<double>(k - i);
    }
  }

  // The stored frame, with its fraction, at an instant of the analysis.
  double stored(double instant) const {
    if (stored_.size() < 2) return instant;
    const double last = static_cast<double>(stored_.size() - 2);
    const auto i = static_cast<std::size_t>(std::clamp(std::floor(instant), 0.0, last));
    return stored_[i] + (instant - static_cast<double>(i)) * (stored_[i + 1] - stored_[i]);
  }

  ImpactInstant instant(const Measured& m) const {
    if (!std::isfinite(m.value)) return {};
    const double rate = scale_.fps > 0 ? scale_.fps : kNotMeasured;
    const double time_s = m.value / rate;
    return {stored(m.value), m.sd * (stored(std::floor(m.value) + 1) - stored(std::floor(m.value))),
            time_s, std::hypot(m.sd / rate, time_s * rate_sd_)};
  }

  // `first`: kVx… of the flight; nullopt where there is no impact and so no budget.
  ImpactMotion motion(const FlightMotion& m, std::optional<ImpactFigure> first) {
    if (m.last == 0) return {};
    ImpactMotion motion;
    motion.known = true;
    motion.first_frame = stored(static_cast<double>(m.first));
    motion.last_frame = stored(static_cast<double>(m.last));
    const int si = in_si_ ? 1 : 0;
    const auto part = [&](const Measured& value, int index, int metres) {
      if (!first) return plain(value, metres, si);
      return figure(static_cast<ImpactFigure>(static_cast<int>(*first) + index), value, metres, si);
    };
    motion.vx = part(m.vx, 0, si);
    motion.vy = part(m.vy, 1, si);
    motion.vt = part(m.vt, 2, si);
    motion.vn = part(m.vn, 3, si);
    motion.spin = part(m.spin, 4, 0);
    motion.spin_t = plain(m.spin_t, 0, si);
    motion.spin_n = plain(m.spin_n, 0, si);
    motion.vz = plain(m.vb, si, si);
    return motion;
  }

  void fall() {
    const Measured& fall = analysis_.fall;
    const double unit = in_si_ ? scale_.metre_per_px * scale_.fps * scale_.fps : kNotMeasured;
    figures_.gravity_m_s2 = in(fall, unit);
    figures_.gravity_m_s2.sd =
        std::hypot(figures_.gravity_m_s2.sd, figures_.gravity_m_s2.value * metre_sd_,
                   2 * figures_.gravity_m_s2.value * rate_sd_);
    const double off = std::abs(fall.value * unit - kGravity_m_s2);
    const double allowed = 3 * figures_.gravity_m_s2.sd + kGivenFallTolerance * kGravity_m_s2;
    if (std::isfinite(off)) figures_.gravity_agrees = off <= allowed;
  }

  const SiScale& scale_;
  const ImpactAnalysis& analysis_;
  ImpactFigures& figures_;
  std::vector<double> stored_;         // frames of the rows
  double metre_sd_ = 0, rate_sd_ = 0;  // relative
  bool in_si_ = false;
};

impact::ImpactOptions options_of(const TrackRequest& request, const SiScale& scale,
                                 const FilmedBall& ball) {
  impact::ImpactOptions options;
  options.surface_angle_rad = scale.surface_angle_rad;
  options.surface_angle_sd_rad = request.surface_angle_sd_deg * kRadPerDeg;
  options.gravity_angle_rad = request.gravity_angle_deg * kRadPerDeg;
  options.radius_px = ball.radius_px;
  if (ball.lossy) options.path_sd_px = kCodedPathSd_px;
  options.nearness_sd = ball.perspective.nearness_sd;
  options.axis_px = {ball.perspective.axis_x_px, ball.perspective.axis_y_px};
  if (request.inertia_factor > 0) options.inertia_factor = request.inertia_factor;
  if (scale.metre_per_px > 0 && scale.fps > 0) {
    options.gravity = kGravity_m_s2 / scale.metre_per_px / (scale.fps * scale.fps);
  }
  if (scale.metre_per_px > 0 && request.distance_mm > 0) {
    const double px_per_mm = 1e-3 / scale.metre_per_px;
    options.distance_px = {request.distance_mm * px_per_mm, request.distance_sd_mm * px_per_mm};
  }
  return options;
}

}  // namespace

ImpactAnalysis analyse_impact(const TrackRequest& request, const TrackRows& rows,
                              const SiScale& scale, const FilmedBall& ball, Impacts impacts) {
  impact::ImpactOptions options = options_of(request, scale, ball);
  options.impact_is_known = impacts == Impacts::kKnown;
  return impact::analyse_impact(rows, options);
}

std::vector<ImpactAnalysis> other_impacts(const TrackRequest& request, const TrackRows& rows,
                                          const SiScale& scale, const FilmedBall& ball,
                                          const ImpactAnalysis& found) {
  return impact::other_impacts(rows, options_of(request, scale, ball), found);
}

std::array<Measured*, kImpactFigures> figures_with_budget(ImpactFigures& f) {
  return {&f.before.vx,  &f.before.vy,       &f.before.vt,
          &f.before.vn,  &f.before.spin,     &f.after.vx,
          &f.after.vy,   &f.after.vt,        &f.after.vn,
          &f.after.spin, &f.restitution,     &f.friction_published,
          &f.friction,   &f.rolling_cap,     &f.closure.inertia_factor,
          &f.contact_s,  &f.max_deflection_m};
}

ImpactFigures convert_impact(const TrackRequest& request, const TrackRows& rows,
                             const SiScale& scale, const ImpactAnalysis& analysis) {
  ImpactFigures figures;
  figures.status = analysis.status;
  if (request.inertia_factor > 0) figures.inertia_factor = request.inertia_factor;
  if (!figures.found()) {
    Converter(rows, scale, analysis, figures).convert_flight();
    return figures;
  }
  figures.start_exponent = analysis.start.exponent;
  figures.end_exponent = analysis.end.exponent;
  figures.start_law_holds = analysis.start.law_holds;
  figures.end_law_holds = analysis.end.law_holds;
  figures.centre_against_motion_px_per_frame = analysis.disagreement;
  figures.centre_scatter = analysis.position_scatter;
  figures.motion_scatter = analysis.step_scatter;
  Converter(rows, scale, analysis, figures).convert();
  return figures;
}

}  // namespace impactdic::run

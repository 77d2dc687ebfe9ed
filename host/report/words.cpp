// Results in a line for people.
#include "host/report/words.h"

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/parse.h"
#include "host/report/words/text.h"

namespace impactdic::report {

std::string in_words(const SizeAdvice& size) {
  std::string text = say("%d windows of %d px, %.0f %% usable", size.windows, size.window_px,
                         100 * size.usable_share());
  if (size.usable > 0) text += say(", %.4f px expected of each", size.error_px);
  return text;
}

std::string in_words(const PlaneFigures& camera) {
  std::string text =
      plus_minus(camera.metre_per_px.value * 1e3, camera.metre_per_px.sd * 1e3) +
      say(" mm/px in the plane of motion, distortion at most %.2f px", camera.distortion_px);
  if (std::isfinite(camera.tilt_deg)) text += say(", tilted by %.2f deg", camera.tilt_deg);
  return text;
}

std::string in_words(const NoiseFloor& floor) {
  return say(
      "%.4f, %.4f px over the windows, %.4f, %.4f px over the frames %lld to %lld, in which "
      "nothing moves (stated: %.4f, %.4f px)",
      floor.u_spatial_sd, floor.v_spatial_sd, floor.u_temporal_sd, floor.v_temporal_sd,
      static_cast<long long>(floor.first_frame), static_cast<long long>(floor.last_frame),
      floor.u_stated_sd, floor.v_stated_sd);
}

const char* explain(ImpactStatus status) {
  constexpr std::array kTexts = {
      "impact found", "no impact in these frames",
      "the ball turns on the other side of the surface: add 180 to --surface-angle-deg",
      "an impact, but fewer than 6 frames of free flight before or after it",
      "an impact whose contact is too short or too noisy for its start and end to be measured"};
  return kTexts[static_cast<std::size_t>(status)];
}

const char* explain(ClosureVerdict verdict) {
  constexpr std::array kTexts = {
      "the spin does not change enough to tell, or was not measured",
      "the tangential impulse accounts for the change of spin",
      "spin and tangential velocity change the wrong way round: is an axis or the surface's angle "
      "flipped?",
      "off by less than a quarter: the force may act nearer to or farther from the centre than the "
      "radius, as for a flattened ball",
      "off by more than a quarter: is the radius, the rotation or the inertia factor right?"};
  return kTexts[static_cast<std::size_t>(verdict)];
}

namespace {

// One ball in free flight: its speed, and its spin with what of it is out of the picture's plane.
std::string flight_in_words(const ImpactMotion& flight, bool in_si) {
  const double speed = std::hypot(flight.vx.value, flight.vy.value);
  const double speed_sd =
      std::hypot(flight.vx.value * flight.vx.sd, flight.vy.value * flight.vy.sd) /
      std::max(speed, 1e-300);
  std::string line = say(in_si ? "; one free flight at %.4f +- %.4f m/s"
                               : "; one free flight at %.5f +- %.5f px/frame",
                         speed, speed_sd);
  const double unit = in_si ? 1 : kDegPerRad;
  const char* const rate = in_si ? "rad/s" : "deg/frame";
  if (std::isfinite(flight.spin_t.value)) {
    const auto part = [&](const Measured& spin) {
      return say("%.5f +- %.5f", spin.value * unit, spin.sd * unit);
    };
    line += ", spin about t, n and the line of sight " + part(flight.spin_t) + ", " +
            part(flight.spin_n) + ", " + part(flight.spin) + " " + rate;
  } else if (std::isfinite(flight.spin.value)) {
    line += say(", spin %.5f +- %.5f ", flight.spin.value * unit, flight.spin.sd * unit) + rate;
  }
  return line;
}

}  // namespace

std::string in_words(const ImpactFigures& impact) {
  std::string line = explain(impact.status);
  if (impact.flight.known) line += flight_in_words(impact.flight, impact.in_si);
  if (!impact.found()) return line;
  const auto add = [&](double value, double sd, const char* format) {
    if (std::isfinite(value)) line += say(format, value, sd);
  };
  add(impact.t0.frame, impact.t0.sd_frames, "; contact from frame %.2f +- %.2f");
  add(impact.t_end.frame, impact.t_end.sd_frames,
      impact.t0.known() ? " to %.2f +- %.2f" : "; contact to frame %.2f +- %.2f");
  if (!impact.t0.known() || !impact.t_end.known()) {
    add(impact.t_max_compression.frame, impact.t_max_compression.sd_frames,
        "; at frame %.2f +- %.2f");
  }
  const auto add_figure = [&](ImpactFigure which, const Measured& m, const char* format) {
    add(m.value, m.sd, format);
    if (std::isfinite(m.value) && impact.is_doubtful(which)) line += " (doubtful)";
  };
  add_figure(ImpactFigure::kRestitution, impact.restitution, "; restitution %.4f +- %.4f");
  add_figure(ImpactFigure::kFriction, impact.friction, "; friction %.4f +- %.4f");
  return line;
}

}  // namespace impactdic::report

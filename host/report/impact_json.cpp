#include "host/report/impact_json.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace impactdic::report {
namespace {

using nlohmann::json;

constexpr double kGravity_m_s2 = 9.81;
// Drag on a ball and rounded angles: the fall may differ by this part without meaning anything.
constexpr double kFallTolerance = 0.05;

json figure(const impact::Measured& m, double unit = 1) {
  if (!std::isfinite(m.value * unit)) return nullptr;
  return {{"value", m.value * unit},
          {"sd", std::isfinite(m.sd) ? json(m.sd * std::abs(unit)) : json(nullptr)}};
}

const char* explain(impact::ImpactStatus status) {
  constexpr std::array kTexts = {
      "impact found", "no impact in these frames",
      "the ball turns on the other side of the surface: add 180 to --surface-angle-deg",
      "an impact, but fewer than 6 frames of free flight before or after it",
      "an impact whose contact is too short or too noisy for its start and end to be measured"};
  return kTexts[static_cast<std::size_t>(status)];
}

const char* explain(impact::ClosureVerdict verdict) {
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

class ImpactWriter {
 public:
  ImpactWriter(const impact::ImpactAnalysis& impact, const std::vector<TrackRow>& rows,
               const SiScale& scale)
      : impact_(impact), scale_(scale) {
    if (!rows.empty()) first_ = static_cast<double>(rows[0].frame);
    if (rows.size() > 1) step_ = static_cast<double>(rows[1].frame - rows[0].frame);
    si_ = scale.metre_per_px > 0 && scale.fps > 0;
    length_ = scale.metre_per_px > 0 ? scale.metre_per_px : kNotMeasured;
  }

  json instant(const impact::Measured& m) const {
    if (!std::isfinite(m.value)) return nullptr;
    json result = {{"frame", first_ + step_ * m.value}, {"sd_frames", step_ * m.sd}};
    result["time_s"] = scale_.fps > 0 ? json(m.value / scale_.fps) : json(nullptr);
    result["sd_s"] = scale_.fps > 0 ? json(m.sd / scale_.fps) : json(nullptr);
    return result;
  }
  json edge(const impact::ContactEdgeResult& edge) const {
    json result = instant(edge.instant);
    if (result.is_null()) return result;
    result["onset_exponent"] = figure(edge.exponent);
    result["onset_law_holds"] = edge.law_holds;
    return result;
  }
  json motion(const impact::FlightMotion& m) const {
    if (m.last == 0) return nullptr;
    const double speed = si_ ? scale_.metre_per_px * scale_.fps : 1;
    const std::string unit = si_ ? "_m_s" : "_px_per_frame";
    return {{"frames_used",
             {first_ + step_ * static_cast<double>(m.first),
              first_ + step_ * static_cast<double>(m.last)}},
            {"vx" + unit, figure(m.vx, speed)},
            {"vy" + unit, figure(m.vy, speed)},
            {"vt" + unit, figure(m.vt, speed)},
            {"vn" + unit, figure(m.vn, speed)},
            {si_ ? "omega_rad_s" : "omega_rad_per_frame", figure(m.spin, si_ ? scale_.fps : 1)}};
  }
  json closure(const std::optional<double>& inertia) const {
    const impact::ImpulseClosure& c = impact_.closure;
    return {{"ratio", figure(c.ratio)},
            {"inertia_factor_that_closes", figure(c.inertia_factor)},
            {"inertia_factor_given", inertia ? json(*inertia) : json(nullptr)},
            {"verdict", impact::to_string(c.verdict)},
            {"explanation", explain(c.verdict)}};
  }
  json fall() const {
    const double unit = si_ ? scale_.metre_per_px * scale_.fps * scale_.fps : kNotMeasured;
    json result = {{"measured_m_s2", figure(impact_.fall, unit)}};
    const double off = std::abs(impact_.fall.value * unit - kGravity_m_s2);
    const double allowed = 3 * impact_.fall.sd * unit + kFallTolerance * kGravity_m_s2;
    result["agrees_with_9_81"] = std::isfinite(off) ? json(off <= allowed) : json(nullptr);
    return result;
  }
  json length(const impact::Measured& m) const { return figure(m, length_); }
  json seconds(const impact::Measured& m) const {
    return figure(m, scale_.fps > 0 ? 1 / scale_.fps : kNotMeasured);
  }
  const char* units() const { return si_ ? "si" : "px_and_frames"; }

 private:
  const impact::ImpactAnalysis& impact_;
  const SiScale& scale_;
  double first_ = 0, step_ = 1, length_ = 1;
  bool si_ = false;
};

}  // namespace

impact::ImpactOptions impact_options(const SiScale& scale, const ImpactSetup& setup) {
  impact::ImpactOptions options;
  options.surface_angle_rad = scale.surface_angle_rad;
  options.gravity_angle_rad = setup.gravity_angle_rad;
  options.inertia_factor = setup.inertia_factor;
  if (scale.metre_per_px > 0 && scale.fps > 0) {
    options.gravity = kGravity_m_s2 / scale.metre_per_px / (scale.fps * scale.fps);
  }
  return options;
}

json describe_impact(const impact::ImpactAnalysis& impact, const std::vector<TrackRow>& rows,
                     const SiScale& scale, const ImpactSetup& setup) {
  json result = {{"found", impact.status == impact::ImpactStatus::found ||
                               impact.status == impact::ImpactStatus::not_resolved},
                 {"status", impact::to_string(impact.status)},
                 {"explanation", explain(impact.status)}};
  if (!result["found"].get<bool>()) return result;
  const ImpactWriter write(impact, rows, scale);
  result["units"] = write.units();
  result["t0"] = write.edge(impact.start);
  result["t_max_compression"] = write.instant(impact.turn);
  result["t_end"] = write.edge(impact.end);
  result["contact_frames"] = figure(impact.duration);
  result["contact_s"] = write.seconds(impact.duration);
  result["before"] = write.motion(impact.before);
  result["after"] = write.motion(impact.after);
  result["restitution"] = figure(impact.restitution);
  result["friction"] = {{"eq_3_12", figure(impact.friction_published)},
                        {"gravity_corrected", figure(impact.friction)},
                        {"rolling_cap", figure(impact.rolling_cap)}};
  result["max_deflection_px"] = figure(impact.max_deflection);
  result["max_deflection_m"] = write.length(impact.max_deflection);
  result["impulse_closure"] = write.closure(setup.inertia_factor);
  result["gravity"] = write.fall();
  result["centre_against_motion_px_per_frame"] = figure({impact.disagreement, 0})["value"];
  result["scatter_over_stated"] = {{"centre", figure({impact.position_scatter, 0})["value"]},
                                   {"motion", figure({impact.step_scatter, 0})["value"]}};
  return result;
}

std::string impact_in_a_line(const json& impact) {
  std::string line = impact["explanation"];
  if (!impact["found"].get<bool>()) return line;
  char text[160];
  const auto add = [&](const json& value, const char* key, const char* sd, const char* format) {
    if (value.is_null()) return;
    std::snprintf(text, sizeof text, format, value[key].get<double>(), value[sd].get<double>());
    line += text;
  };
  add(impact["t0"], "frame", "sd_frames", "; contact from frame %.2f +- %.2f");
  add(impact["t_end"], "frame", "sd_frames", " to %.2f +- %.2f");
  add(impact["restitution"], "value", "sd", "; restitution %.4f +- %.4f");
  add(impact["friction"]["gravity_corrected"], "value", "sd", "; friction %.4f +- %.4f");
  return line;
}

}  // namespace impactdic::report

#include "host/report/impact_json.h"

#include <impactdic/units.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/base/json_number.h"
#include "host/report/words.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

json figure(const Measured& m) {
  if (!std::isfinite(m.value)) return nullptr;
  return {{"value", m.value}, {"sd", json_number(m.sd)}};
}

// With the parts of the deviation that are not 0, and whether something contradicts it.
json figure(const ImpactFigures& impact, ImpactFigure which, const Measured& m) {
  json result = figure(m);
  if (result.is_null()) return result;
  const ErrorParts& parts = impact.budget(which);
  json& described = result["sd_parts"] = json::object();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] > 0) described[to_string(static_cast<ErrorSource>(i))] = parts[i];
  }
  result["status"] = impact.is_doubtful(which) ? "doubtful" : "ok";
  return result;
}

json instant(const ImpactInstant& at) {
  if (!at.known()) return nullptr;
  return {{"frame", at.frame},
          {"sd_frames", at.sd_frames},
          {"time_s", json_number(at.time_s)},
          {"sd_s", json_number(at.sd_s)}};
}

json edge(const ImpactInstant& at, const Measured& exponent, bool law_holds) {
  json result = instant(at);
  if (result.is_null()) return result;
  result["onset_exponent"] = figure(exponent);
  result["onset_law_holds"] = law_holds;
  return result;
}

// Of a sphere, about the surface's t and n.
void put_spins(const ImpactMotion& m, const std::string& rate, json& result) {
  if (!std::isfinite(m.spin_t.value)) return;
  result["omega_t" + rate] = figure(m.spin_t);
  result["omega_n" + rate] = figure(m.spin_n);
}

// A clip without an impact.
json flight(const ImpactMotion& m, bool in_si) {
  if (!m.known) return nullptr;
  const std::string unit = in_si ? "_m_s" : "_px_per_frame";
  const std::string rate = in_si ? "_rad_s" : "_rad_per_frame";
  json result = {{"frames_used", {m.first_frame, m.last_frame}},
                 {"vx" + unit, figure(m.vx)},
                 {"vy" + unit, figure(m.vy)},
                 {"vt" + unit, figure(m.vt)},
                 {"vn" + unit, figure(m.vn)},
                 {"omega" + rate, figure(m.spin)}};
  put_spins(m, rate, result);
  if (std::isfinite(m.vz.value)) result["vz" + unit] = figure(m.vz);
  return result;
}

// `first`: kVx… of the flight.
json motion(const ImpactFigures& impact, const ImpactMotion& m, ImpactFigure first) {
  if (!m.known) return nullptr;
  const std::string unit = impact.in_si ? "_m_s" : "_px_per_frame";
  auto next = static_cast<int>(first);
  json result = {{"frames_used", {m.first_frame, m.last_frame}}};
  for (const auto& [name, value] : {std::pair{"vx", m.vx}, std::pair{"vy", m.vy},
                                    std::pair{"vt", m.vt}, std::pair{"vn", m.vn}}) {
    result[name + unit] = figure(impact, static_cast<ImpactFigure>(next++), value);
  }
  const std::string rate = impact.in_si ? "_rad_s" : "_rad_per_frame";
  result["omega" + rate] = figure(impact, static_cast<ImpactFigure>(next), m.spin);
  put_spins(m, rate, result);
  if (std::isfinite(m.vz.value)) result["vz" + unit] = figure(m.vz);
  return result;
}

json contradictions(const ImpactFigures& impact) {
  json result = json::array();
  for (const Contradiction& c : impact.contradictions) {
    json figures = json::array();
    for (const ImpactFigure concerned : c.figures) figures.push_back(to_string(concerned));
    result.push_back({{"what", c.what}, {"message", c.message}, {"doubtful", figures}});
  }
  return result;
}

json closure(const ImpactFigures& impact) {
  const ImpulseClosure& c = impact.closure;
  return {{"ratio", figure(c.ratio)},
          {"inertia_factor_that_closes",
           figure(impact, ImpactFigure::kClosingInertia, c.inertia_factor)},
          {"inertia_factor_given",
           impact.inertia_factor ? json(*impact.inertia_factor) : json(nullptr)},
          {"verdict", to_string(c.verdict)},
          {"explanation", explain(c.verdict)}};
}

// What is missing or null stays as it is.
void read_number(const json& from, const std::string& pointer, double& to) {
  const json::json_pointer path(pointer);
  if (from.contains(path) && from.at(path).is_number()) to = from.at(path).get<double>();
}

void read_figure(const json& from, const std::string& pointer, Measured& to) {
  read_number(from, pointer + "/value", to.value);
  read_number(from, pointer + "/sd", to.sd);
}

void read_instant(const json& from, const std::string& pointer, ImpactInstant& to) {
  read_number(from, pointer + "/frame", to.frame);
  read_number(from, pointer + "/sd_frames", to.sd_frames);
  read_number(from, pointer + "/time_s", to.time_s);
  read_number(from, pointer + "/sd_s", to.sd_s);
}

void read_motion(const json& from, const std::string& pointer, ImpactMotion& to) {
  to.known = from.contains(json::json_pointer(pointer)) &&
             from.at(json::json_pointer(pointer)).is_object();
  read_figure(from, pointer + "/vx_m_s", to.vx);
  read_figure(from, pointer + "/vy_m_s", to.vy);
  read_figure(from, pointer + "/vt_m_s", to.vt);
  read_figure(from, pointer + "/vn_m_s", to.vn);
  read_figure(from, pointer + "/omega_rad_s", to.spin);
  read_figure(from, pointer + "/omega_t_rad_s", to.spin_t);
  read_figure(from, pointer + "/omega_n_rad_s", to.spin_n);
  read_figure(from, pointer + "/vz_m_s", to.vz);
}

template <typename Word, std::size_t n>
void read_word(const json& from, const std::string& pointer, const std::array<Word, n>& words,
               Word& to) {
  const json::json_pointer path(pointer);
  if (!from.contains(path)) return;
  for (const Word word : words) {
    if (from.at(path) == to_string(word)) to = word;
  }
}

void read_contradictions(const json& from, ImpactFigures& impact) {
  if (!from.contains("contradictions")) return;
  for (const json& one : from.at("contradictions")) {
    Contradiction read{one.at("what"), one.at("message"), {}};
    for (std::size_t i = 0; i < kImpactFigures; ++i) {
      const auto figure = static_cast<ImpactFigure>(i);
      for (const json& name : one.at("doubtful")) {
        if (name == to_string(figure)) read.figures.push_back(figure);
      }
    }
    impact.contradictions.push_back(std::move(read));
  }
}

Measured in_degrees(const Measured& rad) { return {rad.value * kDegPerRad, rad.sd * kDegPerRad}; }

// The spin as a vector, and as people say it: how fast, and how far its axis leans out of the
// line of sight.
json spin(const MeasuredVector& v, bool in_si) {
  const std::string unit = in_si ? "_rad_s" : "_rad_per_frame";
  json result = {{"omega_t" + unit, figure(v.t)},
                 {"omega_n" + unit, figure(v.n)},
                 {"omega_b" + unit, figure(v.b)}};
  const double size = std::hypot(v.t.value, v.n.value, v.b.value);
  if (!(size > 0)) return result;
  if (in_si) result["rpm"] = size * 30 / kPi;
  result["tilt_deg"] = std::atan2(std::hypot(v.t.value, v.n.value), v.b.value) * kDegPerRad;
  return result;
}

// What a sphere's impact does out of the picture's plane; null of a disc.
json space(const ImpactFigures& impact) {
  if (!impact.space) return nullptr;
  const SpaceImpact& s = *impact.space;
  const std::string speed = impact.in_si ? "_m_s" : "_px_per_frame";
  const std::string rate = impact.in_si ? "_rad_s" : "_rad_per_frame";
  return {{"spin_before", spin(s.spin_before, impact.in_si)},
          {"spin_after", spin(s.spin_after, impact.in_si)},
          {"slip_t" + speed, figure(s.slip_t)},
          {"slip_b" + speed, figure(s.slip_b)},
          {"friction_t", figure(s.friction_t)},
          {"friction_b", figure(s.friction_b)},
          {"friction", figure(s.friction)},
          {"friction_off_slip_deg", figure(in_degrees(s.friction_off_rad))},
          {"spin_change_n" + rate, figure(s.spin_change_n)}};
}

}  // namespace

json describe_impact(const ImpactFigures& impact) {
  json result = {{"found", impact.found()},
                 {"status", to_string(impact.status)},
                 {"explanation", explain(impact.status)}};
  result["contradictions"] = contradictions(impact);
  result["units"] = impact.in_si ? "si" : "px_and_frames";
  if (!impact.found()) {
    result["flight"] = flight(impact.flight, impact.in_si);
    return result;
  }
  result["t0"] = edge(impact.t0, impact.start_exponent, impact.start_law_holds);
  result["t_max_compression"] = instant(impact.t_max_compression);
  result["t_end"] = edge(impact.t_end, impact.end_exponent, impact.end_law_holds);
  result["contact_frames"] = figure(impact.contact_frames);
  result["contact_s"] = figure(impact, ImpactFigure::kContactDuration, impact.contact_s);
  result["before"] = motion(impact, impact.before, ImpactFigure::kVxBefore);
  result["after"] = motion(impact, impact.after, ImpactFigure::kVxAfter);
  result["restitution"] = figure(impact, ImpactFigure::kRestitution, impact.restitution);
  result["friction"] = {
      {"eq_3_12", figure(impact, ImpactFigure::kFrictionPublished, impact.friction_published)},
      {"gravity_corrected", figure(impact, ImpactFigure::kFriction, impact.friction)},
      {"rolling_cap", figure(impact, ImpactFigure::kRollingCap, impact.rolling_cap)}};
  result["max_deflection_px"] = figure(impact.max_deflection_px);
  result["max_deflection_m"] =
      figure(impact, ImpactFigure::kMaxDeflection, impact.max_deflection_m);
  result["impulse_closure"] = closure(impact);
  result["gravity"] = {
      {"measured_m_s2", figure(impact.gravity_m_s2)},
      {"agrees_with_9_81", impact.gravity_agrees ? json(*impact.gravity_agrees) : json(nullptr)}};
  result["gravity"]["direction_deg"] = figure(impact.gravity_angle_deg);
  result["surface_angle_found_deg"] = figure(impact.surface_angle_deg);
  result["centre_against_motion_px_per_frame"] =
      json_number(impact.centre_against_motion_px_per_frame);
  result["space"] = space(impact);
  result["scatter_over_stated"] = {{"centre", json_number(impact.centre_scatter)},
                                   {"motion", json_number(impact.motion_scatter)}};
  return result;
}

ImpactFigures read_impact(const json& described) {
  ImpactFigures impact;
  read_word(described, "/status",
            std::array{ImpactStatus::kFound, ImpactStatus::kNone, ImpactStatus::kWrongSide,
                       ImpactStatus::kFlightTooShort, ImpactStatus::kNotResolved},
            impact.status);
  read_word(described, "/impulse_closure/verdict",
            std::array{ClosureVerdict::kUndetermined, ClosureVerdict::kCloses,
                       ClosureVerdict::kSigns, ClosureVerdict::kLeverArm, ClosureVerdict::kScale},
            impact.closure.verdict);
  impact.in_si = described.value("units", "") == "si";
  read_instant(described, "/t0", impact.t0);
  read_instant(described, "/t_max_compression", impact.t_max_compression);
  read_instant(described, "/t_end", impact.t_end);
  read_figure(described, "/contact_s", impact.contact_s);
  read_motion(described, "/before", impact.before);
  read_motion(described, "/after", impact.after);
  read_figure(described, "/restitution", impact.restitution);
  read_figure(described, "/friction/eq_3_12", impact.friction_published);
  read_figure(described, "/friction/gravity_corrected", impact.friction);
  read_figure(described, "/friction/rolling_cap", impact.rolling_cap);
  read_figure(described, "/max_deflection_m", impact.max_deflection_m);
  read_figure(described, "/surface_angle_found_deg", impact.surface_angle_deg);
  read_contradictions(described, impact);
  return impact;
}

}  // namespace impactdic::report

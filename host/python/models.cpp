#include <impactdic/fit.h>
#include <impactdic/simulate.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "host/python/arrays.h"
#include "host/python/impact_job.h"
#include "host/python/job.h"
#include "host/python/jobs.h"
#include "host/python/options.h"

namespace nb = nanobind;

namespace impactdic::python {
namespace {

nb::dict pair_of(const Measured& measured) {
  nb::dict pair;
  pair["value"] = measured.value;
  pair["sd"] = measured.sd;
  return pair;
}

nb::dict state_of(const BodyState& state) {
  nb::dict values;
  values["qt_m"] = state.qt_m;
  values["qn_m"] = state.qn_m;
  values["angle_rad"] = state.angle_rad;
  values["vt_m_s"] = state.vt_m_s;
  values["vn_m_s"] = state.vn_m_s;
  values["omega_rad_s"] = state.omega_rad_s;
  values["qb_m"] = state.qb_m;
  values["vb_m_s"] = state.vb_m_s;
  values["omega_t_rad_s"] = state.omega_t_rad_s;
  values["omega_n_rad_s"] = state.omega_n_rad_s;
  return values;
}

nb::dict trajectory_of(const std::vector<TrajectoryPoint>& points) {
  nb::dict columns;
  const auto column = [&](const char* name, auto value_of) {
    std::vector<double> values;
    for (const TrajectoryPoint& point : points) values.push_back(value_of(point));
    columns[name] = to_numpy(std::move(values));
  };
  column("time_s", [](const auto& p) { return p.time_s; });
  column("qt_m", [](const auto& p) { return p.state.qt_m; });
  column("qn_m", [](const auto& p) { return p.state.qn_m; });
  column("angle_rad", [](const auto& p) { return p.state.angle_rad; });
  column("vt_m_s", [](const auto& p) { return p.state.vt_m_s; });
  column("vn_m_s", [](const auto& p) { return p.state.vn_m_s; });
  column("omega_rad_s", [](const auto& p) { return p.state.omega_rad_s; });
  column("qb_m", [](const auto& p) { return p.state.qb_m; });
  column("vb_m_s", [](const auto& p) { return p.state.vb_m_s; });
  column("omega_t_rad_s", [](const auto& p) { return p.state.omega_t_rad_s; });
  column("omega_n_rad_s", [](const auto& p) { return p.state.omega_n_rad_s; });
  column("normal_force_n", [](const auto& p) { return p.normal_force_n; });
  column("tangential_force_n", [](const auto& p) { return p.tangential_force_n; });
  column("deflection_m", [](const auto& p) { return p.deflection_m; });
  column("flattening_m", [](const auto& p) { return p.state.flattening_m; });
  column("outline_lag_m", [](const auto& p) { return p.state.outline_lag_m; });
  return columns;
}

// {outcome: {input: derivative}}; NaN where there is none.
nb::dict derivatives_of(const ImpactDerivatives& d) {
  nb::dict outcomes;
  for (std::size_t r = 0; r < d.outcomes.size(); ++r) {
    nb::dict inputs;
    for (std::size_t c = 0; c < d.inputs.size(); ++c) {
      inputs[d.inputs[c].c_str()] = d.values[r * d.inputs.size() + c];
    }
    outcomes[d.outcomes[r].c_str()] = inputs;
  }
  return outcomes;
}

nb::dict outcome_of(const ImpactResult& impact) {
  nb::dict outcome;
  outcome["separated"] = impact.separated;
  outcome["start"] = state_of(impact.start);
  outcome["final"] = state_of(impact.final);
  const std::pair<const char*, double> figures[] = {
      {"contact_start_s", impact.contact_start_s},
      {"contact_s", impact.contact_s},
      {"t_max_compression_s", impact.t_max_compression_s},
      {"max_deflection_m", impact.max_deflection_m},
      {"max_flattening_m", impact.max_flattening_m},
      {"max_force_n", impact.max_force_n},
      {"peak_force_n", impact.peak_force_n},
      {"restitution", impact.restitution},
      {"impulse_t_n_s", impact.impulse_t_n_s},
      {"impulse_n_n_s", impact.impulse_n_n_s},
      {"impulse_b_n_s", impact.impulse_b_n_s}};
  for (const auto& [name, value] : figures) outcome[name] = value;
  nb::list phases;
  for (const ContactPhase& phase : impact.phases) {
    nb::dict facts;
    facts["name"] = phase.name;
    facts["start_s"] = phase.start_s;
    facts["end_s"] = phase.end_s;
    phases.append(facts);
  }
  outcome["phases"] = phases;
  outcome["warnings"] = nb::cast(impact.warnings);
  outcome["trajectory"] = trajectory_of(impact.trajectory);
  if (impact.derivatives) outcome["derivatives"] = derivatives_of(*impact.derivatives);
  return outcome;
}

nb::dict simulate_impact(const nb::dict& job, double rate_hz, std::vector<double> times_s,
                         bool derivatives) {
  SimulateRequest request;
  request.impact = impact_job(job);
  request.rate_hz = rate_hz;
  request.times_s = std::move(times_s);
  request.derivatives = derivatives;
  Job running({nb::none(), nb::none()});
  ImpactResult result;
  running.run([&](const RunControl&) { result = simulate(request); });
  return outcome_of(result);
}

FitParameter parameter_of(const std::string& key, NormalModel normal) {
  for (int k = 0; k <= static_cast<int>(kLastFitParameter); ++k) {
    if (key_of(static_cast<FitParameter>(k), normal) == key) return static_cast<FitParameter>(k);
  }
  throw InvalidArgument("'" + key + "' is not known", "parameters");
}

FitRequest read_request(const nb::list& tracks, const nb::dict& job, const nb::dict& options) {
  FitRequest request;
  request.impact = impact_job(job);
  OptionReader reader(options);
  std::vector<std::string> parameters, unknowns;
  std::string method;
  reader("parameters", parameters);
  reader("unknowns", unknowns);
  reader("method", method);
  reader("rivals", request.rivals);
  reader("flight_frames", request.flight_frames);
  reader("outlier_sd", request.outlier_sd);
  reader("scale_sd", request.scale_sd);
  reader("rate_sd", request.rate_sd);
  reader("threads", request.threads);
  std::optional<double> angle;
  reader("surface_angle_deg", angle);
  reader.finish("fit");
  if (method == "restitution_duration") {
    request.method = FitMethod::kRestitutionDuration;
  } else if (!method.empty() && method != "trajectory") {
    throw InvalidArgument("'" + method + "' is not known", "method",
                          "trajectory or restitution_duration");
  }
  for (const std::string& key : parameters) {
    request.parameters.push_back(parameter_of(key, request.impact.normal));
  }
  if (!unknowns.empty()) request.unknowns.clear();
  for (const std::string& key : unknowns) {
    request.unknowns.push_back(parameter_of(key, request.impact.normal));
  }
  for (const nb::handle track : tracks) {
    FitShot shot;
    shot.track = nb::cast<nb::str>(track).c_str();
    if (angle) shot.surface_angle_deg = *angle;
    request.shots.push_back(shot);
  }
  return request;
}

nb::list parameters_of(const std::vector<ParameterEstimate>& parameters) {
  nb::list list;
  for (const ParameterEstimate& parameter : parameters) {
    nb::dict facts;
    facts["parameter"] = parameter.key;
    facts["value"] = parameter.value;
    facts["sd"] = parameter.sd;
    facts["ci95_low"] = parameter.ci95_low;
    facts["ci95_high"] = parameter.ci95_high;
    facts["determined"] = parameter.determined;
    facts["verdict"] = parameter.verdict;
    list.append(facts);
  }
  return list;
}

nb::list rivals_of(const ShotFit& shot) {
  nb::list list;
  for (const RivalFit& rival : shot.rivals) {
    nb::dict facts;
    facts["normal"] = std::string(name_of(rival.normal));
    facts["friction"] = std::string(name_of(rival.friction));
    facts["restitution_damping"] = std::string(name_of(rival.restitution_damping));
    facts["shell"] = rival.shell;
    facts["chi_square"] = rival.chi_square;
    facts["p_value"] = rival.p_value;
    facts["aicc"] = rival.aicc;
    facts["above_best"] = rival.above_best;
    list.append(facts);
  }
  return list;
}

nb::dict shot_of(const ShotFit& shot) {
  nb::dict facts;
  facts["file"] = shot.shot.file;
  facts["restitution"] = pair_of(shot.shot.restitution);
  facts["contact_s"] = pair_of(shot.shot.contact_s);
  facts["parameters"] = parameters_of(shot.parameters);
  facts["rivals"] = rivals_of(shot);
  facts["chi_square"] = shot.chi_square;
  facts["reduced_chi_square"] = shot.reduced_chi_square;
  facts["p_value"] = shot.p_value;
  facts["aic"] = shot.aic;
  facts["adequate"] = shot.adequacy == Adequacy::kNotTested
                          ? nb::none()
                          : nb::cast(shot.adequacy == Adequacy::kAdequate);
  facts["rms_m"] = shot.rms_m;
  facts["converged"] = shot.converged;
  facts["warnings"] = nb::cast(shot.warnings);
  return facts;
}

nb::dict fit_tracks(const nb::list& tracks, const nb::dict& impact, const nb::dict& options,
                    nb::object progress) {
  const FitRequest request = read_request(tracks, impact, options);
  Job job({std::move(progress), nb::none()});
  FitResult result;
  job.run([&](const RunControl& control) { result = fit(request, control); });
  nb::dict outcome;
  nb::list shots, pooled;
  for (const ShotFit& shot : result.shots) shots.append(shot_of(shot));
  for (const PooledEstimate& estimate : result.pooled) {
    nb::dict facts;
    facts["parameter"] = estimate.key;
    facts["value"] = estimate.value;
    facts["sd"] = estimate.sd;
    facts["mean"] = estimate.mean;
    facts["scatter_sd"] = estimate.scatter_sd;
    facts["between_sd"] = estimate.between_sd;
    facts["determined"] = estimate.determined;
    facts["outliers"] = nb::cast(estimate.outliers);
    pooled.append(facts);
  }
  outcome["shots"] = shots;
  outcome["pooled"] = pooled;
  outcome["cancelled"] = result.cancelled;
  return outcome;
}

}  // namespace

void bind_models(nb::module_& module) {
  module.def("simulate", &simulate_impact, nb::arg("job"), nb::arg("rate_hz"), nb::arg("times_s"),
             nb::arg("derivatives"));
  module.def("fit", &fit_tracks, nb::arg("tracks"), nb::arg("impact"), nb::arg("options"),
             nb::arg("progress").none());
}

}  // namespace impactdic::python

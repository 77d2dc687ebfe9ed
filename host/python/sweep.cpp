#include <impactdic/models/sweep.h>
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

SweepAxis axis_of(const std::string& key, const SweepModel& model) {
  std::string list;
  for (int k = 0; k <= static_cast<int>(SweepAxis::kTangentialRestitution); ++k) {
    const auto axis = static_cast<SweepAxis>(k);
    if (!has_axis(model, axis)) continue;
    if (key_of(axis, model) == key) return axis;
    list += (list.empty() ? "" : ", ") + key_of(axis, model);
  }
  throw InvalidArgument("nothing of this name can be swept in this model", key, "one of " + list);
}

// Columns of sweep.csv, one value a shot, the last axis the fastest.
nb::dict columns_of(const std::vector<SweepShot>& shots) {
  nb::dict columns;
  const auto column = [&](const char* name, auto value_of) {
    std::vector<double> values;
    values.reserve(shots.size());
    for (const SweepShot& shot : shots) values.push_back(value_of(shot));
    columns[name] = to_numpy(std::move(values));
  };
  column("vt_before_m_s", [](const SweepShot& s) { return s.before.vt_m_s; });
  column("vn_before_m_s", [](const SweepShot& s) { return s.before.vn_m_s; });
  column("omega_before_rad_s", [](const SweepShot& s) { return s.before.omega_rad_s; });
  column("vt_after_m_s", [](const SweepShot& s) { return s.after.vt_m_s; });
  column("vn_after_m_s", [](const SweepShot& s) { return s.after.vn_m_s; });
  column("omega_after_rad_s", [](const SweepShot& s) { return s.after.omega_rad_s; });
  column("vb_after_m_s", [](const SweepShot& s) { return s.after.vb_m_s; });
  column("omega_t_after_rad_s", [](const SweepShot& s) { return s.after.omega_t_rad_s; });
  column("omega_n_after_rad_s", [](const SweepShot& s) { return s.after.omega_n_rad_s; });
  column("restitution", [](const SweepShot& s) { return s.restitution; });
  column("tangential_restitution", [](const SweepShot& s) { return s.tangential_restitution; });
  column("friction", [](const SweepShot& s) { return s.friction; });
  column("rolling_cap", [](const SweepShot& s) { return s.rolling_cap; });
  column("contact_s", [](const SweepShot& s) { return s.contact_s; });
  column("max_deflection_m", [](const SweepShot& s) { return s.max_deflection_m; });
  column("max_force_n", [](const SweepShot& s) { return s.max_force_n; });
  column("kinetic_before_j", [](const SweepShot& s) { return s.kinetic_before_j; });
  column("lost", [](const SweepShot& s) { return s.lost; });
  std::vector<std::int8_t> status;
  std::vector<std::string> phases, reasons;
  for (const SweepShot& shot : shots) {
    status.push_back(static_cast<std::int8_t>(shot.status));
    phases.push_back(shot.phases);
    reasons.push_back(shot.reason);
  }
  columns["status"] = to_numpy(std::move(status));
  columns["phases"] = nb::cast(phases);
  columns["reason"] = nb::cast(reasons);
  return columns;
}

// `axes`: (key, values) of each, the first varies slowest.
nb::dict sweep_models(const nb::dict& job, const nb::list& axes, int threads, nb::object progress) {
  SweepRequest request;
  ImpactJob impact = impact_job(job);
  request.threads = threads;
  for (const nb::handle pair : axes) {
    const auto key = nb::cast<std::string>(pair[0]);
    // Along the normal, unless the job says otherwise: as in a job file.
    if (key == "speed_m_s" && impact.initial.vt_m_s == 0 && impact.initial.vn_m_s == 0) {
      impact.initial.vn_m_s = -1;
    }
  }
  request.model = impact;
  for (const nb::handle pair : axes) {
    request.axes.push_back({axis_of(nb::cast<std::string>(pair[0]), request.model),
                            nb::cast<std::vector<double>>(pair[1])});
  }
  Job running({std::move(progress), nb::none()});
  SweepResult result;
  running.run([&](const RunControl& control) { result = sweep(request, control); });
  nb::dict outcome;
  outcome["columns"] = columns_of(result.shots);
  outcome["cancelled"] = result.cancelled;
  return outcome;
}

}  // namespace

void bind_sweep(nb::module_& module) {
  module.def("sweep", &sweep_models, nb::arg("job"), nb::arg("axes"), nb::arg("threads"),
             nb::arg("progress").none());
}

}  // namespace impactdic::python

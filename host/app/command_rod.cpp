// impactdic rod MARKERS.csv -o DIR: a rod's impact from three markers (chapter 5).
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/rod_output.h"
#include "sim/fit/parallel.h"

namespace impactdic::app {
namespace {

struct Request {
  Common common;
  std::string markers, output, vertical = "y", deformations;
  sim::rod::RodJob rod;
  double young_pa = 200e9, flat_young_pa = 200e9, gravity_m_s2 = 9.81, centre_offset_m = 0;
};

sim::rod::RodMeasureOptions measure_options(const Request& request) {
  sim::rod::RodMeasureOptions options;
  options.body = request.rod.body;
  options.friction_kinetic = request.rod.friction_kinetic;
  options.gravity_m_s2 = request.gravity_m_s2;
  options.centre_offset_m = request.centre_offset_m;
  const std::string& axis = request.vertical;
  options.vertical_down = axis.size() == 2;
  options.vertical_axis = static_cast<std::size_t>(axis.back() - 'x');
  return options;
}

// Both presets with the user's rod and flat.
std::vector<std::pair<std::string, sim::rod::RodJob>> models(const Request& request) {
  std::vector<std::pair<std::string, sim::rod::RodJob>> jobs{
      {"rigid_rod", sim::rod::rigid_rod_preset()},
      {"flexible_rod", sim::rod::flexible_rod_preset()}};
  for (auto& [name, job] : jobs) {
    const int axial = job.axial_modes, bending = job.bending_modes;
    const sim::contact::ResidualLaw residual = job.residual;
    job = request.rod;
    job.axial_modes = axial, job.bending_modes = bending, job.residual = residual;
    job.body.young_pa = request.young_pa;
    job.gravity_m_s2 = request.gravity_m_s2;
    job.surface.radius_m = job.body.radius_m;
    job.surface.effective_modulus_pa = sim::contact::effective_modulus_pa(
        request.young_pa, job.surface.poisson, request.flat_young_pa, job.surface.poisson);
  }
  return jobs;
}

std::vector<RodPrediction> predict(const Request& request, const sim::rod::RodMeasurement& m) {
  std::vector<RodPrediction> predictions;
  for (auto& [name, job] : models(request)) {
    job.angle_rad = m.before.angle_rad.value;
    job.vt_m_s = m.before.vt_m_s.value;
    job.vn_m_s = m.before.vn_m_s.value;
    job.omega_rad_s = m.before.omega_rad_s.value;
    predictions.push_back({name, sim::rod::simulate_rod(job)});
  }
  return predictions;
}

std::vector<DeformationComparison> compare_deformations(const Request& request) {
  const auto rows = sim::rod::read_deformations(request.deformations);
  std::vector<DeformationComparison> compared(rows.size());
  sim::fit::parallel_for(rows.size(), request.common.session.threads, [&](std::size_t i) {
    compared[i].measured = rows[i];
    for (auto& [name, job] : models(request)) {
      job.angle_rad = rows[i].angle_deg * kRadPerDeg;
      job.vn_m_s = -rows[i].speed_m_s;
      (name == "rigid_rod" ? compared[i].rigid_m : compared[i].flexible_m) =
          sim::rod::simulate_rod(job).residual_m;
    }
  });
  return compared;
}

void print(const sim::rod::RodMeasurement& m, const std::vector<RodPrediction>& predictions) {
  std::printf("impact at %.5f s, angle %.2f deg; restitution at the contact point %.4f +- %.4f\n",
              m.impact_s.value, m.before.angle_rad.value * kDegPerRad, m.restitution.value,
              m.restitution.sd);
  const auto row = [](const char* name, double vt, double vn, double omega) {
    std::printf("  %-14s vt %8.4f  vn %8.4f m/s  omega %9.3f rad/s\n", name, vt, vn, omega);
  };
  row("before", m.before.vt_m_s.value, m.before.vn_m_s.value, m.before.omega_rad_s.value);
  row("after", m.after.vt_m_s.value, m.after.vn_m_s.value, m.after.omega_rad_s.value);
  for (const RodPrediction& p : predictions) {
    row(p.model.c_str(), p.impact.vt_m_s, p.impact.vn_m_s, p.impact.omega_rad_s);
  }
  std::printf("  free fall %.4f +- %.4f m/s2; impulses give omega %.3f rad/s after, |Jt|/Jn %.3f\n",
              m.before.gravity_m_s2.value, m.before.gravity_m_s2.sd,
              m.closure.omega_as_measured_rad_s.value, m.closure.impulse_ratio.value);
  if (m.closure.tangential_sign < 0) {
    std::printf("  the impulses close only with the tangential axis flipped (omega %.3f)\n",
                m.closure.omega_axis_flipped_rad_s.value);
  }
}

void run_rod(const CLI::App& command, const Request& request) {
  for (const auto& [name, job] : models(request)) {
    sim::rod::RodJob probe =
        job;  // the materials, before any work: speed and angle come from the markers
    probe.angle_rad = 1, probe.vn_m_s = -1;
    probe.validate();
  }
  const sim::rod::RodMeasurement measurement =
      sim::rod::measure_rod(sim::rod::read_markers(request.markers), measure_options(request));
  const auto predictions = predict(request, measurement);
  std::vector<DeformationComparison> deformations;
  if (!request.deformations.empty()) deformations = compare_deformations(request);

  const auto folder = prepare_output_directory(request.output, request.common.force);
  write_rod_motion(folder / "motion.csv", measurement);
  write_rod_summary(folder / "summary.json", request.markers, measure_options(request), measurement,
                    predictions);
  if (!deformations.empty()) write_deformations(folder / "deformation.csv", deformations);
  write_job(command, folder / "job.toml");
  if (!request.common.quiet) print(measurement, predictions);
  for (const std::string& warning : measurement.warnings) {
    std::fprintf(stderr, "impactdic: warning: %s\n", warning.c_str());
  }
}

void add_options(CLI::App& command, Request& r) {
  const auto number = [&](const char* name, double& value, const char* text) {
    command.add_option(name, value, text)->capture_default_str();
  };
  command.add_option("MARKERS", r.markers, "Table time_s,x1_m,y1_m,z1_m,x2_m,...,z3_m")->required();
  command.add_option("-o,--output", r.output, "Folder for the results")->required();
  command.add_option("--vertical", r.vertical, "Which axis of the table points up: x y z -x -y -z")
      ->check(CLI::IsMember({"x", "y", "z", "-x", "-y", "-z"}))
      ->capture_default_str();
  number("--length-m", r.rod.body.length_m, "Length of the rod");
  number("--radius-m", r.rod.body.radius_m, "Radius of the rod and of its round end");
  number("--mass-kg", r.rod.body.mass_kg, "Mass of the rod");
  number("--centre-offset-m", r.centre_offset_m, "Centre of mass from marker 2, towards marker 3");
  number("--friction", r.rod.friction_kinetic, "Coefficient of friction");
  number("--young-pa", r.young_pa, "Young's modulus of the rod");
  number("--flat-young-pa", r.flat_young_pa, "Young's modulus of the flat");
  number("--poisson", r.rod.surface.poisson, "Poisson's ratio of both");
  number("--yield-strength-pa", r.rod.surface.yield_strength_pa, "Yield strength of the weaker");
  number("--modal-damping", r.rod.modal_damping, "Fraction of critical, every mode");
  number("--gravity-m-s2", r.gravity_m_s2, "Gravity of the place");
  command.add_option("--deformations", r.deformations,
                     "Permanent-deformation table angle_deg,speed_m_s,depth_m[,depth_sd_m]");
  add_common_options(command, r.common);
}

}  // namespace

void add_rod_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("rod", "Impact of a rod from three markers");
  auto request = std::make_shared<Request>();
  add_options(*command, *request);
  command->footer(
      "Marker 1 sits near the struck end, 2 at the centre of mass, 3 near the upper end; a marker\n"
      "out of sight is left empty. The defaults are the steel rod of the source, chapter 5.\n"
      "Writes motion.csv, summary.json, job.toml (and deformation.csv).\n"
      "Example:\n  impactdic rod drop_45.csv -o drop_45 --vertical z");
  command->callback([command, request] { run_rod(*command, *request); });
}

}  // namespace impactdic::app

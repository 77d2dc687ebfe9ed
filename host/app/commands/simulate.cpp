// impactdic simulate JOB.toml -o DIR: integrate an impact model.
#include <impactdic/error.h>
#include <impactdic/simulate.h>

#include <cstdio>

#include "host/app/command.h"
#include "host/app/job_command.h"
#include "host/report/job/sweep_files.h"
#include "sim/job/job_toml.h"
#include "sim/job/rebound_job.h"
#include "sim/job/result_files.h"
#include "sim/rod/rod_job.h"
#include "sim/sweep/sweep_job.h"

namespace impactdic::app {
namespace {

ImpactResult integrate(const SimulateRequest& request, const std::string& file) {
  try {
    return simulate(request);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), file + ": " + error.where(), error.hint());
  }
}

void print(const ImpactJob& job, const ImpactResult& result) {
  std::printf("restitution %.4f, contact %.4f ms, maximum deflection %.4f mm\n", result.restitution,
              1e3 * result.contact_s, 1e3 * result.max_deflection_m);
  const auto motion = [](const char* whose, const BodyState& s, bool plane) {
    std::printf("%s: vt %.4f m/s, vn %.4f m/s, omega %.3f rad/s\n", whose, s.vt_m_s, s.vn_m_s,
                s.omega_rad_s);
    if (plane) return;
    std::printf("  across: vb %.4f m/s, omega_t %.3f rad/s, omega_n %.3f rad/s\n", s.vb_m_s,
                s.omega_t_rad_s, s.omega_n_rad_s);
  };
  const bool plane = job.initial.plane() && (!job.other || job.other->initial.plane());
  motion("after", result.final, plane);
  if (job.other) motion("the other after", result.other_final, plane);
  for (const ContactPhase& phase : result.phases) {
    std::printf("  %-16s %9.4f to %9.4f ms\n", phase.name, 1e3 * phase.start_s, 1e3 * phase.end_s);
  }
}

void run_rod_simulation(const JobOptions& options) {
  const RodModel job = sim::rod::read_rod_job(options.job);
  const RodImpact impact = simulate(job.rod);
  const auto dir = prepare_output_directory(options.output, options.force);
  sim::rod::write_rod_trajectory(dir / "trajectory.csv", impact);
  sim::job::write_text(dir / "summary.json", sim::rod::rod_summary_json(job, impact));
  sim::job::write_text(dir / "job.toml", sim::rod::to_toml(job));
  if (!options.quiet) {
    std::printf("restitution %.4f, %d micro-impacts in %.4f ms, dent %.2f um\n", impact.restitution,
                impact.micro_impacts, 1e3 * impact.start_to_end_s, 1e6 * impact.residual_m);
    std::printf("after: vt %.4f m/s, vn %.4f m/s, omega %.3f rad/s\n", impact.vt_m_s, impact.vn_m_s,
                impact.omega_rad_s);
  }
  print_warnings(impact.warnings);
}

void run_formula(const JobOptions& options) {
  const ReboundJob job = sim::job::read_rebound_job(options.job);
  const ReboundResult result = simulate(job);
  const auto dir = prepare_output_directory(options.output, options.force);
  sim::job::write_rebound_trajectory(dir / "trajectory.csv", result);
  sim::job::write_text(dir / "summary.json", sim::job::rebound_summary_json(job, result));
  sim::job::write_text(dir / "job.toml", sim::job::to_toml(job));
  if (!options.quiet) {
    std::printf("restitution %.4f\n", result.restitution);
    std::printf("after: vt %.4f m/s, vn %.4f m/s, omega %.3f rad/s\n", result.after.vt_m_s,
                result.after.vn_m_s, result.after.omega_rad_s);
  }
  print_warnings(result.warnings);
}

void run_sweep(const JobOptions& options) {
  const auto result = run_job<SweepRequest, SweepResult>(
      options, {sim::sweep::read_sweep_job, sweep, report::write_sweep, sim::sweep::to_toml,
                [](const auto& r) { std::fputs(report::sweep_words(r).c_str(), stdout); }});
  print_warnings(report::sweep_warnings(result));
}

void run_simulate(const JobOptions& options) {
  if (sim::sweep::is_sweep_job(options.job)) return run_sweep(options);
  const std::string model = sim::job::model_of_job(options.job);
  if (is_rebound_model(model)) return run_formula(options);
  if (model == "rigid_rod" || model == "flexible_rod") return run_rod_simulation(options);
  const SimulateRequest job = sim::job::read_simulate_job(options.job);
  const ImpactResult result = integrate(job, options.job);
  const auto dir = prepare_output_directory(options.output, options.force);
  sim::job::write_trajectory_csv(dir / "trajectory.csv", job.impact, result.trajectory);
  sim::job::write_text(dir / "summary.json", sim::job::summary_json(job.impact, result));
  sim::job::write_text(dir / "job.toml", sim::job::to_toml(job));
  if (!options.quiet) print(job.impact, result);
  print_warnings(result.warnings);
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  add_job_command(app,
                  {.name = "simulate",
                   .description = "Integrate an impact model, or a sweep of them",
                   .job_help = "The job, a TOML file (docs/models.md)",
                   .footer = "Example:\n  impactdic simulate sim/jobs/racket_15.toml -o racket_15",
                   .threads = true},
                  run_simulate);
}

}  // namespace impactdic::app

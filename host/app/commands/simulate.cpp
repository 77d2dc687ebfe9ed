// impactdic simulate JOB.toml -o DIR: integrate an impact model.
#include <impactdic/error.h>
#include <impactdic/simulate.h>

#include <cstdio>

#include "host/app/command.h"
#include "host/app/job_command.h"
#include "host/report/job/sweep_files.h"
#include "host/report/words/model_words.h"
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

template <typename... Results>
void print(const JobOptions& options, const Results&... results) {
  if (!options.quiet) std::fputs(report::in_words(results...).c_str(), stdout);
}

void run_rod_simulation(const JobOptions& options) {
  const RodModel job = sim::rod::read_rod_job(options.job);
  const RodImpact impact = simulate(job.rod);
  const auto dir = prepare_output_directory(options.output, options.force);
  sim::rod::write_rod_trajectory(dir / "trajectory.csv", impact);
  sim::job::write_text(dir / "summary.json", sim::rod::rod_summary_json(job, impact));
  sim::job::write_text(dir / "job.toml", sim::rod::to_toml(job));
  print(options, impact);
  print_warnings(impact.warnings);
}

void run_formula(const JobOptions& options) {
  const ReboundJob job = sim::job::read_rebound_job(options.job);
  const ReboundResult result = simulate(job);
  const auto dir = prepare_output_directory(options.output, options.force);
  sim::job::write_rebound_trajectory(dir / "trajectory.csv", result);
  sim::job::write_text(dir / "summary.json", sim::job::rebound_summary_json(job, result));
  sim::job::write_text(dir / "job.toml", sim::job::to_toml(job));
  print(options, result);
  print_warnings(result.warnings);
}

void run_sweep(const JobOptions& options) {
  const auto result = run_job<SweepRequest, SweepResult>(
      options, {sim::sweep::read_sweep_job, sweep, report::write_sweep, sim::sweep::to_toml,
                report::sweep_words});
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
  if (result.derivatives) {
    sim::job::write_derivatives_csv(dir / "derivatives.csv", *result.derivatives);
  }
  sim::job::write_text(dir / "summary.json", sim::job::summary_json(job.impact, result));
  sim::job::write_text(dir / "job.toml", sim::job::to_toml(job));
  print(options, job.impact, result);
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

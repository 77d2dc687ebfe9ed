// impactdic simulate JOB.toml -o DIR: integrate an impact model.
#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/base/error.h"
#include "sim/impact/impact.h"
#include "sim/impact/job_toml.h"
#include "sim/impact/result_files.h"
#include "sim/rod/rod_job.h"

namespace impactdic::app {
namespace {

struct Options {
  std::string job, output;
  bool force = false, quiet = false;
};

constexpr double kDefaultRows = 200;

ImpactResult integrate(const SimulateJob& job, const std::string& file) {
  try {
    double rate_hz = job.rate_hz;
    if (rate_hz == 0) {
      const ImpactResult first = simulate_impact(job.impact);
      const double span_s = first.separated ? first.contact_s : first.phases.back().end_s;
      rate_hz = kDefaultRows / span_s;
    }
    return simulate_impact(job.impact, {.rate_hz = rate_hz});
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), file + ": " + error.where(), error.hint());
  }
}

void print(const ImpactResult& result) {
  std::printf("restitution %.4f, contact %.4f ms, maximum deflection %.4f mm\n", result.restitution,
              1e3 * result.contact_s, 1e3 * result.max_deflection_m);
  std::printf("after: vt %.4f m/s, vn %.4f m/s, omega %.3f rad/s\n", result.final.vt_m_s,
              result.final.vn_m_s, result.final.omega_rad_s);
  for (const Phase& phase : result.phases) {
    std::printf("  %-16s %9.4f to %9.4f ms\n", phase.name, 1e3 * phase.start_s, 1e3 * phase.end_s);
  }
}

void run_rod_simulation(const Options& options) {
  const RodJobFile job = read_rod_job(options.job);
  const RodImpact impact = simulate_rod(job.rod);
  const auto dir = prepare_output_directory(options.output, options.force);
  write_rod_trajectory(dir / "trajectory.csv", impact);
  write_text(dir / "summary.json", rod_summary_json(job, impact));
  write_text(dir / "job.toml", to_toml(job));
  if (!options.quiet) {
    std::printf("restitution %.4f, %d micro-impacts in %.4f ms, dent %.2f um\n", impact.restitution,
                impact.micro_impacts, 1e3 * impact.start_to_end_s, 1e6 * impact.residual_m);
    std::printf("after: vt %.4f m/s, vn %.4f m/s, omega %.3f rad/s\n", impact.vt_m_s, impact.vn_m_s,
                impact.omega_rad_s);
  }
  for (const std::string& warning : impact.warnings) {
    std::fprintf(stderr, "impactdic: warning: %s\n", warning.c_str());
  }
}

void run_simulate(const Options& options) {
  if (is_rod_job(options.job)) return run_rod_simulation(options);
  const SimulateJob job = read_simulate_job(options.job);
  const ImpactResult result = integrate(job, options.job);
  const auto dir = prepare_output_directory(options.output, options.force);
  write_trajectory_csv(dir / "trajectory.csv", result.trajectory);
  write_text(dir / "summary.json", summary_json(job.impact, result));
  write_text(dir / "job.toml", to_toml(job));
  if (!options.quiet) print(result);
  for (const std::string& warning : result.warnings) {
    std::fprintf(stderr, "impactdic: warning: %s\n", warning.c_str());
  }
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("simulate", "Integrate an impact model");
  auto options = std::make_shared<Options>();
  command->add_option("JOB", options->job, "The job, a TOML file (docs/models.md)")->required();
  command->add_option("-o,--output", options->output, "Folder for the results")->required();
  command->add_flag("--force", options->force, "Write into a folder that already holds files");
  command->add_flag("-q,--quiet", options->quiet, "Print errors and warnings only");
  command->footer("Example:\n  impactdic simulate sim/jobs/racket_15.toml -o racket_15");
  command->callback([options] { run_simulate(*options); });
}

}  // namespace impactdic::app

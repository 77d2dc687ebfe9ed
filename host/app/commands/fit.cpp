// impactdic fit JOB.toml -o DIR: calibrate a model's parameters on measured tracks.
#include <impactdic/fit.h>

#include <cmath>
#include <cstdio>

#include "host/app/job_command.h"
#include "host/report/job/fit_files.h"
#include "sim/fit/fit_job.h"

namespace impactdic::app {
namespace {

void print_goodness(const ShotFit& fit) {
  if (fit.adequacy == Adequacy::kNotTested) return;
  std::printf("chi square / freedom   %.4g, p %.2g: %s\n", fit.reduced_chi_square, fit.p_value,
              fit.adequacy == Adequacy::kAdequate ? "adequate" : "INADEQUATE");
  for (const RivalFit& rival : fit.rivals) {
    std::printf("  %-20s %-10s %-18s AICc above the best %.4g\n",
                std::string(name_of(rival.normal)).c_str(),
                std::string(name_of(rival.friction)).c_str(),
                std::string(name_of(rival.restitution_damping)).c_str(), rival.above_best);
  }
}

void print(const FitResult& result) {
  if (result.shots.size() == 1) {
    for (const ParameterEstimate& p : result.shots[0].parameters) {
      std::printf("%-22s %.6g +- %.2g  95 %% in [%.6g, %.6g]%s%s\n", p.key.c_str(), p.value, p.sd,
                  p.ci95_low, p.ci95_high,
                  p.determined ? "" : "  NOT DETERMINED: ", p.determined ? "" : p.verdict.c_str());
    }
    print_goodness(result.shots[0]);
    return;
  }
  for (const PooledEstimate& p : result.pooled) {
    // The published grid gives no deviations to weigh by: its mean is all there is.
    if (!std::isnan(p.value)) {
      std::printf("%-22s pooled %.6g +- %.2g, between shots %.2g\n", p.key.c_str(), p.value, p.sd,
                  p.between_sd);
    }
    std::printf("%-22s mean of %zu shots %.6g, scatter %.2g\n", p.key.c_str(), result.shots.size(),
                p.mean, p.scatter_sd);
    print_warnings(p.warnings);
    for (const std::string& file : p.outliers) std::printf("  outlier: %s\n", file.c_str());
  }
}

void run_fit(const JobOptions& options) {
  const auto result = run_job<FitRequest, FitResult>(
      options, {sim::fit::read_fit_job, fit, report::write_fit, sim::fit::to_toml, print});
  for (const ShotFit& shot : result.shots) print_warnings(shot.warnings, shot.shot.file);
}

}  // namespace

void add_fit_command(CLI::App& app) {
  add_job_command(
      app,
      {.name = "fit",
       .description = "Calibrate a model's parameters on measured tracks",
       .job_help = "The job, a TOML file (docs/calibration.md)",
       .footer =
           "Writes summary.json, parameters.csv, job.toml; published_grid also errors_N.csv.\n"
           "Example:\n  impactdic fit racket.toml -o racket_fit",
       .threads = true},
      run_fit);
}

}  // namespace impactdic::app

// impactdic fit JOB.toml -o DIR: calibrate a model's parameters on measured tracks.
#include <impactdic/fit.h>

#include "host/app/job_command.h"
#include "host/report/job/fit_files.h"
#include "host/report/words/model_words.h"
#include "sim/fit/fit_job.h"

namespace impactdic::app {
namespace {

void run_fit(const JobOptions& options) {
  const auto result = run_job<FitRequest, FitResult>(
      options,
      {sim::fit::read_fit_job, fit, report::write_fit, sim::fit::to_toml, report::in_words});
  for (const PooledEstimate& p : result.pooled) print_warnings(p.warnings);
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

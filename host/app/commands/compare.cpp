// impactdic compare JOB.toml -o DIR: models against measured tracks or tables of shots.
#include <impactdic/compare.h>

#include "host/app/job_command.h"
#include "host/report/job/compare_files.h"
#include "host/report/words/model_words.h"
#include "sim/compare/compare_job.h"
#include "sim/compare/rod_comparison.h"

namespace impactdic::app {
namespace {

void run_compare(const JobOptions& options) {
  if (sim::compare::is_rod_compare_job(options.job)) {
    run_job<RodCompareRequest, RodCompareResult>(
        options, {sim::compare::read_rod_compare_job, compare, report::write_rod_comparison,
                  sim::compare::to_toml, report::in_words});
    return;
  }
  run_job<CompareRequest, CompareResult>(
      options, {sim::compare::read_compare_job, compare, report::write_comparison,
                sim::compare::to_toml, report::in_words});
}

}  // namespace

void add_compare_command(CLI::App& app) {
  add_job_command(app,
                  {.name = "compare",
                   .description = "Models against measured tracks or tables of shots",
                   .job_help = "The job, a TOML file (docs/calibration.md)",
                   .footer = "Writes summary.json, comparison.csv, phases.csv, restitution.csv,\n"
                             "restitution_by_angle.csv, job.toml; of a rod summary.json, "
                             "comparison.csv, job.toml.\n"
                             "Example:\n  impactdic compare sim/jobs/compare_racket.toml -o racket",
                   .threads = true},
                  run_compare);
}

}  // namespace impactdic::app

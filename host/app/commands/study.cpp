#include <impactdic/error.h>
#include <impactdic/study.h>

#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/run_context.h"
#include "host/app/terminal_progress.h"
#include "host/base/parse.h"
#include "host/report/job/study_files.h"

namespace impactdic::app {
namespace {

struct StudyArguments {
  Common common;
  std::string what, output, patterns, estimators;
  PatternStudyRequest pattern_study;
  DensityStudyRequest density_study;
};

std::vector<std::string> list_of(const std::string& text) {
  std::vector<std::string> items;
  for (const std::string& item : split(text, ',')) {
    if (!trim(item).empty()) items.push_back(trim(item));
  }
  return items;
}

// Where the results are, and how they become figures.
void print_figures(const std::filesystem::path& folder, const char* table, std::size_t rows,
                   const char* figures) {
  std::printf("%zu rows in %s; python3 scripts/study_figures.py %s draws figures %s\n", rows,
              (folder / table).c_str(), folder.c_str(), figures);
}

// What both studies tell while they run.
class StudyOutput {
 public:
  explicit StudyOutput(const Common& common) : progress_("study", common.quiet) {
    control.progress = [this](const Progress& p) { progress_(p.done, p.total); };
    control.message = [](const Message& m) {
      if (m.kind == MessageKind::kTiming) std::fputs(m.text.c_str(), stderr);
    };
  }
  RunControl control;

 private:
  TerminalProgress progress_;
};

void run_pattern_study(const CLI::App& command, const StudyArguments& options) {
  PatternStudyRequest request = options.pattern_study;
  request.patterns = list_of(options.patterns);
  if (!options.estimators.empty()) request.estimators = list_of(options.estimators);
  request.validate();
  Session session = open_session(options.common);
  const auto folder = prepare_output_directory(options.output, options.common.force);
  write_job(command, folder / "job.toml");
  const PatternStudyResult result =
      study_patterns(request, session, StudyOutput(options.common).control);
  report::write_study(folder, request, result);
  if (options.common.quiet) return;
  std::printf("%s\n", result.findings.finding.c_str());
  print_figures(folder, "patterns.csv", result.rows.size(), "2.4 to 2.7");
}

void run_density_study(const CLI::App& command, const StudyArguments& options) {
  DensityStudyRequest request = options.density_study;
  const std::vector<std::string> patterns = list_of(options.patterns);
  if (patterns.size() > 1) {
    throw InvalidArgument("the density study takes one pattern", "--patterns");
  }
  if (!patterns.empty()) request.pattern = patterns.front();
  request.noise = options.pattern_study.noise;
  request.seed = options.pattern_study.seed;
  request.radius_px = options.pattern_study.radius_px;
  request.validate();
  Session session = open_session(options.common);
  const auto folder = prepare_output_directory(options.output, options.common.force);
  write_job(command, folder / "job.toml");
  const DensityStudyResult result =
      study_density(request, session, StudyOutput(options.common).control);
  report::write_study(folder, result);
  if (options.common.quiet) return;
  std::printf("%s\n", result.findings.finding.c_str());
  print_figures(folder, "density.csv", result.rows.size(), "2.1 and 2.2");
}

void run_study(const CLI::App& command, const StudyArguments& options) {
  if (options.what == "patterns") return run_pattern_study(command, options);
  if (options.what == "density") return run_density_study(command, options);
  throw InvalidArgument("there is no study '" + options.what + "'", "study", "patterns, density");
}

}  // namespace

void add_study_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "study", "The speckle study: which pattern to paint, which method to take");
  auto options = std::make_shared<StudyArguments>();
  PatternStudyRequest& request = options->pattern_study;
  command->add_option("what", options->what, "patterns or density")->required();
  command->add_option("-o,--output", options->output, "Folder for the results")->required();
  command->add_option("--patterns", options->patterns,
                      "patterns: which, as a1,e1,f2; without it, all sixteen");
  command->add_option("--estimators", options->estimators,
                      "patterns: which of published (or published0 … published9), zncc, icgn3, "
                      "icgn5, icgn7, ring, ball; without it, all with published at 5 points");
  command->add_option("--noise", request.noise, "Camera noise, grey levels of 255")
      ->capture_default_str();
  command->add_option("--seed", request.seed, "Of the patterns and of the noise")
      ->capture_default_str();
  command->add_option("--radius-px", request.radius_px, "The ball's radius, px")
      ->capture_default_str();
  command->add_option("--pairs", request.pairs, "patterns: pairs of frames for each motion")
      ->capture_default_str();
  DensityStudyRequest& density = options->density_study;
  command->add_option("--windows", density.windows, "density: windows measured")
      ->capture_default_str();
  command
      ->add_option("--interp", density.most_points,
                   "density: up to how many spline points between pixels")
      ->capture_default_str();
  add_common_options(*command, options->common);
  command->footer(
      "patterns: balls painted as in the dissertation times eight motions times estimators; writes "
      "patterns.csv and summary.json.\n"
      "density: time and error against the spline points between pixels; writes density.csv, "
      "window.csv, window_spline.csv and summary.json.\n"
      "Example:\n  impactdic study patterns -o study --estimators icgn5,ball\n");
  command->callback([command, options] { run_study(*command, *options); });
}

}  // namespace impactdic::app

// impactdic verify: the built-in table of analytic and published cases; or, with a folder, whether
// results are still what their run wrote.
#include <impactdic/error.h>

#include <cstdio>
#include <iterator>
#include <memory>

#include "host/app/command.h"
#include "host/app/run_context.h"
#include "host/base/parse.h"
#include "host/run/metres/verify_budgets.h"
#include "host/run/results/repeat_run.h"
#include "host/run/results/result_digests.h"
#include "sim/verify/verify_cases.h"
#include "sim/verify/verify_rod.h"

namespace impactdic::app {
namespace {

std::vector<sim::verify::VerifyCase> all_cases(const std::string& only) {
  std::vector<sim::verify::VerifyCase> cases = sim::verify::impact_cases();
  std::vector<sim::verify::VerifyCase> rod = sim::verify::rod_cases();
  std::move(rod.begin(), rod.end(), std::back_inserter(cases));
  std::vector<sim::verify::VerifyCase> budgets = run::budget_cases();
  std::move(budgets.begin(), budgets.end(), std::back_inserter(cases));
  std::erase_if(cases, [&only](const sim::verify::VerifyCase& row) {
    return (row.group + ": " + row.name).find(only) == std::string::npos;
  });
  if (cases.empty()) throw InvalidArgument("no row contains '" + only + "'", "--only");
  return cases;
}

void run_verify(const std::string& only, bool failures_only) {
  int failed = 0, count = 0;
  std::string group;
  for (const sim::verify::VerifyOutcome& outcome : sim::verify::run_cases(all_cases(only))) {
    ++count;
    failed += !outcome.passed;
    if (failures_only && outcome.passed) continue;
    if (outcome.row.group != group) std::printf("%s\n", (group = outcome.row.group).c_str());
    std::printf("  %s  %-58s %.9g (expected %.9g +- %.2g; %s)\n", outcome.passed ? "pass" : "FAIL",
                outcome.row.name.c_str(), outcome.computed, outcome.row.expected,
                outcome.row.tolerance,
                outcome.error.empty() ? outcome.row.source.c_str() : outcome.error.c_str());
  }
  std::printf("%d of %d rows pass\n", count - failed, count);
  if (failed > 0) throw Error(std::to_string(failed) + " rows fail", "verify");
}

void check_results(const std::string& folder, bool failures_only) {
  const run::CheckedResults results = run::check_digests(folder);
  int wrong = 0;
  for (const run::CheckedFile& file : results.files) {
    const bool same = file.state == run::FileState::kSame;
    wrong += !same;
    if (same && failures_only) continue;
    std::printf("  %-8s %s\n", run::to_string(file.state), file.file.c_str());
  }
  std::printf("%zu files in %zu folders as impactdic %s left them: %zu\n", results.files.size(),
              results.folders, results.version.c_str(),
              results.files.size() - static_cast<std::size_t>(wrong));
  if (results.version != IMPACTDIC_VERSION) {
    std::printf("this is impactdic %s: another version may give other figures\n",
                IMPACTDIC_VERSION);
  }
  if (wrong > 0) {
    throw Error(std::to_string(wrong) + " files are not what their run wrote", folder,
                "measure the clip again with --job " + folder + "/job.toml");
  }
}

void repeat(const std::string& folder) {
  Terminal terminal(true);
  int wrong = 0;
  for (const run::RepeatedFile& file : run::repeat_run(folder, terminal.control())) {
    wrong += !file.same;
    std::printf("  %-8s %s, measured again\n", file.same ? "same" : "differs", file.file.c_str());
  }
  if (wrong > 0) {
    throw Error(std::to_string(wrong) + " tables come out otherwise", folder,
                "another device, driver or version, or another clip, gives other figures");
  }
}

}  // namespace

void add_verify_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("verify",
                                         "Check every impact model against formulas, conservation "
                                         "laws and published figures, and the parts of every "
                                         "deviation against finite differences; or, with "
                                         "DIR, results against the digests that their run left");
  struct Options {
    std::string only, folder;
    bool quiet = false, again = false;
  };
  auto options = std::make_shared<Options>();
  command->add_option("DIR", options->folder,
                      "Results of track, correlate or batch: is every file what its run wrote? "
                      "Without DIR the models are checked");
  command->add_option("--only", options->only, "Only rows whose group or name contains this text");
  command->add_flag("-q,--quiet", options->quiet, "Print only the rows that fail, and the count");
  command->add_flag("--again", options->again,
                    "With DIR of track or correlate: run its job once more and compare the tables");
  command->footer(
      "Reads DIR/SHA256SUMS, which sha256sum -c understands too, and changes nothing.\n"
      "Example:\n  impactdic verify --only racket\n  impactdic verify shot_01");
  command->callback([options] {
    if (!options->folder.empty() && !options->only.empty()) {
      throw InvalidArgument("DIR and --only exclude each other", "command line",
                            "--only chooses among the models");
    }
    if (options->folder.empty() && options->again) {
      throw InvalidArgument("there is no DIR to run again", "--again");
    }
    if (options->folder.empty()) {
      run_verify(options->only, options->quiet);
    } else {
      check_results(options->folder, options->quiet);
      if (options->again) repeat(options->folder);
    }
  });
}

}  // namespace impactdic::app

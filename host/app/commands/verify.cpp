// impactdic verify: the built-in table of analytic and published cases.
#include <impactdic/error.h>

#include <cstdio>
#include <iterator>
#include <memory>

#include "host/app/command.h"
#include "host/base/parse.h"
#include "sim/verify/verify_cases.h"
#include "sim/verify/verify_rod.h"

namespace impactdic::app {
namespace {

std::vector<sim::verify::VerifyCase> all_cases(const std::string& only) {
  std::vector<sim::verify::VerifyCase> cases = sim::verify::impact_cases();
  std::vector<sim::verify::VerifyCase> rod = sim::verify::rod_cases();
  std::move(rod.begin(), rod.end(), std::back_inserter(cases));
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

}  // namespace

void add_verify_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "verify",
      "Check every impact model against formulas, conservation laws and published figures");
  struct Options {
    std::string only;
    bool quiet = false;
  };
  auto options = std::make_shared<Options>();
  command->add_option("--only", options->only, "Only rows whose group or name contains this text");
  command->add_flag("-q,--quiet", options->quiet, "Print only the rows that fail, and the count");
  command->footer("Example:\n  impactdic verify --only racket");
  command->callback([options] { run_verify(options->only, options->quiet); });
}

}  // namespace impactdic::app

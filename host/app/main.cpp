// The command line: reads the request, runs the command, turns errors into one line and a status.
#include <impactdic/error.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "host/app/command.h"
#include "host/app/interrupt.h"
#include "host/cli/arguments.h"
#include "host/cli/help.h"

namespace {

constexpr int kMemoryPools = 8;  // with two a GPU's run is a third slower, with eight no slower

enum ExitStatus { kDone = 0, kFailed = 1, kWrongRequest = 2, kBySignal = 128 };

int report(const std::string& line, ExitStatus status) {
  std::fprintf(stderr, "impactdic: error: %s\n", line.c_str());
  return status;
}

// What CLI11 found wrong, in our one-line form.
int report_usage(const CLI::App& app, const std::vector<std::string>& arguments,
                 const CLI::ParseError& error) {
  const std::string first = arguments.empty() ? "" : arguments.front();
  const bool known =
      !app.get_subcommands([&](const CLI::App* c) { return c->get_name() == first; }).empty();
  std::string what = error.what();
  if (first.empty()) what = "no command given";
  const std::string misspelt = impactdic::cli::misspelt_name(app, arguments);
  if (!misspelt.empty()) what = misspelt;  // before all else that is wrong
  std::replace(what.begin(), what.end(), '\n', ' ');
  return report(what + " (command line): see impactdic " + (known ? first + " " : "") + "--help",
                kWrongRequest);
}

void add_commands(CLI::App& app) {
  using namespace impactdic::app;
  add_devices_command(app);
  add_info_command(app);
  add_track_command(app);
  add_batch_command(app);
  add_bench_command(app);
  add_tune_command(app);
  add_correlate_command(app);
  add_calibrate_command(app);
  add_fit_command(app);
  add_compare_command(app);
  add_report_command(app);
  add_rod_command(app);
  add_simulate_command(app);
  add_study_command(app);
  add_synth_command(app);
  add_verify_command(app);
  add_view_command(app);
}

int run(int argc, char** argv) {
  CLI::App app(
      "impactdic measures impacts filmed by high-speed cameras: the ball's centre, "
      "displacement field, velocity and spin in every frame.",
      "impactdic");
  app.require_subcommand(1);
  app.set_version_flag("--version", "impactdic " IMPACTDIC_VERSION);
  app.footer("impactdic COMMAND --help explains a command, with an example.");
  impactdic::cli::show_help_in_groups(app);
  add_commands(app);
  impactdic::cli::arrange(app);
  const std::vector<std::string> given(argv + 1, argv + argc);
  try {
    std::vector<std::string> arguments = impactdic::cli::join_units(app, given);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    app.parse(std::move(arguments));
    const int signal = impactdic::app::interrupted_by();
    if (signal == 0) return kDone;
    std::fputs("impactdic: interrupted: what was measured stays, --resume goes on\n", stderr);
    return kBySignal + signal;
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return report_usage(app, given, error);
  } catch (const impactdic::InvalidArgument& error) {
    return report(error.line(), kWrongRequest);
  } catch (const impactdic::Error& error) {
    return report(error.line(), kFailed);
  } catch (const std::bad_alloc&) {
    return report("out of memory", kFailed);
  } catch (const std::exception& error) {  // of a library: it may have several lines
    return report(impactdic::Error(error.what()).line(), kFailed);
  }
}

// A file became shorter, or its disk failed, while its bytes were lent (ByteFile::lend).
void report_lost_file(int) {
  constexpr char kLine[] =
      "impactdic: error: a file could no longer be read (it became shorter, or its disk failed): "
      "what was written stays\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kLine, sizeof(kLine) - 1);
  ::_exit(kFailed);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGBUS, report_lost_file);
#ifdef __GLIBC__
  // Else each thread of many processors keeps memory that was given back, in a pool of its own.
  ::mallopt(M_ARENA_MAX, kMemoryPools);
#endif
#ifdef __AVX2__
  if (!__builtin_cpu_supports("avx2")) {
    return report("this processor lacks AVX2: build with -DIMPACTDIC_CPU=x86-64", kFailed);
  }
#endif
  return run(argc, argv);
}

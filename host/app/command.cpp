#include "host/app/command.h"

#include <cmath>
#include <memory>
#include <vector>

#include "host/app/job.h"
#include "host/run/folder.h"

namespace impactdic::app {

void add_common_options(CLI::App& command, Common& common) {
  command
      .add_option("--device", common.session.device,
                  "OpenCL device: auto, cpu, gpu, an index, a name, or all (track: every "
                  "GPU, else every CPU)")
      ->capture_default_str();
  command.add_option("-j,--threads", common.session.threads, "Host threads; 0 takes all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.add_flag("-q,--quiet", common.quiet, "Print errors only");
  command.add_flag("-v,--verbose", common.verbosity,
                   "Say more: times of every kernel and stage; -vv for debugging");
  command.add_flag("--force", common.force, "Write into a folder that already holds files");
  command.add_option_function<std::string>(
      "--job", [&command](const std::string& file) { apply_job(command, file); },
      "TOML file with any of these options under their long names; those on the command line win");
}

namespace {

// A number of which `good` holds; `must` says what that is.
template <typename Good>
CLI::Validator number_check(const std::string& must, const std::string& name, Good good) {
  return CLI::Validator(
      [must, good](std::string& text) {
        double value = 0;
        const bool fine = CLI::detail::lexical_cast(text, value) && good(value);
        return fine ? std::string() : "must be " + must + ", not " + text;
      },
      name);
}

}  // namespace

CLI::Validator positive_number() {
  return number_check("positive", "POSITIVE",
                      [](double value) { return value > 0 && std::isfinite(value); });
}

CLI::Validator non_negative_number() {
  return number_check("0 or more", "NONNEGATIVE",
                      [](double value) { return value >= 0 && std::isfinite(value); });
}

void refuse_non_numbers(CLI::App& app) {
  const auto finite =
      number_check("a finite number", "", [](double v) { return std::isfinite(v); });
  const auto count = number_check("0 or more", "", [](double value) { return value >= 0; });
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    for (CLI::Option* option : command->get_options()) {
      const std::string type = option->get_type_name();
      if (type.rfind("FLOAT", 0) == 0) option->check(finite);
      if (type.rfind("UINT", 0) == 0) option->check(count);
    }
  }
}

std::filesystem::path prepare_output_directory(const std::string& dir, bool force) {
  static std::vector<std::unique_ptr<run::OutputFolder>> held;  // until the program ends
  return held.emplace_back(std::make_unique<run::OutputFolder>(dir, force))->path();
}

}  // namespace impactdic::app

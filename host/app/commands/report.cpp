// impactdic report DIR: figures and one page out of results. The figures are drawn in Python
// (scripts/impactdic/report); this command finds it and hands over.
#include <impactdic/error.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include "host/app/command.h"

namespace impactdic::app {
namespace {

namespace fs = std::filesystem;

struct ReportRequest {
  std::string folder;
  int threads = 0;
  double mass_g = 0;
  bool quiet = false;
};

// The folder that holds the Python package: in the checkout that the program was built in, where it
// was installed to, or that of the package which the program is in.
fs::path find_scripts(const fs::path& program) {
  for (fs::path at = program.parent_path(); at.has_relative_path(); at = at.parent_path()) {
    for (const char* place : {"scripts", "share/impactdic/scripts", "."}) {
      if (fs::exists(at / place / "impactdic" / "report" / "__main__.py")) return at / place;
    }
  }
  throw FileError("the report's scripts are missing", program.parent_path().string(),
                  "they are installed with the program, in share/impactdic/scripts");
}

// Debian's packages belong to its own Python, which need not be the first one on the path.
std::string find_python() {
  if (const char* named = std::getenv("IMPACTDIC_PYTHON")) return named;
  return fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
}

[[noreturn]] void run_report(const ReportRequest& request) {
  if (!fs::is_directory(request.folder)) {
    throw InvalidArgument("there is no such folder", request.folder);
  }
  const fs::path program = fs::read_symlink("/proc/self/exe");
  const fs::path scripts = find_scripts(program);
  setenv("PYTHONPATH", scripts.c_str(), 1);
  setenv("PYTHONDONTWRITEBYTECODE", "1", 1);
  const std::string python = find_python(), threads = std::to_string(request.threads);
  std::vector<const char*> arguments = {
      python.c_str(),  "-m",        "impactdic.report", request.folder.c_str(), "--program",
      program.c_str(), "--threads", threads.c_str()};
  const std::string mass = std::to_string(request.mass_g);
  if (request.mass_g > 0) arguments.insert(arguments.end(), {"--mass-g", mass.c_str()});
  if (request.quiet) arguments.push_back("--quiet");
  arguments.push_back(nullptr);
  std::fflush(nullptr);
  execvp(python.c_str(), const_cast<char* const*>(arguments.data()));
  throw FileError(std::string("cannot run Python: ") + std::strerror(errno), python,
                  "install python3, or name it in IMPACTDIC_PYTHON");
}

}  // namespace

void add_report_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("report", "Figures and one self-contained page from results");
  auto request = std::make_shared<ReportRequest>();
  command
      ->add_option("DIR", request->folder,
                   "What track, batch, correlate, study, fit, compare or simulate has written")
      ->required();
  command->add_option("-j,--threads", request->threads, "Figures drawn at a time; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--mass-g", request->mass_g, "The ball's mass: forces are drawn in N")
      ->check(positive_number());
  command->add_flag("-q,--quiet", request->quiet, "Print errors only");
  command->footer(
      "Writes DIR/report.html, which needs nothing but a browser, and DIR/figures/*.png,\n"
      "*.svg and *.pdf.\n"
      "Folders of fit and compare inside DIR are shown with it.\n"
      "Example:\n  impactdic report shot_01\n");
  command->callback([request] { run_report(*request); });
}

}  // namespace impactdic::app

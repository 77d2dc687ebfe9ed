// impactdic view CLIP|DIR: look, set up, run and compare in a page on this machine.
#include <impactdic/error.h>

#include <cstdio>
#include <map>
#include <memory>

#include "host/app/command.h"
#include "host/app/interrupt.h"
#include "host/app/setting_options.h"
#ifdef IMPACTDIC_WITH_VIEW
#include "host/view/view.h"
#endif

namespace impactdic::app {
namespace {

struct ViewOptions {
  ClipRequest clip;
  SessionOptions session;
  int port = 0;
  bool no_browser = false;
};

#ifdef IMPACTDIC_WITH_VIEW
void run_view(const ViewOptions& options) {
  view::ViewRequest request{options.clip, options.session, options.port};
  const auto ready = [&](const std::string& address) {
    std::printf("%s\n", address.c_str());
    std::fflush(stdout);
    if (!options.no_browser) view::open_browser(address);
  };
  watch_for_interrupts();
  view::serve_page(request, ready, [] { return interrupted_by() != 0; });
  forget_interrupt();  // the way to end it
}
#else
void run_view(const ViewOptions&) {
  throw Error("this program was built without its page", "view",
              "it needs cpp-httplib (Debian: libcpp-httplib-dev)");
}
#endif

}  // namespace

void add_view_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "view", "Look at a clip and its results, set up and run a measurement, in a local page");
  auto options = std::make_shared<ViewOptions>();
  command->add_option("CLIP", options->clip.paths, "Clip, or the folder that track or batch wrote")
      ->required();
  OptionAdder add(*command);
  run::visit_reading(add, options->clip);
  add_sandbox_option(*command);
  command->add_option("--port", options->port, "Port of the page; 0 takes a free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->add_flag("--no-browser", options->no_browser, "Print the address, open nothing");
  command->add_option("--device", options->session.device, "OpenCL device, as track takes it")
      ->capture_default_str();
  command->add_option("-j,--threads", options->session.threads, "Host threads; 0 takes all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->footer(
      "Prints the address of the page, which only this machine can open, and serves until Ctrl-C.\n"
      "Example:\n  impactdic view shot_01.cine\n");
  command->callback([options] { run_view(*options); });
}

}  // namespace impactdic::app

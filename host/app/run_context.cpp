#include "host/app/run_context.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/app/interrupt.h"
#include "host/base/log.h"
#include "host/cli/compile_progress.h"
#include "host/run/folder.h"
#include "host/run/session.h"

namespace impactdic::app {

Session open_session(const Common& common) {
  set_log_verbosity(common.quiet ? -1 : common.verbosity);
  SessionOptions options = common.session;
  options.profile = common.verbosity > 0;
  if (!common.quiet) options.on_compile = cli::show_compiling(stderr);
  return Session(options);
}

RunControl Terminal::control() {
  watch_for_interrupts();
  RunControl control;
  control.cancelled = [] { return interrupted_by() != 0; };
  control.progress = [this](const Progress& progress) { show(progress); };
  control.message = [this](const Message& message) { say(message, false); };
  return control;
}

RunControl Terminal::control_with_results() {
  RunControl control = this->control();
  control.message = [this](const Message& message) { say(message, true); };
  return control;
}

void Terminal::show(const Progress& progress) {
  if (!progress_ || phase_ != progress.phase) {
    phase_ = progress.phase;
    progress_ = std::make_unique<TerminalProgress>(phase_, quiet_);
  }
  (*progress_)(progress.done, progress.total);
}

void Terminal::say(const Message& message, bool notes_are_results) {
  if (quiet_) return;
  const char* const text = message.text.c_str();
  if (message.kind == MessageKind::kTiming) {
    std::fputs(text, stderr);
  } else if (message.kind == MessageKind::kWarning) {
    std::fprintf(stderr, "impactdic: warning: %s\n", text);
  } else if (notes_are_results) {
    std::printf("%s\n", text);
    std::fflush(stdout);
  } else {
    std::fprintf(stderr, "impactdic: %s\n", text);
  }
}

RunContext::RunContext(const Common& common, bool with_device) : session_(open_session(common)) {
  if (with_device) session_.open();
}

std::vector<opencl::Engine*> RunContext::engines() { return session_.impl().open_engines(); }

nlohmann::json RunContext::describe() const { return run::describe_device(session_); }

void RunContext::print_profile() { std::fputs(session_.profile().c_str(), stderr); }

}  // namespace impactdic::app

#include "host/app/terminal_progress.h"

#include <unistd.h>

#include <cstdio>

namespace impactdic::app {

TerminalProgress::TerminalProgress(std::string label, bool quiet)
    : label_(std::move(label)),
      shown_(!quiet && isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      last_(start_) {}

TerminalProgress::~TerminalProgress() {
  if (drawn_) std::fputc('\n', stderr);
}

void TerminalProgress::operator()(std::int64_t done, std::int64_t total) {
  if (!shown_) return;
  const auto now = Clock::now();
  if (drawn_ && done != total && now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  drawn_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = elapsed > 0 ? static_cast<double>(done) / elapsed : 0.0;
  const double left = rate > 0 ? static_cast<double>(total - done) / rate : 0.0;
  std::fprintf(stderr, "\r%s %lld/%lld frames  %3.0f %%  %.0f frames/s  %.0f s left ",
               label_.c_str(), static_cast<long long>(done), static_cast<long long>(total),
               total > 0 ? 100.0 * static_cast<double>(done) / static_cast<double>(total) : 0.0,
               rate, left);
  std::fflush(stderr);
}

}  // namespace impactdic::app

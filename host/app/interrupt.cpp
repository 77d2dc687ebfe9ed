#include "host/app/interrupt.h"

#include <csignal>

namespace impactdic::app {
namespace {

volatile std::sig_atomic_t signal_number = 0;

extern "C" void note_signal(int number) { signal_number = number; }

}  // namespace

void watch_for_interrupts() {
  struct sigaction action = {};
  action.sa_handler = note_signal;
  // Reads and writes are not disturbed; the second signal does what it always did.
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

int interrupted_by() { return signal_number; }

void forget_interrupt() { signal_number = 0; }

}  // namespace impactdic::app

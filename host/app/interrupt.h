// Ctrl-C and SIGTERM: a run ends with what it has measured.
#pragma once

namespace impactdic::app {

// From here on the first of these signals asks runs to end; a second one ends the program at once.
void watch_for_interrupts();
// The number of the signal that came, or 0.
int interrupted_by();
// As if none had come.
void forget_interrupt();

}  // namespace impactdic::app

// "compiling kernels, once: 4 of 11": why the first run on a machine takes its time.
#pragma once

#include <impactdic/device.h>

namespace impactdic::app {

// What a session is given as SessionOptions::on_compile. On a terminal one line of stderr that is
// rewritten, and taken away when all that is known is there; elsewhere a single plain line.
CompileFn show_compiling();

}  // namespace impactdic::app

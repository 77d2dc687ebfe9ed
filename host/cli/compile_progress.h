// "compiling kernels, once: 4 of 11": why the first run on a machine takes its time.
#pragma once

#include <impactdic/device.h>

#include <chrono>
#include <cstdio>
#include <functional>

namespace impactdic::cli {

// What a session is given as SessionOptions::on_compile. Where `out` is a terminal, one line that
// is rewritten, and taken away when all that is known is there. Elsewhere plain lines: one at once,
// then one every few seconds, so that a log shows that the run is at work. `now` is asked for the
// time.
using NowFn = std::function<std::chrono::steady_clock::time_point()>;
CompileFn show_compiling(std::FILE* out, NowFn now = std::chrono::steady_clock::now);

}  // namespace impactdic::cli

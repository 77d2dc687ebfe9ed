#include "host/app/compile_progress.h"

#include <unistd.h>

#include <cstdio>

namespace impactdic::app {

CompileFn show_compiling() {
  const bool on_terminal = isatty(STDERR_FILENO) != 0;
  return [on_terminal, said = false](const CompileProgress& progress) mutable {
    if (on_terminal) {
      constexpr const char* kEraseLine = "\r\033[K";
      std::fputs(kEraseLine, stderr);
      if (progress.done < progress.known) {
        std::fprintf(stderr, "compiling kernels, once: %d of %d ", progress.done, progress.known);
      }
      std::fflush(stderr);
    } else if (!said) {
      said = true;
      std::fputs("impactdic: compiling kernels, once for this machine\n", stderr);
    }
  };
}

}  // namespace impactdic::app

#include "host/cli/compile_progress.h"

#include <unistd.h>

#include <utility>

namespace impactdic::cli {
namespace {

constexpr std::chrono::seconds kBetweenLines{3};

}  // namespace

CompileFn show_compiling(std::FILE* out, NowFn now) {
  if (isatty(fileno(out)) != 0) {
    return [out](const CompileProgress& progress) {
      constexpr const char* kEraseLine = "\r\033[K";
      std::fputs(kEraseLine, out);
      if (progress.done < progress.known) {
        std::fprintf(out, "compiling kernels, once: %d of %d ", progress.done, progress.known);
      }
      std::fflush(out);
    };
  }
  return [out, now = std::move(now), said = false,
          last = std::chrono::steady_clock::time_point()](const CompileProgress& progress) mutable {
    const auto time = now();
    if (!said) {
      std::fputs("impactdic: compiling kernels, once for this machine\n", out);
    } else if (time - last >= kBetweenLines) {
      std::fprintf(out, "impactdic: compiling kernels: %d of %d\n", progress.done, progress.known);
    } else {
      return;
    }
    said = true;
    last = time;
    std::fflush(out);
  };
}

}  // namespace impactdic::cli

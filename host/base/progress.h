// Progress of a long run: the library reports, the command line shows.
#pragma once

#include <cstdint>
#include <functional>

namespace impactdic {

// Called with (frames done, frames in all), often; must be cheap.
using ProgressFn = std::function<void(std::int64_t done, std::int64_t total)>;

}  // namespace impactdic

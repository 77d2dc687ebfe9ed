// The object `advice` of summary.json.
#pragma once

#include <impactdic/advice.h>

#include <nlohmann/json_fwd.hpp>

namespace impactdic::report {

// Windows, usable ones and the error expected of each size; of the ball as a whole; null where
// there was nothing to judge.
nlohmann::json describe_advice(const ClipAdvice& advice);

}  // namespace impactdic::report

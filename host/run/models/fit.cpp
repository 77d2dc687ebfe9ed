#include <impactdic/fit.h>

#include "sim/fit/calibration.h"

namespace impactdic {

FitResult fit(const FitRequest& request, const RunControl& control) {
  return sim::fit::calibrate(request, control);
}

}  // namespace impactdic

#include <impactdic/error.h>
#include <impactdic/study.h>

#include "host/study/study_case.h"
#include "sim/speckle/pattern.h"

namespace impactdic {

void PatternStudyRequest::validate() const {
  for (const std::string& name : patterns) sim::speckle::find_pattern(name);
  for (const std::string& name : estimators) study::parse_study_estimator(name);
  if (estimators.empty()) throw InvalidArgument("no estimator is given", "--estimators");
  if (!(radius_px >= 20 && radius_px <= 1000)) {
    throw InvalidArgument("the ball's radius is out of range", "--radius-px", "20 … 1000 px");
  }
  if (!(noise >= 0 && noise <= 100)) {
    throw InvalidArgument("the noise is out of range", "--noise", "0 … 100 grey levels");
  }
  if (pairs < 1 || pairs > 100) {
    throw InvalidArgument("the number of pairs is out of range", "--pairs", "1 … 100");
  }
}

void DensityStudyRequest::validate() const {
  sim::speckle::find_pattern(pattern);
  if (most_points < 0 || most_points > 9) {
    throw InvalidArgument("the number of spline points is out of range", "--interp", "0 … 9");
  }
  if (!(radius_px >= 20 && radius_px <= 2000)) {
    throw InvalidArgument("the ball's radius is out of range", "--radius-px", "20 … 2000 px");
  }
  if (!(noise >= 0 && noise <= 100)) {
    throw InvalidArgument("the noise is out of range", "--noise", "0 … 100 grey levels");
  }
  if (window_px < 5) {
    throw InvalidArgument("the window must have 5 px or more", "window_px");
  }
  if (windows < 1 || repeats < 1) throw InvalidArgument("nothing to measure", "--windows");
}

}  // namespace impactdic

#include <impactdic/compare.h>

#include "sim/compare/comparison.h"
#include "sim/compare/rod_comparison.h"

namespace impactdic {

CompareResult compare(const CompareRequest& request, const RunControl& control) {
  return sim::compare::compare_shots(request, control);
}

RodCompareResult compare(const RodCompareRequest& request, const RunControl& control) {
  return sim::compare::compare_rods(request, control);
}

}  // namespace impactdic

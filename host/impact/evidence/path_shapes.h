// Paths of a ball along one axis, as sums of functions of time. Internal to the impact analysis.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "host/impact/evidence/path_evidence.h"

namespace impactdic::impact {

using Basis = std::vector<std::function<double(double)>>;  // of the place, at an instant

// The families of paths in a span, which must outlive what they give.
class Paths {
 public:
  explicit Paths(const PathSpan& span)
      : span_(span),
        middle_(static_cast<double>(span.begin + span.end) / 2),
        half_(std::max(1.0, static_cast<double>(span.end - span.begin) / 2)) {}

  double frames() const { return 2 * half_; }

  Basis polynomial(int degree) const;
  // Cubic, on even knots.
  Basis spline(int pieces) const;
  // Seen from its side. `rate` in radians a frame.
  Basis circle(double rate, int harmonics) const;
  // An acceleration that changes at an instant.
  Basis released(double at) const;
  // The contact's acceleration in so many pieces, from `more` frames before its guessed beginning
  // to as many after its end: constant in each, or else linear and continuous.
  Basis broken(int pieces, double more, bool constant) const;
  // A force that rises and falls as a half sine, with so many shorter waves and, on wish, a step at
  // its ends.
  Basis pulse(double first, double last, int most_waves, bool with_step) const;

 private:
  double unit(double t) const { return (t - middle_) / half_; }

  PathSpan span_;
  double middle_, half_;
};

}  // namespace impactdic::impact

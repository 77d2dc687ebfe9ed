// The step size of the integrator of impacts.
#pragma once

#include <algorithm>
#include <cmath>

namespace impactdic::sim::contact {

// The next step from the errors of the last two, in the form that odeint asks for: where steps have
// to shrink again and again, as before the separation of a Hertz contact, the last error alone
// would have every second step repeated (Gustafsson 1991).
class StepAdjuster {
 public:
  explicit StepAdjuster(double longest_s = 0) : longest_s_(longest_s) {}

  double decrease_step(double step_s, double error, int) const {
    return limited(step_s * std::max(kSafety * std::pow(error, -kExponent), 1 / kMostChange));
  }
  double increase_step(double step_s, double error, int) {
    const double root = std::pow(std::max(error, 1e-8), kExponent);
    double factor = kSafety / root;
    if (last_step_s_ > 0) factor *= std::min(step_s / last_step_s_ * last_root_ / root, 1.0);
    last_step_s_ = step_s, last_root_ = root;
    return limited(step_s * std::clamp(factor, 1 / kMostChange, kMostChange));
  }
  bool check_step_size_limit(double step_s) const {
    return longest_s_ == 0 || step_s <= longest_s_;
  }
  double get_max_dt() const { return longest_s_; }

 private:
  static constexpr double kExponent = 0.2;  // the error estimate is of the fifth order in the step
  static constexpr double kSafety = 0.85, kMostChange = 5;
  double limited(double step_s) const {
    return longest_s_ == 0 ? step_s : std::min(step_s, longest_s_);
  }

  double longest_s_;  // 0: any
  double last_step_s_ = 0, last_root_ = 0;
};

}  // namespace impactdic::sim::contact

// The mean of values that have deviations.
#pragma once

#include <algorithm>
#include <cmath>

namespace impactdic {

// Weights are inverse squares of the deviations. Where the values differ beyond chance the mean's
// deviation is as much larger: by the ratio sqrt(χ²/(n − 1)) where that exceeds 1 (Birge 1932,
// Physical Review 40, 207).
class WeightedMean {
 public:
  // `sd` > 0.
  void add(double value, double sd) {
    const double weight = 1 / (sd * sd);
    if (count_ == 0) first_ = value;
    const double off = value - first_;  // squares of large values would lose what they differ by
    sum_ += weight * off;
    squares_ += weight * off * off;
    weights_ += weight;
    ++count_;
  }
  int count() const { return count_; }
  // Of at least one value.
  double value() const { return first_ + sum_ / weights_; }
  double sd() const {
    const double chi_squared = std::max(0.0, squares_ - sum_ * sum_ / weights_);
    const double ratio = count_ > 1 ? std::sqrt(chi_squared / (count_ - 1)) : 1;
    return std::max(1.0, ratio) / std::sqrt(weights_);
  }

 private:
  double first_ = 0, sum_ = 0, squares_ = 0, weights_ = 0;
  int count_ = 0;
};

}  // namespace impactdic

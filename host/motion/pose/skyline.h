// Symmetric positive definite matrices whose rows have few columns before the diagonal that are not
// zero, and keep them in the Cholesky factor: each row is stored from its first one on (Jennings
// 1966).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace impactdic::motion {

class Skyline {
 public:
  explicit Skyline(Eigen::Index size) : rows_(static_cast<std::size_t>(size)) {}

  // Adds to the element at row and column, of which the one below the diagonal counts.
  void add(Eigen::Index row, Eigen::Index column, double value) {
    if (column > row) return;
    Row& at = rows_[static_cast<std::size_t>(row)];
    if (at.values.empty()) at.first = row, at.values.assign(1, 0.0);
    if (column < at.first) {
      at.values.insert(at.values.begin(), static_cast<std::size_t>(at.first - column), 0.0);
      at.first = column;
    }
    at.values[static_cast<std::size_t>(column - at.first)] += value;
  }

  // Turns it into its factor; false where it is not positive definite.
  bool factorise() {
    for (Eigen::Index i = 0; i < size(); ++i) {
      Row& row = rows_[static_cast<std::size_t>(i)];
      if (row.values.empty()) return false;
      for (Eigen::Index j = row.first; j < i; ++j) {
        row.at(j) = (row.at(j) - product(row, rows_[static_cast<std::size_t>(j)], j)) /
                    rows_[static_cast<std::size_t>(j)].at(j);
      }
      const double left = row.at(i) - product(row, row, i);
      if (!(left > 0)) return false;
      row.at(i) = std::sqrt(left);
    }
    return true;
  }

  // Of the factorised matrix.
  Eigen::VectorXd solve(Eigen::VectorXd right) const {
    for (Eigen::Index i = 0; i < size(); ++i) {
      const Row& row = rows_[static_cast<std::size_t>(i)];
      const Eigen::Index before = i - row.first;
      right[i] = (right[i] - row.map().head(before).dot(right.segment(row.first, before))) /
                 row.map()[before];
    }
    for (Eigen::Index i = size(); i-- > 0;) {
      const Row& row = rows_[static_cast<std::size_t>(i)];
      const Eigen::Index before = i - row.first;
      right[i] /= row.map()[before];
      right.segment(row.first, before) -= right[i] * row.map().head(before);
    }
    return right;
  }

 private:
  struct Row {
    Eigen::Index first = 0;
    std::vector<double> values;  // up to the diagonal
    double& at(Eigen::Index column) { return values[static_cast<std::size_t>(column - first)]; }
    Eigen::Map<const Eigen::VectorXd> map() const {
      return {values.data(), static_cast<Eigen::Index>(values.size())};
    }
  };
  Eigen::Index size() const { return static_cast<Eigen::Index>(rows_.size()); }

  // Of what both rows hold before column `end`.
  static double product(const Row& a, const Row& b, Eigen::Index end) {
    const Eigen::Index begin = std::max(a.first, b.first);
    if (begin >= end) return 0;
    return a.map()
        .segment(begin - a.first, end - begin)
        .dot(b.map().segment(begin - b.first, end - begin));
  }

  std::vector<Row> rows_;
};

}  // namespace impactdic::motion

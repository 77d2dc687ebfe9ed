// Rows of a least-squares problem that err alike: those of a group share two errors, one the same
// in all of them and one that grows with their reach. Their covariance is D (1 + U U^T) D, D the
// deviations, U the rows' loose and reach; its inverse is D^-1 (1 - U (1 + U^T U)^-1 U^T) D^-1
// (Woodbury 1950). Internal to the impact analysis.
#pragma once

#include <Eigen/Dense>
#include <map>
#include <vector>

#include "host/impact/flight/flight_data.h"

namespace impactdic::impact {

inline Eigen::Vector2d alike(const Datum& d) { return {d.loose, d.reach}; }

class RowGroups {
 public:
  // A row over its deviation, and what goes with it.
  void add(const Datum& d, const Eigen::VectorXd& row, double value, double gravity) {
    Sums& sums = groups_.try_emplace(d.group, row.size()).first->second;
    const Eigen::Vector2d u = alike(d);
    sums.rows += row * u.transpose();
    sums.values += value * u;
    sums.gravity += gravity * u;
    sums.square += u * u.transpose();
  }

  // Of sums over all rows as if each erred by itself.
  void take_off(Eigen::MatrixXd& normal, Eigen::VectorXd& right, Eigen::VectorXd& pull) const {
    for (const auto& [group, sums] : groups_) {
      const Eigen::MatrixX2d rows = sums.rows * sums.square.inverse();
      normal -= rows * sums.rows.transpose();
      right -= rows * sums.values;
      pull -= rows * sums.gravity;
    }
  }

 private:
  struct Sums {
    explicit Sums(Eigen::Index size) : rows(Eigen::MatrixX2d::Zero(size, 2)) {}
    Eigen::MatrixX2d rows;
    Eigen::Vector2d values = Eigen::Vector2d::Zero(), gravity = Eigen::Vector2d::Zero();
    Eigen::Matrix2d square = Eigen::Matrix2d::Identity();
  };
  std::map<int, Sums> groups_;
};

// Rows of one kind, along one axis of one flight, may all be off by `px` alike beside their own
// deviations, which count `scale` times: each such is a group.
void lean(std::vector<Datum>& data, DatumKind kind, double px, double scale);

// Residuals over deviations, less what the rows of a group share: their product with `residuals` is
// their chi square.
std::vector<double> own_residuals(const std::vector<Datum>& data,
                                  const std::vector<double>& residuals);

// Scatter over stated deviation, of each flight's rows of one kind about their own mean along each
// axis: a pattern that stands still on the sensor slows all steps alike. 0 where there are none.
double scatter_about_means(const std::vector<Datum>& data, const std::vector<double>& residuals,
                           DatumKind kind);

// The farthest of those means from 0, where it is so many of its deviations and more; else 0.
double farthest_mean(const std::vector<Datum>& data, const std::vector<double>& residuals,
                     DatumKind kind, double deviations);

// A sphere's circle errs as its texture turns under the rim, and compressed film as its coder goes
// on from picture to picture: alike in frames that follow each other. How many of them count as
// one: the sum of the residuals' correlations (Sokal 1997). Of independent errors of a flat ball
// one in a thousand looks alike, and what centres and steps contradict each other by is no scatter.
double alike_in_a_row(const std::vector<Datum>& data, const std::vector<double>& residuals,
                      DatumKind kind, bool sphere);

}  // namespace impactdic::impact

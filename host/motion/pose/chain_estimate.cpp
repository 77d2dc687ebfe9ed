#include "host/motion/pose/chain_estimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "host/dic/sphere/rotation.h"
#include "host/motion/pose/body_motion.h"
#include "host/motion/pose/skyline.h"

namespace impactdic::motion {
namespace {

// Circles of a turn err in part alike, by ink near the axis that stays under the rim: as if each
// did by twice what it states (e2 of 60 px: of 0.035 px, 0.02 px in all of a turn's).
constexpr double kCirclesAlike = 2;
// Registrations err by this share of the turn alike, whatever the radius: foreshortened texture
// (poses of six clips of 600 and 2000 frames).
constexpr double kForeshortening = 4e-5;
// A closure of which so much is left is of something else: a ball that was hit in between.
constexpr double kMostLeft = 60;  // chi square, of 5 figures
constexpr double kLeastSd_rad = 1e-8, kLeastSd = 1e-9;

constexpr int kOfKey = 5;  // turn, circle
constexpr int kOfAll = 3;  // radius, nearness, foreshortening
constexpr int kOfLink = 2 * kOfKey + kOfAll;

using Vector = Eigen::VectorXd;
using Rows = Eigen::Matrix<double, 5, kOfLink>;
using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

// Shift, turn.
Matrix5 noise_of_link(const ChainLink& link) {
  Matrix5 covariance;
  std::size_t next = 0;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column <= row; ++column) {
      covariance(row, column) = covariance(column, row) = link.covariance[next++];
    }
  }
  return covariance;
}

class Problem {
 public:
  Problem(std::span<const Keyframe> keyframes, const SphereRadius& radius)
      : keyframes_(keyframes), radius_(radius), normal_(size()), factor_(0) {
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
      index_[keyframes[k].pose.keyframe] = static_cast<int>(k);
    }
    right_ = Vector::Zero(size());
    add_known();
  }

  // Rows shift, turn: what was measured less what the poses say is what errors make of it.
  void add(const ChainLink& link) {
    const auto from = index_.find(link.from), to = index_.find(link.to);
    if (from == index_.end() || to == index_.end()) return;
    const Keyframe& a = keyframes_[static_cast<std::size_t>(from->second)];
    const Keyframe& b = keyframes_[static_cast<std::size_t>(to->second)];
    const Eigen::Quaterniond turn = dic::quaternion_of(
        Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(link.turn_rad.data())));
    Vector5 missed;
    missed << link.shift_px[0] - (b.circle.cx_px - a.circle.cx_px),
        link.shift_px[1] - (b.circle.cy_px - a.circle.cy_px),
        dic::rotation_vector(turn * orientation(a.pose) * orientation(b.pose).conjugate());
    using RowByRow = Eigen::Matrix<double, 5, 2, Eigen::RowMajor>;
    Rows rows = Rows::Zero();
    rows.block<3, 3>(2, 0) = -turn.toRotationMatrix();
    rows.block<5, 2>(0, 3) = Eigen::Map<const RowByRow>(link.by_from.data());
    rows.block<2, 2>(0, 3).diagonal().array() += 1;
    rows.block<3, 3>(2, kOfKey) = Eigen::Matrix3d::Identity();
    rows.block<5, 2>(0, kOfKey + 3) = Eigen::Map<const RowByRow>(link.by_to.data());
    rows.block<2, 2>(0, kOfKey + 3).diagonal().array() -= 1;
    rows.col(2 * kOfKey) = Eigen::Map<const Vector5>(link.by_radius.data());
    rows.col(2 * kOfKey + 1) = Eigen::Map<const Vector5>(link.by_nearness.data());
    // It errs as a part of the radius does: a px of that makes about twice its share of the turn.
    rows.col(2 * kOfKey + 2).tail<3>() =
        0.5 * kForeshortening * radius_.px * rows.col(2 * kOfKey).tail<3>();
    add(rows, missed, noise_of_link(link).inverse(), from->second, to->second);
  }

  bool solve() {
    factor_ = normal_;
    if (!factor_.factorise()) return false;
    solution_ = factor_.solve(right_);
    return solution_.allFinite();
  }
  // What is left of all that was measured.
  double chi_square() const { return squares_ - right_.dot(solution_); }

  ChainEstimate::Key key(std::size_t k) const {
    const auto first = static_cast<Eigen::Index>(kOfKey * k);
    const Eigen::MatrixXd covariance = covariance_of(first, kOfKey);
    ChainEstimate::Key found;
    found.turn = solution_.segment<3>(first);
    found.turn_covariance = covariance.topLeftCorner<3, 3>();
    found.off = solution_.segment<2>(first + 3);
    found.off_sd_px = std::sqrt(covariance.diagonal().tail<2>().mean());
    return found;
  }

  SphereRadius radius() const {
    const Eigen::Index first = size() - kOfAll;
    const Eigen::MatrixXd covariance = covariance_of(first, 2);
    SphereRadius now = radius_;
    now.error_px = solution_[first];
    now.nearness_error = solution_[first + 1];
    now.sd_px = std::sqrt(covariance(0, 0));
    const double told = radius_.perspective.nearness_sd, sd = std::sqrt(covariance(1, 1));
    now.nearness_share = told > 0 ? sd / told : 1;
    const double both = now.sd_px * sd;
    now.correlation = both > 0 ? std::clamp(covariance(0, 1) / both, -1.0, 1.0) : 0;
    return now;
  }

 private:
  Eigen::Index size() const {
    return kOfKey * static_cast<Eigen::Index>(keyframes_.size()) + kOfAll;
  }

  // What is known before any link.
  void add_known() {
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      const Keyframe& key = keyframes_[k];
      const auto first = static_cast<int>(kOfKey * k);
      // Of a keyframe whose links are gone, what they told of its circle.
      const bool told = key.anchored && key.pose.keyframe != key.pose.origin;
      const double off_sd = told ? key.off_sd_px : kCirclesAlike * key.circle_sd_px;
      know(first + 3, told ? key.off_px[0] : 0, off_sd);
      know(first + 4, told ? key.off_px[1] : 0, off_sd);
      if (!key.anchored) continue;
      Eigen::Matrix3d known = turn_covariance(key.pose, radius_);
      known.diagonal().array() += kLeastSd_rad * kLeastSd_rad;
      const Eigen::Matrix3d information = known.inverse();
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) normal_.add(first + i, first + j, information(i, j));
      }
    }
    const auto all = static_cast<int>(size()) - kOfAll;
    know(all, 0, std::max(radius_.told_sd_px, kLeastSd));
    know(all + 1, 0, std::max(radius_.perspective.nearness_sd, kLeastSd));
    know(all + 2, 0, 1);
  }

  void know(int column, double value, double sd) {
    const double weight = 1 / (sd * sd);
    normal_.add(column, column, weight);
    right_[column] += weight * value;
    squares_ += weight * value * value;
  }

  void add(const Rows& rows, const Vector5& missed, const Matrix5& weight, int from, int to) {
    const auto all = static_cast<int>(size()) - kOfAll;
    const auto column = [&](int i) {
      if (i < kOfKey) return kOfKey * from + i;
      return i < 2 * kOfKey ? kOfKey * to + i - kOfKey : all + i - 2 * kOfKey;
    };
    const Eigen::Matrix<double, kOfLink, kOfLink> normal = rows.transpose() * weight * rows;
    const Eigen::Matrix<double, kOfLink, 1> right = rows.transpose() * weight * missed;
    for (int i = 0; i < kOfLink; ++i) {
      right_[column(i)] += right[i];
      for (int j = 0; j < kOfLink; ++j) normal_.add(column(i), column(j), normal(i, j));
    }
    squares_ += missed.dot(weight * missed);
  }

  Eigen::MatrixXd covariance_of(Eigen::Index first, Eigen::Index count) const {
    Eigen::MatrixXd covariance(count, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      covariance.col(k) = factor_.solve(Vector::Unit(size(), first + k)).segment(first, count);
    }
    return covariance;
  }

  std::span<const Keyframe> keyframes_;
  SphereRadius radius_;
  std::map<std::int64_t, int> index_;  // by frame
  Skyline normal_, factor_;
  Vector right_, solution_;
  double squares_ = 0;
};

}  // namespace

std::optional<ChainEstimate> ChainEstimate::of(std::span<const Keyframe> keyframes,
                                               std::span<const ChainLink> links,
                                               const SphereRadius& radius) {
  if (links.empty()) return std::nullopt;
  Problem problem(keyframes, radius);
  for (const ChainLink& link : links.first(links.size() - 1)) problem.add(link);
  if (!problem.solve()) return std::nullopt;
  const double open = problem.chi_square();
  problem.add(links.back());
  if (!problem.solve() || !(problem.chi_square() - open <= kMostLeft)) return std::nullopt;
  ChainEstimate estimate;
  for (std::size_t k = 0; k < keyframes.size(); ++k) estimate.keys_.push_back(problem.key(k));
  estimate.radius_ = problem.radius();
  return estimate;
}

}  // namespace impactdic::motion

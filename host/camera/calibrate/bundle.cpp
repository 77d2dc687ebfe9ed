#include "host/camera/calibrate/bundle.h"

#include <impactdic/error.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

namespace impactdic::camera {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

// What is known before any picture: a lens sees between a third and a fiftieth of a radian, its
// principal point lies near the picture's middle. Weak, but keeps what the pictures do not tell
// from running away.
constexpr double kUsualFocal = 4, kLogFocalSd = 1.5, kPrincipalSd = 0.15;  // of the picture's side
constexpr int kMostSteps = 60;
constexpr double kStray = 0.3;  // of a pitch
constexpr std::size_t kFewestForMap = 8;

cv::Matx33d camera_matrix(const LensValues& lens) {
  return {lens[0], 0, lens[2], 0, lens[1], lens[3], 0, 0, 1};
}

cv::Vec<double, 5> distortion(const LensValues& lens) {
  return {lens[4], lens[5], lens[6], lens[7], lens[8]};
}

// From free parameters to all of the lens.
MatrixXd free_part(const LensTerms& terms) {
  MatrixXd part = MatrixXd::Zero(kLensValues, terms.count());
  int column = 0;
  part(0, column) = 1;
  if (terms.aspect) ++column;
  part(1, column++) = 1;
  part(2, column++) = 1;
  part(3, column++) = 1;
  constexpr int kRadial[] = {4, 5, 8};
  for (int i = 0; i < terms.radial; ++i) part(kRadial[i], column++) = 1;
  if (terms.decentred) part(6, column++) = 1, part(7, column++) = 1;
  return part;
}

// Sizes of parameters differ by many orders: inverts with a unit diagonal.
MatrixXd inverse_scaled(const MatrixXd& matrix) {
  const VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const MatrixXd unit = scale.asDiagonal() * matrix * scale.asDiagonal();
  const MatrixXd inverse = unit.ldlt().solve(MatrixXd::Identity(unit.rows(), unit.cols()));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

}  // namespace

Eigen::Matrix2d whitening(const Sighting& sighting, double sd_px) {
  const Eigen::Matrix2d covariance =
      sighting.covariance + sd_px * sd_px * Eigen::Matrix2d::Identity();
  return Eigen::Matrix2d(covariance.inverse()).llt().matrixU();
}

// The block of the lens, those of the poses, and between them.
struct Bundle::Normal {
  MatrixXd lens;                // (free, free)
  VectorXd lens_side;           // gradient
  std::vector<MatrixXd> poses;  // (6, 6)
  std::vector<VectorXd> pose_sides;
  std::vector<MatrixXd> mixed;  // (free, 6)
  double chi_square = 0;
};

std::size_t Weights::points() const {
  std::size_t count = 0;
  for (const auto& view : used) {
    count += static_cast<std::size_t>(std::count(view.begin(), view.end(), 1));
  }
  return count;
}

Bundle::Bundle(BoardPoints board, std::vector<View> views, int width, int height)
    : board_(std::move(board)), views_(std::move(views)), width_(width), height_(height) {}

Weights Bundle::first_weights() const {
  const double most = kStray * (board_.at(1) - board_.at(0)).norm();
  Weights weights;
  for (const View& view : views_) {
    weights.sd_px.push_back(1);
    std::vector<char>& used = weights.used.emplace_back(view.seen.size(), 1);
    std::vector<cv::Point2d> seen, board;
    for (const Sighting& sighting : view.seen) {
      seen.emplace_back(sighting.at_px.x(), sighting.at_px.y());
      board.emplace_back(board_[sighting.point].x(), board_[sighting.point].y());
    }
    if (seen.size() < kFewestForMap) continue;
    const cv::Mat map = cv::findHomography(seen, board, cv::LMEDS);
    if (map.empty()) continue;
    std::vector<cv::Point2d> mapped;
    cv::perspectiveTransform(seen, mapped, map);
    for (std::size_t i = 0; i < seen.size(); ++i) used[i] = cv::norm(mapped[i] - board[i]) < most;
    const auto left = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
    if (left < std::max(kFewestForMap, seen.size() / 2)) used.assign(seen.size(), 1);
  }
  return weights;
}

namespace {

struct Projected {
  std::vector<cv::Point2d> points;
  cv::Mat slopes;  // (2 n, 15): turn, position, f, c, distortion; of OpenCV's order
};

Projected project(const BoardPoints& board, const View& view, const LensValues& lens,
                  const Pose& pose, bool with_slopes) {
  std::vector<cv::Point3d> object;
  for (const Sighting& sighting : view.seen) {
    const Vector2d& point = board[sighting.point];
    object.emplace_back(point.x(), point.y(), 0);
  }
  Projected projected;
  if (object.empty()) return projected;
  const cv::Vec3d turn(pose[0], pose[1], pose[2]), position(pose[3], pose[4], pose[5]);
  if (with_slopes) {
    cv::projectPoints(object, turn, position, camera_matrix(lens), distortion(lens),
                      projected.points, projected.slopes);
  } else {
    cv::projectPoints(object, turn, position, camera_matrix(lens), distortion(lens),
                      projected.points);
  }
  return projected;
}

}  // namespace

std::vector<Vector2d> Bundle::residuals(const Adjusted& state, std::size_t view) const {
  const Projected projected = project(board_, views_[view], state.lens, state.poses[view], false);
  std::vector<Vector2d> off;
  for (std::size_t i = 0; i < projected.points.size(); ++i) {
    off.push_back(views_[view].seen[i].at_px -
                  Vector2d(projected.points[i].x, projected.points[i].y));
  }
  return off;
}

double Bundle::add_prior(const Adjusted& state, Normal* normal) const {
  const double side = std::max(width_, height_);
  const double focal = std::sqrt(state.lens[0] * state.lens[1]);
  const double off = std::log(focal / (kUsualFocal * side)) / kLogFocalSd;
  const Vector2d middle((width_ - 1) / 2.0, (height_ - 1) / 2.0);
  const Vector2d aside = (state.lens.segment<2>(2) - middle) / (kPrincipalSd * side);
  if (normal != nullptr) {
    const MatrixXd part = free_part(state.terms);
    Eigen::Matrix<double, 3, kLensValues> by_lens = Eigen::Matrix<double, 3, kLensValues>::Zero();
    by_lens(0, 0) = 0.5 / state.lens[0] / kLogFocalSd;
    by_lens(0, 1) = 0.5 / state.lens[1] / kLogFocalSd;
    by_lens(1, 2) = by_lens(2, 3) = 1 / (kPrincipalSd * side);
    const MatrixXd slopes = by_lens * part;
    const Eigen::Vector3d residual(off, aside.x(), aside.y());
    normal->lens += slopes.transpose() * slopes;
    normal->lens_side -= slopes.transpose() * residual;
  }
  return off * off + aside.squaredNorm();
}

double Bundle::chi_square(const Adjusted& state, const Weights& weights) const {
  if (!(state.lens[0] > 0) || !(state.lens[1] > 0)) return std::numeric_limits<double>::infinity();
  double sum = add_prior(state, nullptr);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (!(state.poses[v][5] > 0)) return std::numeric_limits<double>::infinity();
    const std::vector<Vector2d> off = residuals(state, v);
    for (std::size_t i = 0; i < off.size(); ++i) {
      if (!weights.used[v][i]) continue;
      sum += (whitening(views_[v].seen[i], weights.sd_px[v]) * off[i]).squaredNorm();
    }
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

Bundle::Normal Bundle::normal_equations(const Adjusted& state, const Weights& weights) const {
  const MatrixXd part = free_part(state.terms);
  Normal normal;
  normal.lens = MatrixXd::Zero(part.cols(), part.cols());
  normal.lens_side = VectorXd::Zero(part.cols());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const View& view = views_[v];
    const Projected projected = project(board_, view, state.lens, state.poses[v], true);
    const auto count = static_cast<Eigen::Index>(view.seen.size());
    MatrixXd by_pose = MatrixXd::Zero(2 * count, kPoseValues);
    MatrixXd by_lens = MatrixXd::Zero(2 * count, kLensValues);
    VectorXd off = VectorXd::Zero(2 * count);
    for (std::size_t i = 0; i < view.seen.size(); ++i) {
      if (!weights.used[v][i]) continue;
      const auto at = static_cast<Eigen::Index>(2 * i);
      for (int axis = 0; axis < 2; ++axis) {
        const int row = static_cast<int>(2 * i) + axis;
        const double* slopes = projected.slopes.ptr<double>(row);
        const double seen = view.seen[i].at_px[axis];
        off[row] = seen - (axis == 0 ? projected.points[i].x : projected.points[i].y);
        for (int k = 0; k < kPoseValues; ++k) by_pose(row, k) = slopes[k];
        for (int k = 0; k < kLensValues; ++k) by_lens(row, k) = slopes[kPoseValues + k];
      }
      const Eigen::Matrix2d white = whitening(view.seen[i], weights.sd_px[v]);
      off.segment<2>(at) = white * off.segment<2>(at).eval();
      by_pose.middleRows<2>(at) = white * by_pose.middleRows<2>(at).eval();
      by_lens.middleRows<2>(at) = white * by_lens.middleRows<2>(at).eval();
    }
    const MatrixXd by_free = by_lens * part;
    normal.lens += by_free.transpose() * by_free;
    normal.lens_side += by_free.transpose() * off;
    normal.poses.push_back(by_pose.transpose() * by_pose);
    normal.pose_sides.push_back(by_pose.transpose() * off);
    normal.mixed.push_back(by_free.transpose() * by_pose);
    normal.chi_square += off.squaredNorm();
  }
  normal.chi_square += add_prior(state, &normal);
  return normal;
}

Adjusted Bundle::adjust(const LensTerms& terms, Adjusted start, const Weights& weights) const {
  Adjusted state = std::move(start);
  state.terms = terms;
  const MatrixXd part = free_part(terms);
  for (int i = 4; i < kLensValues; ++i) {
    if (part.row(i).isZero()) state.lens[i] = 0;
  }
  if (!terms.aspect) state.lens[0] = state.lens[1] = std::sqrt(state.lens[0] * state.lens[1]);
  double damping = 1e-4;
  Normal normal = normal_equations(state, weights);
  for (int step = 0; step < kMostSteps; ++step) {
    // Poses are eliminated first: every one meets the lens alone (Schur's complement).
    MatrixXd reduced = normal.lens;
    reduced.diagonal() *= 1 + damping;
    VectorXd side = normal.lens_side;
    std::vector<MatrixXd> inverses;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      MatrixXd damped = normal.poses[v];
      damped.diagonal() *= 1 + damping;
      inverses.push_back(inverse_scaled(damped));
      reduced -= normal.mixed[v] * inverses[v] * normal.mixed[v].transpose();
      side -= normal.mixed[v] * inverses[v] * normal.pose_sides[v];
    }
    const VectorXd change = inverse_scaled(reduced) * side;
    Adjusted next = state;
    next.lens += part * change;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      next.poses[v] += inverses[v] * (normal.pose_sides[v] - normal.mixed[v].transpose() * change);
    }
    const double chi = chi_square(next, weights);
    if (chi < normal.chi_square) {
      const bool small = normal.chi_square - chi < 1e-10 * (1 + chi);
      state = std::move(next);
      normal = normal_equations(state, weights);
      damping = std::max(damping * 0.1, 1e-12);
      if (small) break;
    } else {
      damping *= 10;
      if (damping > 1e8) break;
    }
  }
  state.chi_square = normal.chi_square;
  return state;
}

MatrixXd Bundle::covariance(const Adjusted& state, const Weights& weights, std::size_t view) const {
  const Normal normal = normal_equations(state, weights);
  const MatrixXd part = free_part(state.terms);
  MatrixXd reduced = normal.lens;
  std::vector<MatrixXd> inverses;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    inverses.push_back(inverse_scaled(normal.poses[v]));
    reduced -= normal.mixed[v] * inverses[v] * normal.mixed[v].transpose();
  }
  const MatrixXd lens = inverse_scaled(reduced);
  const MatrixXd back = -inverses[view] * normal.mixed[view].transpose();  // pose by lens
  constexpr int kAll = kLensValues + kPoseValues;
  MatrixXd all = MatrixXd::Zero(kAll, kAll);
  all.topLeftCorner(kLensValues, kLensValues) = part * lens * part.transpose();
  all.bottomLeftCorner(kPoseValues, kLensValues) = back * lens * part.transpose();
  all.topRightCorner(kLensValues, kPoseValues) =
      all.bottomLeftCorner(kPoseValues, kLensValues).transpose();
  all.bottomRightCorner(kPoseValues, kPoseValues) = inverses[view] + back * lens * back.transpose();
  return (all + all.transpose()) / 2;
}

std::vector<Pose> Bundle::poses_of(std::size_t view, const LensValues& lens,
                                   const Weights& weights) const {
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> seen;
  for (std::size_t i = 0; i < views_[view].seen.size(); ++i) {
    if (!weights.used[view][i]) continue;
    const Sighting& sighting = views_[view].seen[i];
    object.emplace_back(board_[sighting.point].x(), board_[sighting.point].y(), 0);
    seen.emplace_back(sighting.at_px.x(), sighting.at_px.y());
  }
  if (object.size() < 4) {
    throw InvalidArgument("fewer than four points of the target are seen", views_[view].picture);
  }
  std::vector<cv::Mat> turns, positions;
  cv::solvePnPGeneric(object, seen, camera_matrix(lens), distortion(lens), turns, positions, false,
                      cv::SOLVEPNP_IPPE);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    Pose pose;
    for (int k = 0; k < 3; ++k) {
      pose[k] = turns[i].at<double>(k);
      pose[3 + k] = positions[i].at<double>(k);
    }
    if (pose.allFinite() && pose[5] > 0) poses.push_back(pose);
  }
  return poses;
}

bool Bundle::turn_over(Adjusted& state, const Weights& weights) const {
  bool turned = false;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const auto cost = [&](const Pose& pose) {
      Adjusted one = state;
      one.poses[v] = pose;
      const std::vector<Vector2d> off = residuals(one, v);
      double sum = 0;
      for (std::size_t i = 0; i < off.size(); ++i) {
        if (weights.used[v][i]) sum += off[i].squaredNorm();
      }
      return sum;
    };
    double least = cost(state.poses[v]);
    for (const Pose& pose : poses_of(v, state.lens, weights)) {
      const double sum = cost(pose);
      if (!(sum < least * (1 - 1e-6))) continue;
      least = sum;
      state.poses[v] = pose;
      turned = true;
    }
  }
  return turned;
}

Adjusted Bundle::guess(const Weights& weights) const {
  Adjusted best;
  double least = std::numeric_limits<double>::infinity();
  const double side = std::max(width_, height_);
  for (double focal = 0.7 * side; focal < 40 * side; focal *= 1.5) {
    Adjusted state;
    state.lens << focal, focal, (width_ - 1) / 2.0, (height_ - 1) / 2.0, 0, 0, 0, 0, 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const std::vector<Pose> poses = poses_of(v, state.lens, weights);
      if (poses.empty()) {
        throw InvalidArgument("the points are no picture of the target", views_[v].picture);
      }
      state.poses.push_back(poses.front());
    }
    const double chi = chi_square(state, weights);
    if (chi < least) least = chi, best = state;
  }
  if (best.poses.empty()) {
    throw InvalidArgument("no camera fits these points", views_.front().picture);
  }
  return best;
}

}  // namespace impactdic::camera

#include "host/camera/calibrate/calibrate_points.h"

#include <impactdic/error.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/camera/calibrate/find_target.h"
#include "host/camera/calibrate/refine.h"
#include "host/camera/calibrate/solve.h"
#include "host/camera/calibrate/verdict.h"
#include "host/camera/lens.h"

namespace impactdic::camera {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kFewestPoints = 6;  // of a picture that is used

Eigen::Matrix3d turn_of(const Pose& pose) {
  const Vector3d vector = pose.head<3>();
  const double angle = vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

// The target is a plane, but a dot's picture has its centre of gravity elsewhere than its centre
// (Heikkilä 2000, section 2.3): by how much, from the outline of the dot as the camera shows it.
Vector2d off_centre(const Lens& lens, const Pose& pose, const Vector2d& centre, double radius) {
  constexpr int kCorners = 32;
  const Eigen::Matrix3d turn = turn_of(pose);
  const auto seen = [&](const Vector2d& at) {
    const Vector3d point = turn.leftCols<2>() * at + pose.tail<3>();
    return lens.project(point.head<2>() / point.z());
  };
  const Vector2d middle = seen(centre);
  double area = 0;
  Vector2d moment(0, 0);
  for (int i = 0; i < kCorners; ++i) {
    const auto corner = [&](int k) -> Vector2d {
      const double angle = 2 * kPi * k / kCorners;
      return seen(centre + radius * Vector2d(std::cos(angle), std::sin(angle))) - middle;
    };
    const Vector2d a = corner(i), b = corner(i + 1);
    const double cross = a.x() * b.y() - a.y() * b.x();
    area += cross / 2;
    moment += cross / 6 * (a + b);
  }
  return moment / area;
}

Camera with_lens(const LensValues& lens) {
  Camera camera;
  for (std::size_t i = 0; i < kLensValues; ++i) {
    camera.values[i] = lens[static_cast<Eigen::Index>(i)];
  }
  return camera;
}

// Takes what perspective does to dots out of their centres.
std::vector<View> centred(const std::vector<View>& views, const BoardPoints& board,
                          const Adjusted& state, double radius) {
  const Lens lens(with_lens(state.lens));
  std::vector<View> corrected = views;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (Sighting& sighting : corrected[v].seen) {
      sighting.at_px -= off_centre(lens, state.poses[v], board[sighting.point], radius);
    }
  }
  return corrected;
}

double tilt_deg(const Pose& pose) {
  const Vector3d normal = turn_of(pose).col(2), sight = pose.tail<3>().normalized();
  return std::acos(std::min(1.0, std::abs(normal.dot(sight)))) * kDegPerRad;
}

std::string words(const LensTerms& terms) {
  std::string text;
  constexpr const char* kRadial[] = {"k1", "k2", "k3"};
  for (int i = 0; i < terms.radial; ++i)
    text += (text.empty() ? "" : " ") + std::string(kRadial[i]);
  if (terms.decentred) text += text.empty() ? "p1 p2" : " p1 p2";
  if (terms.aspect) text += text.empty() ? "fx/fy" : " fx/fy";
  return text.empty() ? "none" : text;
}

// The pictures that are used, and where each of them stands among all.
struct Chosen {
  std::vector<View> views;
  std::vector<std::size_t> picture;
  std::size_t plane = 0;
};

Chosen choose(const CalibrateRequest& request, const std::vector<View>& pictures,
              CalibrateResult& result) {
  Chosen chosen;
  std::size_t plane = pictures.size();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    CalibrationPicture picture;
    picture.name = pictures[i].picture;
    picture.points = pictures[i].seen.size();
    picture.used = picture.points >= kFewestPoints;
    if (!picture.used) {
      picture.reason =
          picture.points == 0 ? "the target was not found" : "too little of the target is seen";
    }
    const bool is_plane = request.plane.empty() ? i == 0 : picture.name == request.plane;
    if (is_plane && plane == pictures.size()) plane = i;
    if (picture.used) {
      if (plane == i) chosen.plane = chosen.views.size();
      chosen.views.push_back(pictures[i]);
      chosen.picture.push_back(i);
    }
    result.pictures.push_back(std::move(picture));
  }
  if (plane == pictures.size()) {
    throw InvalidArgument("there is no picture '" + request.plane + "'", "--plane",
                          "one of the pictures, as it is named on the command line");
  }
  if (!result.pictures[plane].used) {
    throw InvalidArgument(result.pictures[plane].reason + " in the picture of the plane of motion",
                          result.pictures[plane].name,
                          "check --target and --cells, or name another picture with --plane");
  }
  return chosen;
}

}  // namespace

CalibrateResult calibrate_points(const CalibrateRequest& request, const std::vector<View>& pictures,
                                 int width, int height) {
  CalibrateResult result;
  const Chosen chosen = choose(request, pictures, result);
  const BoardPoints board = board_points(request);
  const double pitch_sd = request.pitch_sd_mm / request.pitch_mm;
  std::vector<View> views = chosen.views;
  const auto solved_with = [&] {
    return solve(Bundle(board, views, width, height), width, height, chosen.plane, pitch_sd,
                 to_string(request.target));
  };
  Solved solved = solved_with();
  if (request.target == CalibrationTarget::kDots) {
    const double diameter_mm = request.dot_mm > 0 ? request.dot_mm : request.pitch_mm / 3;
    views = centred(chosen.views, board, solved.state, diameter_mm * 0.5e-3);
    solved = solved_with();
  }
  result.camera = solved.camera;
  result.terms = words(solved.state.terms);
  result.point_sd_px = solved.sd_px;
  const Bundle bundle(board, views, width, height);
  for (std::size_t v = 0; v < views.size(); ++v) {
    CalibrationPicture& picture = result.pictures[chosen.picture[v]];
    const std::vector<Vector2d> off = bundle.residuals(solved.state, v);
    double squares = 0;
    for (std::size_t i = 0; i < off.size(); ++i) {
      const bool used = solved.weights.used[v][i] != 0;
      const Vector2d& at = views[v].seen[i].at_px;
      result.points.push_back({chosen.picture[v], at.x(), at.y(), off[i].x(), off[i].y(), used});
      picture.rejected += used ? 0 : 1;
      if (used) squares += off[i].squaredNorm();
    }
    picture.rms_px = std::sqrt(squares / 2 / static_cast<double>(off.size() - picture.rejected));
    picture.tilt_deg = tilt_deg(solved.state.poses[v]);
  }
  judge(request, result);
  return result;
}

}  // namespace impactdic::camera

#include "host/camera/calibrate/calibrate_points.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>

#include "host/base/parallel/parallel_for.h"
#include "host/camera/calibrate/board_sight.h"
#include "host/camera/calibrate/find_target.h"
#include "host/camera/calibrate/point_fit.h"
#include "host/camera/calibrate/solve.h"
#include "host/camera/calibrate/verdict.h"

namespace impactdic::camera {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kFewestPoints = 6;  // of a picture that is used

// The target is a plane, but a dot's picture has its centre of gravity elsewhere than its centre
// (Heikkilä 2000, section 2.3): by how much, from the outline of the dot as the camera shows it.
Vector2d off_centre(const BoardSight& sight, const Vector2d& centre, double radius) {
  constexpr int kCorners = 32;
  const Vector2d middle = sight.to_picture(centre);
  double area = 0;
  Vector2d moment(0, 0);
  for (int i = 0; i < kCorners; ++i) {
    const auto corner = [&](int k) -> Vector2d {
      const double angle = 2 * kPi * k / kCorners;
      return sight.to_picture(centre + radius * Vector2d(std::cos(angle), std::sin(angle))) -
             middle;
    };
    const Vector2d a = corner(i), b = corner(i + 1);
    const double cross = a.x() * b.y() - a.y() * b.x();
    area += cross / 2;
    moment += cross / 6 * (a + b);
  }
  return moment / area;
}

// Takes what perspective does to dots out of their centres.
std::vector<View> centred(const std::vector<View>& views, const BoardPoints& board,
                          const Adjusted& state, double radius) {
  std::vector<View> corrected = views;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BoardSight sight(state.lens, state.poses[v]);
    for (Sighting& sighting : corrected[v].seen) {
      sighting.at_px -= off_centre(sight, board[sighting.point], radius);
    }
  }
  return corrected;
}

// What of the points settles on the picture; all of them as they are where it is less than half.
std::vector<Sighting> fitted(const Image<float>& levels, const BoardSight& sight,
                             const PointPattern& pattern, const std::vector<Sighting>& seen,
                             const BoardPoints& board) {
  std::vector<Sighting> kept;
  for (const Sighting& one : seen) {
    const auto found = fit_point(levels, sight, pattern, one, board[one.point]);
    if (found) kept.push_back({one.point, found->at_px, found->covariance});
  }
  return kept.size() >= std::max(seen.size() / 2, kFewestPoints) ? kept : seen;
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

// A calibration on its way: the pictures that are used, their points as they are now.
class Adjustment {
 public:
  Adjustment(const CalibrateRequest& request, const std::vector<View>& pictures, int width,
             int height)
      : request_(request),
        board_(board_points(request)),
        chosen_(choose(request, pictures, result_)),
        width_(width),
        height_(height) {}

  // Points as the finders gave them.
  void solve_found() {
    solve_again();
    if (request_.target != CalibrationTarget::kDots) return;
    const std::vector<View> found = chosen_.views;
    chosen_.views = centred(found, board_, solved_.state, dot_diameter_mm(request_) * 0.5e-3);
    solve_again();
  }

  // Every point by the picture around it, and the camera with these.
  void solve_fitted(const PictureOf& picture, const RunControl& control) {
    const PointPattern pattern(request_);
    std::vector<View>& views = chosen_.views;
    const std::vector<char> done =
        parallel_pieces(views.size(), 0, "fit", control, [&](std::size_t v) {
          const BoardSight sight(solved_.state.lens, solved_.state.poses[v]);
          const Image<float> levels = picture(chosen_.picture[v]);
          views[v].seen = fitted(levels, sight, pattern, views[v].seen, board_);
        });
    if (std::count(done.begin(), done.end(), 0) > 0) throw Error("the calibration was stopped");
    solve_again();
  }

  CalibrateResult result() {
    result_.camera = solved_.camera;
    result_.terms = words(solved_.state.terms);
    result_.point_sd_px = solved_.sd_px;
    const Bundle bundle(board_, chosen_.views, width_, height_);
    for (std::size_t v = 0; v < chosen_.views.size(); ++v) add_picture(bundle, v);
    judge(request_, result_);
    return std::move(result_);
  }

 private:
  void solve_again() {
    solved_ = solve(Bundle(board_, chosen_.views, width_, height_), width_, height_, chosen_.plane,
                    request_.pitch_sd_mm / request_.pitch_mm, to_string(request_.target));
  }

  void add_picture(const Bundle& bundle, std::size_t v) {
    CalibrationPicture& picture = result_.pictures[chosen_.picture[v]];
    const std::vector<Vector2d> off = bundle.residuals(solved_.state, v);
    double squares = 0;
    for (std::size_t i = 0; i < off.size(); ++i) {
      const bool used = solved_.weights.used[v][i] != 0;
      const Vector2d& at = chosen_.views[v].seen[i].at_px;
      result_.points.push_back({chosen_.picture[v], at.x(), at.y(), off[i].x(), off[i].y(), used});
      picture.rejected += used ? 0 : 1;
      if (used) squares += off[i].squaredNorm();
    }
    picture.rms_px = std::sqrt(squares / 2 / static_cast<double>(off.size() - picture.rejected));
    picture.tilt_deg =
        BoardSight(solved_.state.lens, solved_.state.poses[v]).tilt_rad() * kDegPerRad;
  }

  const CalibrateRequest& request_;
  BoardPoints board_;
  CalibrateResult result_;
  Chosen chosen_;
  int width_, height_;
  Solved solved_;
};

}  // namespace

CalibrateResult calibrate_points(const CalibrateRequest& request, const std::vector<View>& pictures,
                                 int width, int height) {
  Adjustment adjustment(request, pictures, width, height);
  adjustment.solve_found();
  return adjustment.result();
}

CalibrateResult calibrate_pictures(const CalibrateRequest& request,
                                   const std::vector<View>& pictures, int width, int height,
                                   const PictureOf& picture, const RunControl& control) {
  Adjustment adjustment(request, pictures, width, height);
  adjustment.solve_found();
  adjustment.solve_fitted(picture, control);
  return adjustment.result();
}

}  // namespace impactdic::camera

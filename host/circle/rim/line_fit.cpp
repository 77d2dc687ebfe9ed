// Circle or ellipse through the traced lines by maximum likelihood, about a rim so close that the
// geometric distance is linear in its corrections:
//   excess = x cos φ + y sin φ + dR + de1 cos 2φ + de2 sin 2φ,
// with an error of x²/2R (4e-4 px at x = 0.3 px and R = 115 px; measure_circle traces again from
// farther away). What each line says of its own excess is in rim_model.
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "host/circle/rim/line_sums.h"
#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/rim/rim_prior.h"

namespace impactdic::circle {
namespace {

constexpr int kRounds = 14, kSteps = 12;         // at most
constexpr double kLinear = 0.12, kClose = 0.05;  // steps of the trace
constexpr double kLinearBlurred = 0.3;           // the same under the blurred look
constexpr int kFirstStride = 4;
constexpr std::size_t kPlenty = 400;  // lines; some of them do at first
constexpr int kGlance = 4;            // blocks of lines for one that a first step looks at
constexpr std::size_t kRough = 85;    // lines that a rough fit needs
constexpr double kShareWorth = 100;   // lines whose worth the shares inside the ball count
constexpr double kRoughly = 0.03, kSettled = 5e-4;  // steps of the trace
constexpr double kThere = 0.5, kConvex = 0.25;      // of the curvature were the kinds known
constexpr double kRelinearise = 0.03;               // steps of the trace
constexpr double kNewton =
    0.1;  // steps of the trace: one of so much is followed by another like it
constexpr double kCommon_px = 0.004;  // errors common to an arc
constexpr double kArcs = 1.2;  // how a sector is misplaced by itself, over all of them together

// One fit: corrections to the rim, their covariance, and what the lines say.
struct Estimate {
  bool ok = false;
  Vector5 delta = Vector5::Zero();
  Matrix5 covariance = Matrix5::Zero();
  Matrix5 misplaced = Matrix5::Zero();  // covariance that a place_sd_px of 1 px adds
  double scatter = 0;                   // of the bare lines
  int points = 0;
  double arc = 0;
  double oval = 0;  // of a circle: χ² that its lines hold against it, 2 degrees of freedom
  // What the next estimate can start from: the shares of the kinds over those inside the ball, the
  // corrections about which the evidence in the memory is linear, and the last sums.
  KindShares shares{};
  Vector5 about = Vector5::Zero(), summed_at = Vector5::Zero();
  LineSums sums;
};

using Evidence = RimModel::Evidence;

// What errors of the lines' places add to the covariance, if they have a standard deviation of 1 px
// all around the rim and of kArcs px sector by sector. A known radius turns some of it aside.
Matrix5 misplaced(const LineSums& s, double wider, const Matrix5& covariance) {
  const Matrix5 response = covariance * s.hessian / wider;
  double squares = 0;
  for (const double information : s.sectors.information) squares += information * information;
  const double sector = squares / std::max(s.hessian_sum, 1e-30);
  return response.col(2) * response.col(2).transpose() +
         kArcs * kArcs * sector / wider * response * covariance;
}

struct Memory {
  std::vector<Evidence> room;
  std::span<Evidence> lines;    // in the room
  std::vector<Evidence> width;  // slopes by the width
};

// `other`: an estimate of the same lines by the other shape, the last one made.
Estimate estimate(const LineTrace& trace, const RimModel& model, const Rim& rim,
                  const CirclePrior& prior, bool ellipse, const LineStart& start,
                  const Estimate* other, Memory& memory) {
  Estimate result;
  const int parameters = ellipse ? 5 : 3;
  const double shrink = model.edge_sigma_px() * model.edge_sigma_px() / (2 * rim.r);
  const bool roughly = start.how == Thoroughness::roughly;
  const bool finely = start.how == Thoroughness::finely;
  // What is learnt is shared by many frames: no step of it is saved.
  const bool follows = start.how != Thoroughness::with_width;
  Vector5 delta = Vector5::Zero();
  if (start.from) {
    const Rim& r = *start.from;
    delta << r.cx - rim.cx, r.cy - rim.cy, r.r - rim.r, r.e1 - rim.e1, r.e2 - rim.e2;
  }
  if (other) {
    delta = other->summed_at;
    result.shares = other->shares;
    result.about = other->about;
    result.sums = other->sums;
  }
  if (start.shares && !other) result.shares = *start.shares;
  double wider = 1;
  // Evidence of every line, linear about the present rim; of some lines at first or if that will
  // do.
  const std::size_t n = trace.lines.size();
  const int last_stride = roughly ? std::max(1, static_cast<int>(n / kRough)) : 1;
  int stride = !roughly && !start.from && !other && n > kPlenty ? kFirstStride : last_stride;
  // Far from the rim the likelihood of what the lines show without noise has maxima of its own.
  bool blurred = roughly && !other;
  bool careful = false;  // a round went too far
  Vector5 last_way = Vector5::Zero();
  for (int round = 0; round < kRounds; ++round) {
    const RimModel& seen = blurred ? model.blurred() : model;
    const double reach = (blurred ? kLinearBlurred : kLinear) * trace.step_px;
    if (round > 0 || !other) {
      memory.lines = seen.evidence(trace, shift_of(delta, trace.step_px), stride, memory.room);
      result.about = delta;
    }
    const Vector5& before = result.about;
    double last_moved = round > 0 || !other ? 1e-9 : kNewton * trace.step_px;
    bool held = false;
    for (int pass = 0; pass < kSteps; ++pass) {
      LineSums& s = result.sums;
      // A first step from where nothing was fitted before.
      const bool glance = finely && !start.shares && !other && round == 0 && pass == 0;
      if (round > 0 || pass > 0 || !other) {
        s = sum_lines(memory.lines, delta, trace.step_px, result.shares, seen.stray(),
                      glance ? kGlance : 1);
        result.summed_at = delta;
      }
      if (s.points < 3 * parameters) return result;
      wider = inflation(s.sectors, s.hessian_sum, kCommon_px, parameters);
      // Newton's step where the fit is all but there, and as much of it as there is curvature
      // before: with less than the curvature of known kinds it would go too far.
      const double convex = s.hessian_sum / s.curvature(2, 2);
      const bool there = !roughly && stride == last_stride && convex > kThere;
      double newton = there ? 1 : follows && convex > kConvex ? 0.5 : 0;
      if (finely && stride == last_stride) newton = std::clamp((convex - 0.35) / 0.4, 0.0, 1.0);
      if (careful) newton = 0;
      const Matrix5 bend = (s.curvature + newton * (s.hessian - s.curvature)) / wider;
      Knowledge known;
      const auto step_by = [&](bool oval) -> Vector5 {
        known = knowledge(rim, delta, prior, oval, shrink);
        const Vector5 gradient = s.score / wider + known.pull - known.precision * delta;
        return Eigen::LDLT<Matrix5>(bend + known.precision).solve(gradient);
      };
      // No farther than what is known of the lines holds. A first step that would go so far is a
      // circle's: that finds its way from where an ellipse loses it.
      Vector5 step = step_by(ellipse && !glance);
      const auto farthest = [&] { return (delta + step - before).cwiseAbs().maxCoeff(); };
      const bool lost = ellipse && round == 0 && pass == 0 && !other && !(farthest() <= reach);
      if (lost) step = step_by(false);
      const double far = farthest();
      held = far > reach;
      if (held) step = (delta + step - before) * (reach / far) + before - delta;
      delta += step;
      const double moved = step.cwiseAbs().maxCoeff();
      if (!std::isfinite(moved)) return result;

      // Of a fine fit after the first step only: shares and radius would settle slowly together.
      if (!finely || (round == 0 && pass == 0 && !other)) {
        for (int k = 0; k < kKinds; ++k) {
          const double share = model.texture().kinds[k].share;
          result.shares[k] = static_cast<float>(
              std::log((s.kinds[k] + kShareWorth * share) / ((s.lines + kShareWorth) * share)));
        }
      }
      // What is left to go, if steps go on to shrink as they do.
      const double left = follows && there ? moved * std::min(1.0, moved / last_moved) : moved;
      last_moved = moved;
      const double settled = roughly || stride > last_stride ? kRoughly : kSettled;
      const bool goes_on = left > settled * trace.step_px || lost || glance;
      if (!held && goes_on && pass + 1 < kSteps) continue;
      if (stride > last_stride) break;
      result.covariance =
          Eigen::LDLT<Matrix5>(s.hessian / wider + known.precision).solve(Matrix5::Identity());
      result.misplaced = misplaced(s, wider, result.covariance);
      if (!ellipse) result.oval = score_test(s.hessian, s.score, wider);
      result.scatter = trace.step_px * std::sqrt(s.scatter / std::max(s.kinds[0], 1e-9f));
      result.points = std::min(static_cast<int>(n), s.points * stride);
      result.arc = 0;
      for (int count : s.sectors.points) result.arc += count > 0 ? 1.0 / kRimSectors : 0;
      break;
    }
    const Vector5 way = delta - before;
    const double moved = way.cwiseAbs().maxCoeff();
    const bool settled = roughly  ? !blurred && moved < kClose * trace.step_px
                         : finely ? !held && result.sums.far < RimModel::kNear + kRelinearise
                                  : moved < kRelinearise * trace.step_px;
    if (stride == last_stride && settled) {
      // At a maximum of the likelihood all of them are positive.
      result.ok = roughly || result.covariance.diagonal().minCoeff() > 0;
      break;
    }
    blurred = blurred && held;
    careful = careful || way.dot(last_way) < 0;
    last_way = way;
    if (moved < kClose * trace.step_px) stride = last_stride;
  }
  result.delta = delta;
  return result;
}

// Change of ln σ of the edge that the lines ask for, with x, y and R free beside it.
double change_of_width(const LineTrace& trace, const RimModel& model, const Vector5& delta,
                       Memory& memory) {
  memory.lines = model.evidence(trace, shift_of(delta, trace.step_px), 1, memory.room);
  memory.width.assign(memory.lines.begin(), memory.lines.end());
  model.width_slopes(memory.width);
  Eigen::Matrix4d square = Eigen::Matrix4d::Identity() * 1e-3;
  double slope = 0;
  for (std::size_t i = 0; i < memory.lines.size(); ++i) {
    Evidence& e = memory.lines[i];
    Lanes other;
    to_chances(model.stray(), e.present, e.value, other);
    Lanes by_place{}, by_width{};
    for (int k = 0; k < kKinds; ++k) {
      by_place += e.value[k] * e.slope[k];
      by_width += e.value[k] * memory.width[i].slope[k];
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      const Eigen::Vector4d s{by_place[lane] * e.cos[lane], by_place[lane] * e.sin[lane],
                              by_place[lane], by_width[lane]};
      square.noalias() += s * s.transpose();
      slope += by_width[lane];
    }
  }
  return square.ldlt().solve(Eigen::Vector4d{0, 0, 0, slope})[3];
}

}  // namespace

LineFit fit_lines(const LineTrace& trace, const RimModel& model, const Rim& rim,
                  const CirclePrior& prior, bool allow_ellipse, const LineStart& start) {
  LineFit fit;
  fit.rim = rim;
  if (trace.lines.size() < 24) return fit;
  thread_local Memory memory;
  const auto by = [&](bool ellipse, const Estimate* other) {
    return estimate(trace, model, rim, prior, ellipse, start, other, memory);
  };
  // A thorough fit takes a circle where the rim is all but one, unless its lines object. The others
  // always try an ellipse first: lines that no circle explains count as ink or strays, and hold
  // nothing against it; and one beside which no ellipse can be found may lie across one.
  const bool finely = start.how == Thoroughness::finely;
  const bool thoroughly = start.how == Thoroughness::with_width;
  const bool circle_first = thoroughly && std::hypot(rim.e1, rim.e2) < kPlainlyOval * rim.r;
  Estimate best;
  if (!allow_ellipse || circle_first) best = by(false, nullptr);
  if (allow_ellipse && !(best.ok && best.oval < kSignificant)) {
    const Estimate oval = by(true, best.ok ? &best : nullptr);
    if (finely && !oval.ok) return fit;
    // What the look may misplace makes ellipses of circles too.
    const double place = model.place_sd_px();
    const Matrix5 covariance = oval.covariance + place * place * oval.misplaced;
    fit.ellipse = oval.ok && wald(rim, oval.delta, covariance) > kSignificant;
    if (fit.ellipse) {
      best = oval;
    } else if (!best.ok) {
      best = by(false, oval.ok && !thoroughly ? &oval : nullptr);
    }
  }
  if (!best.ok) return fit;
  fit.ok = true;
  fit.rim = {rim.cx + best.delta[0], rim.cy + best.delta[1], rim.r + best.delta[2],
             fit.ellipse ? rim.e1 + best.delta[3] : 0, fit.ellipse ? rim.e2 + best.delta[4] : 0};
  for (int i = 0; i < 5; ++i) {
    fit.sd[i] = std::sqrt(std::max(0.0, best.covariance(i, i)));
    fit.misplaced[i] = std::max(0.0, best.misplaced(i, i));
  }
  fit.residual_px = best.scatter;
  fit.shares = best.shares;
  fit.points = best.points;
  fit.arc = best.arc;
  if (start.how == Thoroughness::with_width) {
    fit.width = change_of_width(trace, model, best.delta, memory);
    fit.misfit = model.misfit(memory.width);
  }
  return fit;
}

// The sum over a line is what the ball's mean level makes of its length inside the rim, wherever
// the ink is.
Rim rim_by_area(const LineTrace& trace, const Rim& rim) {
  const RimLines& lines = trace.lines;
  double inside = 0;
  for (std::size_t i = 0; i < lines.size(); ++i)
    inside += lines.profile[i].v[0] + lines.profile[i].v[1];
  const double per_level = 2.0 * static_cast<double>(lines.size()) / std::max(inside, 1e-3);
  Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-6;
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    double sum = 0;
    for (int k = 0; k < kSamples; ++k) sum += lines.profile[i].v[k];
    const Eigen::Vector3d j{lines.cos[i], lines.sin[i], 1};
    a.noalias() += j * j.transpose();
    b.noalias() += (sum * per_level - kInside - 0.5) * trace.step_px * j;
  }
  const Eigen::Vector3d move = a.ldlt().solve(b);
  return {rim.cx + move[0], rim.cy + move[1], rim.r + move[2], rim.e1, rim.e2};
}

}  // namespace impactdic::circle

// Circle or ellipse through the traced lines by maximum likelihood, about a rim so close that the
// geometric distance is linear in its corrections:
//   excess = x cos φ + y sin φ + dR + de1 cos 2φ + de2 sin 2φ,
// with an error of x²/2R (4e-4 px at x = 0.3 px and R = 115 px; measure_circle traces again from
// farther away). What each line says of its own excess is in rim_model.
#include "host/circle/settings/line_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "host/circle/rim/line_estimate.h"
#include "host/circle/rim/line_sums.h"
#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/rim/rim_prior.h"
#include "host/circle/sphere/sphere_lines.h"

namespace impactdic::circle {
namespace {

using Evidence = RimModel::Evidence;

// Kept from call to call.
struct Workspace {
  std::vector<Evidence> room;
  std::span<Evidence> lines;    // in the room
  std::vector<Evidence> width;  // slopes by the width
};

// What is fitted to what. `other`: an estimate of the same lines by the other shape, the last one
// made with this workspace; its evidence and sums are gone on from.
struct LineTask {
  const LineTrace& trace;
  const RimModel& model;
  const Rim& rim;
  const CirclePrior& prior;
  LineStart start;
  Shape shape = Shape::kCircle;
  const LineEstimate* other = nullptr;
};

// The way up to the greatest likelihood. In every round the evidence is made anew, linear about the
// corrections so far, and followed by steps as far as it holds.
class Climb {
 public:
  Climb(const LineTask& task, Workspace& work);
  LineEstimate run();

 private:
  // Of the likelihood at the present corrections: the share of Newton's step in the next step, and
  // whether the fit is all but there.
  struct Bend {
    bool there;
    double newton;
  };
  // Of the steps of a round.
  struct Occasion {
    bool begins;  // the first step of the fit, from no estimate by another shape
    bool quick;   // and from where nothing was fitted before: some blocks of lines do
  };
  struct Step {
    Vector5 by;
    Knowledge known;
    bool held = false;  // shortened to where the evidence holds
    bool lost = false;  // an ellipse's would have gone too far: a circle's
  };

  bool previews() const { return task_.start.how == Thoroughness::kPreview; }
  bool finely() const { return task_.start.how == Thoroughness::kFinely; }
  bool sees_all_wanted() const { return stride_ == last_stride_; }
  // The evidence and the first sums are those of the other shape.
  bool goes_on_from_other() const { return round_ == 0 && task_.other; }
  double px(double steps) const { return steps * task_.trace.step_px; }
  const RimModel& seen() const { return blurred_ ? task_.model.blurred() : task_.model; }

  void make_evidence();
  bool follow_evidence();
  void sum(int every);
  Occasion occasion_of(int pass) const;
  Bend bend() const;
  Step next_step(const Occasion& on, double newton) const;
  Vector5 solve(const Matrix5& curvature, Shape shape, Knowledge& known) const;
  void learn_shares();
  bool settled() const;
  void prepare_next_round();

  const LineTask task_;
  Workspace& work_;
  LineEstimate result_;
  const int parameters_;
  const double shrink_px_;  // a blurred disc's half level lies so far inside its rim
  Vector5 delta_ = Vector5::Zero();
  double wider_ = 1;  // than of independent lines
  int round_ = 0;
  int stride_, last_stride_;  // lines from one that is seen to the next: now and in the end
  bool blurred_;              // evidence under the blurred model
  bool careful_ = false;      // a round turned back: no more of Newton's step
  bool held_ = false;         // the round's last step was
  Vector5 last_way_ = Vector5::Zero();
};

Climb::Climb(const LineTask& task, Workspace& work)
    : task_(task),
      work_(work),
      parameters_(task.shape == Shape::kEllipse ? 5 : 3),
      shrink_px_(task.model.edge_sigma_px() * task.model.edge_sigma_px() / (2 * task.rim.r)) {
  const Rim& rim = task.rim;
  result_.shape = task.shape;
  if (task.start.from) {
    const Rim& r = *task.start.from;
    delta_ << r.cx - rim.cx, r.cy - rim.cy, r.r - rim.r, r.e1 - rim.e1, r.e2 - rim.e2;
  }
  if (task.other) {
    delta_ = task.other->summed_at;
    result_.shares = task.other->shares;
    result_.about = task.other->about;
    result_.sums = task.other->sums;
  } else if (task.start.shares) {
    result_.shares = *task.start.shares;
  }
  // Some lines do at first, or for a preview.
  const std::size_t n = task.trace.lines.size();
  last_stride_ = previews() ? std::max(1, static_cast<int>(n / kLineFit.preview_lines)) : 1;
  const bool few_first = !previews() && !task.start.from && !task.other && n > kLineFit.plenty;
  stride_ = few_first ? kLineFit.first_stride : last_stride_;
  // Far from the rim the likelihood of what the lines show without noise has maxima of its own.
  blurred_ = previews() && !task.other;
}

// Not ok where the lines are too few, or where the rounds do not suffice.
LineEstimate Climb::run() {
  for (round_ = 0; round_ < kLineFit.rounds; ++round_) {
    if (!goes_on_from_other()) make_evidence();
    if (!follow_evidence()) return result_;
    if (settled()) {
      // At a maximum of the likelihood all of them are positive.
      result_.ok = previews() || result_.covariance.diagonal().minCoeff() > 0;
      break;
    }
    prepare_next_round();
  }
  result_.delta = delta_;
  return result_;
}

void Climb::make_evidence() {
  const LineTrace& trace = task_.trace;
  work_.lines = seen().evidence(trace, shift_of(delta_, trace.step_px), stride_, work_.room);
  result_.about = delta_;
}

void Climb::sum(int every) {
  result_.sums =
      sum_lines(work_.lines, delta_, task_.trace.step_px, result_.shares, seen().stray(), every);
  result_.summed_at = delta_;
}

Climb::Occasion Climb::occasion_of(int pass) const {
  const bool begins = round_ == 0 && pass == 0 && !task_.other;
  return {begins, begins && finely() && !task_.start.shares};
}

// Steps until what is left to go is little or lies beyond what the evidence tells. False where the
// lines are too few.
bool Climb::follow_evidence() {
  // What is learnt is shared by many frames: no step of it is saved.
  const bool saves_steps = task_.start.how != Thoroughness::kWithWidth;
  const double enough = previews() || !sees_all_wanted() ? kLineFit.roughly : kLineFit.settled;
  double last_moved = goes_on_from_other() ? px(kLineFit.newton) : 1e-9;
  for (int pass = 0;; ++pass) {
    const Occasion on = occasion_of(pass);
    if (pass > 0 || !goes_on_from_other()) sum(on.quick ? kLineFit.preview_every : 1);
    const LineSums& s = result_.sums;
    if (s.points < kLineFit.points_per_parameter * parameters_) return false;
    wider_ = inflation(s.sectors, s.hessian_sum, kLineFit.common_px, parameters_);
    const auto [there, newton] = bend();
    const Step step = next_step(on, newton);
    held_ = step.held;
    delta_ += step.by;
    const double moved = step.by.cwiseAbs().maxCoeff();
    if (!std::isfinite(moved)) return false;
    // Of a fine fit after the first step only: shares and radius would settle slowly together.
    if (!finely() || on.begins) learn_shares();
    // What is left to go, if steps go on to shrink as they do.
    const double left = saves_steps && there ? moved * std::min(1.0, moved / last_moved) : moved;
    last_moved = moved;
    const bool goes_on = left > px(enough) || step.lost || on.quick;
    if (!held_ && goes_on && pass + 1 < kLineFit.steps) continue;
    if (sees_all_wanted()) {
      const int lines = static_cast<int>(task_.trace.lines.size());
      describe(task_.rim, delta_, step.known, task_.trace.step_px, result_);
      result_.points = std::min(lines, s.points * stride_);
    }
    return true;
  }
}

// Newton's step where the fit is all but there, and as much of it as there is curvature before:
// with less than the curvature of known kinds it would go too far.
Climb::Bend Climb::bend() const {
  const double convex = result_.sums.hessian_sum / result_.sums.curvature(2, 2);
  const bool there = !previews() && sees_all_wanted() && convex > kLineFit.there;
  if (careful_) return {there, 0};
  if (finely() && sees_all_wanted()) {
    return {there, std::clamp((convex - kLineFit.fine_from) / kLineFit.fine_over, 0.0, 1.0)};
  }
  const bool halfway = task_.start.how != Thoroughness::kWithWidth && convex > kLineFit.convex;
  return {there, there ? 1 : halfway ? kLineFit.half_newton : 0};
}

Vector5 Climb::solve(const Matrix5& curvature, Shape shape, Knowledge& known) const {
  known = knowledge(task_.rim, delta_, task_.prior, shape, shrink_px_);
  const Vector5 gradient = result_.sums.score / wider_ + known.pull - known.precision * delta_;
  return Eigen::LDLT<Matrix5>(curvature + known.precision).solve(gradient);
}

// No farther than what is known of the lines holds. A first step that would go so far is a
// circle's: that finds its way from where an ellipse loses it.
Climb::Step Climb::next_step(const Occasion& on, double newton) const {
  const LineSums& s = result_.sums;
  const Matrix5 curvature = (s.curvature + newton * (s.hessian - s.curvature)) / wider_;
  const double reach = px(blurred_ ? kLineFit.blurred_reach : kLineFit.reach);
  const auto farthest = [&](const Vector5& by) {
    return (delta_ + by - result_.about).cwiseAbs().maxCoeff();
  };
  const bool ellipse = task_.shape == Shape::kEllipse;
  Step step;
  step.by = solve(curvature, ellipse && !on.quick ? Shape::kEllipse : Shape::kCircle, step.known);
  step.lost = ellipse && on.begins && !(farthest(step.by) <= reach);
  if (step.lost) step.by = solve(curvature, Shape::kCircle, step.known);
  const double far = farthest(step.by);
  step.held = far > reach;
  if (step.held) {
    step.by = (delta_ + step.by - result_.about) * (reach / far) + result_.about - delta_;
  }
  return step;
}

// The shares of the kinds at this rim over those inside the ball.
void Climb::learn_shares() {
  const LineSums& s = result_.sums;
  constexpr double kWorth = kLineFit.share_worth;
  for (int k = 0; k < kKinds; ++k) {
    const double share = task_.model.texture().kinds[k].share;
    result_.shares[k] =
        static_cast<float>(std::log((s.kinds[k] + kWorth * share) / ((s.lines + kWorth) * share)));
  }
}

bool Climb::settled() const {
  if (!sees_all_wanted()) return false;
  const double moved = (delta_ - result_.about).cwiseAbs().maxCoeff();
  switch (task_.start.how) {
    case Thoroughness::kPreview:
      return !blurred_ && moved < px(kLineFit.close);
    case Thoroughness::kFinely:
      return !held_ && result_.sums.far < RimModel::kNear + kLineFit.relinearise;
    case Thoroughness::kWithWidth:
      return moved < px(kLineFit.relinearise);
  }
  return false;
}

void Climb::prepare_next_round() {
  const Vector5 way = delta_ - result_.about;
  blurred_ = blurred_ && held_;
  careful_ = careful_ || way.dot(last_way_) < 0;
  last_way_ = way;
  if (way.cwiseAbs().maxCoeff() < px(kLineFit.close)) stride_ = last_stride_;
}

// Change of ln σ of the edge that the lines ask for, with x, y and R free beside it.
WidthChange change_of_width(const LineTrace& trace, const RimModel& model, const Vector5& delta,
                            Workspace& work) {
  work.lines = model.evidence(trace, shift_of(delta, trace.step_px), 1, work.room);
  work.width.assign(work.lines.begin(), work.lines.end());
  model.width_slopes(work.width);
  return sum_widths(work.lines, work.width, model.stray());
}

// A thorough fit takes a circle where the rim is all but one, unless its lines object. The others
// always try an ellipse first: lines that no circle explains count as ink or strays, and hold
// nothing against it; and one beside which no ellipse can be found may lie across one. A fine fit
// without an ellipse is none.
LineEstimate choose_shape(LineTask task, Shapes shapes, Workspace& work) {
  const auto by = [&](Shape tried, const LineEstimate* other) {
    task.shape = tried;
    task.other = other;
    return Climb(task, work).run();
  };
  if (shapes == Shapes::kCircle) return by(Shape::kCircle, nullptr);
  const Rim& rim = task.rim;
  const bool thorough = task.start.how == Thoroughness::kWithWidth;
  LineEstimate circle;
  if (thorough && std::hypot(rim.e1, rim.e2) < kPrior.plainly_oval * rim.r) {
    circle = by(Shape::kCircle, nullptr);
    if (circle.ok && circle.oval < kPrior.significant) return circle;
  }
  const LineEstimate oval = by(Shape::kEllipse, circle.ok ? &circle : nullptr);
  if (task.start.how == Thoroughness::kFinely && !oval.ok) return {};
  if (oval.ok && is_plainly_oval(rim, oval, task.model)) return oval;
  return circle.ok ? circle : by(Shape::kCircle, oval.ok && !thorough ? &oval : nullptr);
}

}  // namespace

double log_likelihood(const LineTrace& trace, const RimModel& model, const Rim& rim,
                      const LineFit& fit) {
  Vector5 delta;
  delta << fit.rim.cx - rim.cx, fit.rim.cy - rim.cy, fit.rim.r - rim.r, fit.rim.e1 - rim.e1,
      fit.rim.e2 - rim.e2;
  std::vector<Evidence> room;
  double sum = 0;
  std::size_t line = 0;
  for (const Evidence& e : model.evidence(trace, shift_of(delta, trace.step_px), 1, room)) {
    for (int lane = 0; lane < kLanes && e.present[lane] > 0; ++lane, ++line) {
      double density = std::exp(static_cast<double>(model.stray()));
      for (int k = 0; k < kKinds; ++k) {
        density += std::exp(static_cast<double>(e.value[k][lane] + fit.shares[k]));
      }
      sum += std::log(density) - static_cast<double>(trace.lines.log_scale[line]);
    }
  }
  return sum / static_cast<double>(std::max<std::size_t>(line, 1));
}

LineFit fit_lines(const LineTrace& trace, const RimModel& model, const Rim& rim,
                  const CirclePrior& prior, Shapes shapes, const LineStart& start) {
  LineFit fit;
  fit.rim = rim;
  if (trace.lines.size() < kLineFit.least_lines) return fit;
  thread_local Workspace work;
  const LineEstimate best = choose_shape({trace, model, rim, prior, start}, shapes, work);
  if (!best.ok) return fit;
  fit = fit_of(best, rim);
  if (const Surface of = model.surface(); of != Surface::kFlat) {
    const bool ink = of == Surface::kOutline || is_plainly_lit(trace);
    const Matrix5 light = wavy_light(best.sums.sectors, best.wider, best.covariance, ink);
    for (int i = 0; i < 5; ++i) {
      fit.sd[i] = std::sqrt(std::max(0.0, best.covariance(i, i) + light(i, i)));
    }
  }
  if (start.how == Thoroughness::kWithWidth) {
    const WidthChange change = change_of_width(trace, model, best.delta, work);
    fit.width = change.even;
    fit.uneven_width = change.uneven;
    fit.misfit = model.misfit(work.width);
  }
  return fit;
}

}  // namespace impactdic::circle

#include "host/circle/model_fit.h"

#include <algorithm>
#include <cmath>

#include "host/circle/settings/judgement.h"
#include "host/circle/settings/levels.h"
#include "host/circle/settings/rim_model.h"

namespace impactdic::circle {
namespace {

// The fit by the model lies where the crossings allow it: an edge of another shape, or a ball whose
// ink near its rim is not as it is inside, shows here.
bool agree(const Rim& rim, const RimFit& crossings, double edge_sigma_px) {
  const auto near = [](double off, double sd) {
    return std::abs(off) < kLearning.agree_sds * sd + kLearning.apart_px;
  };
  const Rim& other = crossings.rim;
  return near(rim.cx - other.cx, crossings.sd[0]) && near(rim.cy - other.cy, crossings.sd[1]) &&
         near(rim.r - other.r, crossings.sd[2]) &&
         std::abs(rim.r - other.r) < kLearning.most_shift * edge_sigma_px;
}

class Learner {
 public:
  Learner(const Frame& frame, const RimFit& known, const RimSearch& search,
          const CirclePrior& prior, const CircleOptions& options, LineTrace& trace)
      : frame_(frame),
        known_(known),
        polarity_(search.polarity),
        prior_(prior),
        options_(options),
        trace_(trace),
        sigma_px_(std::max(kLearning.sigma_of_blur * search.blur_px, kLearning.least_sigma_px)) {
    fit_.rim = known.rim;
  }

  ModelFit run() {
    if (!find_place() || !find_width() || !holds()) return {};
    state_place_sd();
    return {fit_, model_};
  }

 private:
  // Fits under the present texture and width, from `start` if there is one.
  bool fit(const Rim* start) {
    model_ = std::make_shared<RimModel>(texture_.result(), trace_.noise, sigma_px_, trace_.step_px);
    fit_ = fit_lines(trace_, *model_, from_, prior_, shapes_of(options_),
                     {Thoroughness::kWithWidth, start});
    return fit_.ok;
  }

  // Traces until the fit lies on the rim that its lines were traced about; the width of the edge
  // follows.
  bool find_place() {
    for (int pass = 0; pass < kLearning.traces; ++pass) {
      from_ = fit_.rim;
      texture_ = {};
      LineRequest request{polarity_, step_px_of(sigma_px_, from_.r), options_.rays};
      request.texture = &texture_;
      trace_lines(frame_, from_, request, trace_);
      if (trace_.lines.empty()) return false;
      if (!fit(nullptr)) {
        const Rim start = rim_by_area(trace_, from_);  // which fine ink does not mislead
        if (!fit(&start)) return false;
      }
      if (distance(fit_.rim, from_) < kJudge.retrace_steps * trace_.step_px) break;
      sigma_px_ *= std::exp(std::clamp(fit_.width, -kLearning.most_change, kLearning.most_change));
    }
    return true;
  }

  // The root of the width that is asked for over the width that is assumed, between the nearest on
  // either side once there are both.
  bool find_width() {
    struct Side {
      double log_sigma = 0, asked = 0;
    } narrow, wide;
    constexpr double kMost = kLearning.most_asked;
    for (int pass = 0; pass < kLearning.widths; ++pass) {
      const Side here{std::log(sigma_px_), std::clamp(fit_.width, -kMost, kMost)};
      if (std::abs(here.asked) < kLearning.settled) break;
      (here.asked > 0 ? narrow : wide) = here;
      double next = here.log_sigma + kLearning.overshoot * here.asked;
      if (narrow.asked > 0 && wide.asked < 0) {
        const double way = narrow.asked / (narrow.asked - wide.asked);
        next = std::lerp(narrow.log_sigma, wide.log_sigma, way);
      }
      sigma_px_ = std::exp(next);
      const Rim last = fit_.rim;
      if (!fit(&last)) return false;
    }
    return true;
  }

  bool holds() const {
    return fit_.misfit < kLearning.misfit && agree(fit_.rim, known_, sigma_px_) &&
           fit_.points > kLearning.explained * static_cast<double>(trace_.lines.size());
  }

  // How far the model may misplace the rim: what a little wider an edge does to the radius.
  void state_place_sd() {
    constexpr double kWider = kLearning.wider;
    const RimModel wider(texture_.result(), trace_.noise, sigma_px_ * std::exp(kWider),
                         trace_.step_px);
    const LineFit other = fit_lines(trace_, wider, from_, prior_, shapes_of(options_),
                                    {Thoroughness::kFinely, &fit_.rim});
    const double moved = other.ok ? (other.rim.r - fit_.rim.r) / kWider : sigma_px_;
    model_->set_place_sd_px(std::hypot(kLearning.model_error * moved, kLearning.least_place_sd_px));
  }

  const Frame& frame_;
  const RimFit& known_;
  const Polarity polarity_;
  const CirclePrior& prior_;
  const CircleOptions& options_;
  LineTrace& trace_;
  double sigma_px_;  // of the edge
  Rim from_;         // that the lines were traced about
  TextureSums texture_;
  std::shared_ptr<RimModel> model_;
  LineFit fit_;
};

}  // namespace

double distance(const Rim& a, const Rim& b) {
  return std::hypot(a.cx - b.cx, a.cy - b.cy) + std::abs(a.r - b.r) +
         std::hypot(a.e1 - b.e1, a.e2 - b.e2);
}

ModelFit follow_rim(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                    Approach approach, LineTrace& trace) {
  const RimModel& model = *prior.rim_model;
  const bool preview_first = approach == Approach::kAfterPreview;
  const double farthest = preview_first ? kJudge.followed_steps : kJudge.retrace_steps;
  LineFit fit;
  fit.rim = rim_of(prior);
  for (int pass = 0; pass < kJudge.follow_traces; ++pass) {
    const bool preview = preview_first && pass == 0;
    const Rim from = fit.rim;
    LineRequest request{polarity_of(*prior.bright), model.step_px(),
                        preview ? options.rays / kJudge.preview_of_lines : options.rays};
    if (pass > 0) request.levels = LineRequest::Levels::kAsBefore;
    trace_lines(frame, from, request, trace);
    if (trace.noise > kJudge.noisier * model.noise()) break;
    if (trace.in_view < kJudge.in_view * trace.cast) break;
    LineStart start{Thoroughness::kPreview};
    const KindShares shares = fit.shares;
    if (!preview) start = {Thoroughness::kFinely, &from, pass > 0 ? &shares : nullptr};
    fit = fit_lines(trace, model, from, prior, shapes_of(options), start);
    if (!fit.ok) break;
    if (fit.points < kJudge.followable * static_cast<double>(trace.lines.size())) break;
    const double moved = distance(fit.rim, from) / trace.step_px;
    if (moved > farthest) break;
    if (!preview && moved < kJudge.retrace_steps) return {fit, prior.rim_model};
  }
  return {};
}

ModelFit learn_rim(const Frame& frame, const RimFit& known, const RimSearch& search,
                   const CirclePrior& prior, const CircleOptions& options, LineTrace& trace) {
  return Learner(frame, known, search, prior, options, trace).run();
}

}  // namespace impactdic::circle

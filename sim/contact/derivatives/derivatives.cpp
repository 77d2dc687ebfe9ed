#include "sim/contact/derivatives/derivatives.h"

#include <impactdic/error.h>
#include <impactdic/measured.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "sim/contact/contact_integration.h"
#include "sim/contact/contact_record.h"
#include "sim/contact/flight/flight.h"
#include "sim/contact/never.h"
#include "sim/contact/two_bodies.h"

namespace impactdic::sim::contact {
namespace {

using State = ImpactStateOf<Sensitive>;
using Numbers = JobNumbers<Sensitive>;
using Input = NumberOfJob<Sensitive>;

// Where the same motion is followed with and without derivatives, velocities agree to this part.
constexpr double kSame = 1e-6;
constexpr double kTolerance = 1e-11;

// As ImpactRun, of one body, without energies and orientation.
class SensitiveRun final : public TrajectoryRequest<Sensitive> {
 public:
  SensitiveRun(const ImpactJob& job, const Numbers& numbers)
      : job_(job), numbers_(numbers), flight_(numbers), normal_(make_normal_law(job, numbers)) {}

  void run() {
    const MotionNumbers<Sensitive>& m = numbers_.initial;
    now_[kVt] = m.vt_m_s, now_[kVn] = m.vn_m_s, now_[kVb] = m.vb_m_s;
    now_[kOmega] = m.omega_rad_s, now_[kOmegaT] = m.omega_t_rad_s;
    now_[kOmegaN] = m.omega_n_rad_s;
    now_[kQn] = m.gap_m;
    for (int contact = 0; contact < job_.solver.contacts; ++contact) {
      if (!reach_surface(contact)) break;
      follow_contact(contact == 0);
      while (separated_ && flight_.touches_again(now_) && reach_surface(contact + 1)) {
        follow_contact(contact == 0);
      }
      if (!first_.separated || !separated_) break;
    }
  }

  double next_s() const override { return kNever; }
  void take(const Sensitive&, const State&) override {}
  void reach(const Sensitive&, const State&) override {}

  bool separated() const { return separated_; }
  const ContactOutcomeOf<Sensitive>& first() const { return first_; }
  const State& touch() const { return touch_; }
  const Sensitive& touch_s() const { return touch_s_; }
  const Sensitive& touch_rate_m_s() const { return touch_rate_; }
  const State& end() const { return now_; }
  const Sensitive& end_s() const { return time_s_; }
  // Velocity of the contact point, along t and b, at the first touch and at its end.
  struct Tips {
    Sensitive t_start, t_end, b_start, b_end;
  };
  const Tips& tips() const { return tips_; }

 private:
  // Flies to the next touch and says whether there is one. A gap of zero that is to change moves
  // the touch, too.
  bool reach_surface(int contact) {
    Sensitive flight(0);
    if (contact > 0 || now_[kQn] > 0) {
      flight = flight_.time_to_touch(now_);
      if (!std::isfinite(flight.a)) return false;
    } else {
      flight.v = -now_[kQn].v / now_[kVn].a;
    }
    now_ = flight_.after(now_, flight).state;
    flight_.put_down(now_);
    time_s_ += flight;
    return true;
  }

  // `told`: of the first blow.
  void follow_contact(bool told) {
    now_[kTip] = now_[kSprings] = Sensitive(0);
    friction_ = make_friction_law(job_, numbers_, now_[kVt], now_[kVn]);
    dynamics_.emplace(numbers_, *normal_, *friction_);
    dynamics_->aim(now_, remembers_slip(job_.friction));
    const State before = now_;
    const Sensitive touch_s = time_s_, rate = dynamics_->contact_point(now_).rate_m_s;
    ContactOutcomeOf<Sensitive> outcome =
        integrate_contact<Sensitive>(job_, *normal_, *friction_, *dynamics_, time_s_, now_, *this);
    time_s_ = outcome.end_s;
    now_ = outcome.end;
    separated_ = outcome.separated;
    if (!told) return;
    tips_.t_end = dynamics_->tip_t(now_), tips_.b_end = dynamics_->tip_b(now_);
    if (first_.steps > 0) return continue_blow(first_, outcome);
    touch_ = before, touch_s_ = touch_s, touch_rate_ = rate;
    tips_.t_start = dynamics_->tip_t(before), tips_.b_start = dynamics_->tip_b(before);
    first_ = std::move(outcome);
  }

  const ImpactJob& job_;
  const Numbers& numbers_;
  const Flight<Sensitive> flight_;
  NormalLawPtr<Sensitive> normal_;
  FrictionLawPtr<Sensitive> friction_;
  std::optional<ContactDynamicsOf<Sensitive>> dynamics_;
  Tips tips_;
  State now_{}, touch_{};
  Sensitive time_s_{}, touch_s_{}, touch_rate_{};
  bool separated_ = false;
  ContactOutcomeOf<Sensitive> first_;
};

void add_state(std::vector<std::pair<std::string, Sensitive>>& list, const std::string& of,
               const State& x) {
  constexpr std::pair<const char*, StateIndex> kParts[] = {{"qt_m", kQt},
                                                           {"qn_m", kQn},
                                                           {"angle_rad", kAngle},
                                                           {"vt_m_s", kVt},
                                                           {"vn_m_s", kVn},
                                                           {"omega_rad_s", kOmega},
                                                           {"qb_m", kQb},
                                                           {"vb_m_s", kVb},
                                                           {"omega_t_rad_s", kOmegaT},
                                                           {"omega_n_rad_s", kOmegaN}};
  for (const auto& [name, place] : kParts) list.emplace_back(of + "." + name, x[place]);
}

// The figures of summary.json, in its order.
std::vector<std::pair<std::string, Sensitive>> outcomes(const Numbers& numbers,
                                                        const Numbers& relative,
                                                        const SensitiveRun& run) {
  const ContactOutcomeOf<Sensitive>& first = run.first();
  const State &before = run.touch(), &after = first.end;
  const Sensitive contact_s = first.end_s - run.touch_s();
  const Sensitive mass = relative.body.mass_kg;
  std::vector<std::pair<std::string, Sensitive>> list;
  const Sensitive out = numbers.has_shell ? after[kVn] : Sensitive(-first.end_point.rate_m_s);
  list.emplace_back("restitution", out / run.touch_rate_m_s());
  list.emplace_back("contact_start_s", run.touch_s());
  list.emplace_back("contact_s", contact_s);
  list.emplace_back("t_max_compression_s", first.t_max_compression_s);
  list.emplace_back("max_deflection_m", first.max_deflection_m);
  list.emplace_back("max_force_n", first.max_force_n);
  list.emplace_back("peak_force_n", first.peak_force_n);
  list.emplace_back("separation_force_n", first.separation_force_n);
  if (numbers.two_balls) {
    add_state(list, "final", state_of_ball(numbers, run.end_s(), run.end(), 1));
    add_state(list, "other_final", state_of_ball(numbers, run.end_s(), run.end(), -1));
  } else {
    add_state(list, "final", run.end());
  }
  list.emplace_back("end_s", run.end_s());
  list.emplace_back("tip_vt_start_m_s", run.tips().t_start);
  list.emplace_back("tip_vt_final_m_s", run.tips().t_end);
  list.emplace_back("tip_vb_start_m_s", run.tips().b_start);
  list.emplace_back("tip_vb_final_m_s", run.tips().b_end);
  list.emplace_back("impulse.t_n_s",
                    mass * (after[kVt] - before[kVt] - relative.gravity_t() * contact_s));
  list.emplace_back("impulse.n_n_s",
                    mass * (after[kVn] - before[kVn] - relative.gravity_n() * contact_s));
  list.emplace_back("impulse.b_n_s", mass * (after[kVb] - before[kVb]));
  return list;
}

// Gives `count` of the inputs, from `first` on, derivatives by parts of their own size.
void seed(std::vector<Input>& inputs, std::size_t first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    inputs[first + i].number->v[static_cast<Eigen::Index>(i)] = inputs[first + i].scale;
  }
}

bool moves_across(const std::string& key) {
  return key.ends_with(".vb_m_s") || key.ends_with(".omega_t_rad_s");
}

// Whether it is the same motion: not another branch at a fork.
bool agrees(const SensitiveRun& run, const Numbers& numbers, const ImpactResult& plain) {
  const State end =
      numbers.two_balls ? state_of_ball(numbers, run.end_s(), run.end(), 1) : run.end();
  const double speed = std::hypot(plain.start.vt_m_s, plain.start.vn_m_s, plain.start.vb_m_s) +
                       std::abs(plain.final.vn_m_s);
  return run.separated() && std::abs(end[kVt].a - plain.final.vt_m_s) <= kSame * speed &&
         std::abs(end[kVn].a - plain.final.vn_m_s) <= kSame * speed &&
         std::abs(end[kVb].a - plain.final.vb_m_s) <= kSame * speed;
}

}  // namespace

ImpactDerivatives derivatives_of(const ImpactJob& job, const ImpactResult& plain) {
  ImpactDerivatives result;
  ImpactJob one = job.other ? relative_job(job) : job;
  // Errors of a switch's instant are magnified where it follows the touch at once.
  one.solver.relative_tolerance = std::min(one.solver.relative_tolerance, kTolerance);
  std::size_t inputs_in_all = 1;
  for (std::size_t first = 0; first < inputs_in_all; first += kInputsAtOnce) {
    Numbers numbers(job);
    std::vector<Input> inputs = numbers_of(job, numbers);
    inputs_in_all = inputs.size();
    const std::size_t count = std::min<std::size_t>(kInputsAtOnce, inputs.size() - first);
    seed(inputs, first, count);
    const Numbers relative = job.other ? numbers.relative() : numbers;
    SensitiveRun run(one, relative);
    try {
      run.run();
    } catch (const Error&) {
      // What can be followed, but not with its derivatives: `agrees` says so.
    }
    const auto list = outcomes(numbers, relative, run);
    if (first == 0) {
      for (const Input& input : inputs) result.inputs.push_back(input.key);
      for (const auto& outcome : list) result.outcomes.push_back(outcome.first);
      result.values.assign(list.size() * inputs.size(), kNotMeasured);
    }
    if (!plain.separated || !agrees(run, numbers, plain)) continue;
    // Springs that remember the slip know none that turns; without slip its line is not known.
    const bool turns = run.tips().t_start == 0 || relative.gravity_t() != 0;
    const bool slips_across = !turns || !remembers_slip(job.friction) || !job.initial.plane();
    for (std::size_t r = 0; r < list.size(); ++r) {
      for (std::size_t i = 0; i < count; ++i) {
        const double slope =
            list[r].second.v[static_cast<Eigen::Index>(i)] / inputs[first + i].scale;
        const bool known = slips_across || !moves_across(inputs[first + i].key);
        if (known && std::isfinite(slope)) result.values[r * inputs.size() + first + i] = slope;
      }
    }
  }
  return result;
}

}  // namespace impactdic::sim::contact

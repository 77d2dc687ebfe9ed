#include "sim/contact/derivatives/derivatives.h"

#include <impactdic/error.h>
#include <impactdic/measured.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/contact/derivatives/sensitive_run.h"
#include "sim/contact/two_bodies.h"

namespace impactdic::sim::contact {
namespace {

using State = ImpactStateOf<Sensitive>;
using Numbers = JobNumbers<Sensitive>;
using Input = NumberOfJob<Sensitive>;

// Where the same motion is followed with and without derivatives, velocities agree to this part.
constexpr double kSame = 1e-6;
constexpr double kTolerance = 1e-11;

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
    // What rolls across plane motion is braked across.
    const bool turns = run.tips().t_start == 0 || relative.gravity_t() != 0;
    const bool slips_across = !job.initial.plane() || ((!turns || !remembers_slip(job.friction)) &&
                                                       job.contact.rolling_friction == 0);
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

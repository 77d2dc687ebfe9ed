#include "host/report/words/model_words.h"

#include <impactdic/units.h>

#include "host/report/words/text.h"

namespace impactdic::report {
namespace {

std::string after(const char* whose, double vt, double vn, double omega) {
  return say("%s: vt %.4f m/s, vn %.4f m/s, omega %.3f rad/s\n", whose, vt, vn, omega);
}

std::string after(const char* whose, const BodyState& s, bool plane) {
  const std::string text = after(whose, s.vt_m_s, s.vn_m_s, s.omega_rad_s);
  if (plane) return text;
  return text + say("  across: vb %.4f m/s, omega_t %.3f rad/s, omega_n %.3f rad/s\n", s.vb_m_s,
                    s.omega_t_rad_s, s.omega_n_rad_s);
}

std::string rod_row(const char* name, double vt, double vn, double omega) {
  return say("  %-14s vt %8.4f  vn %8.4f m/s  omega %9.3f rad/s\n", name, vt, vn, omega);
}

}  // namespace

std::string in_words(const ImpactJob& job, const ImpactResult& result) {
  std::string text = say("restitution %.4f, contact %.4f ms, maximum deflection %.4f mm\n",
                         result.restitution, 1e3 * result.contact_s, 1e3 * result.max_deflection_m);
  const bool plane = job.initial.plane() && (!job.other || job.other->initial.plane());
  text += after("after", result.final, plane);
  if (job.other) text += after("the other after", result.other_final, plane);
  for (const ContactPhase& phase : result.phases) {
    text += say("  %-16s %9.4f to %9.4f ms\n", phase.name, 1e3 * phase.start_s, 1e3 * phase.end_s);
  }
  return text;
}

std::string in_words(const ReboundResult& result) {
  return say("restitution %.4f\n", result.restitution) +
         after("after", result.after.vt_m_s, result.after.vn_m_s, result.after.omega_rad_s);
}

std::string in_words(const RodImpact& impact) {
  return say("restitution %.4f, %d micro-impacts in %.4f ms, dent %.2f um\n", impact.restitution,
             impact.micro_impacts, 1e3 * impact.start_to_end_s, 1e6 * impact.residual_m) +
         after("after", impact.vt_m_s, impact.vn_m_s, impact.omega_rad_s);
}

std::string in_words(const RodResult& result) {
  const RodMeasurement& m = result.measurement;
  std::string text =
      say("impact at %.5f s, angle %.2f deg; restitution at the contact point %.4f +- %.4f\n",
          m.impact_s.value, m.before.angle_rad.value * kDegPerRad, m.restitution.value,
          m.restitution.sd);
  text +=
      rod_row("before", m.before.vt_m_s.value, m.before.vn_m_s.value, m.before.omega_rad_s.value);
  text += rod_row("after", m.after.vt_m_s.value, m.after.vn_m_s.value, m.after.omega_rad_s.value);
  for (const RodPrediction& p : result.predictions) {
    text += rod_row(p.model.c_str(), p.impact.vt_m_s, p.impact.vn_m_s, p.impact.omega_rad_s);
  }
  text += say("  free fall %.4f +- %.4f m/s2; impulses give omega %.3f rad/s after, |Jt|/Jn %.3f\n",
              m.before.gravity_m_s2.value, m.before.gravity_m_s2.sd,
              m.closure.omega_as_measured_rad_s.value, m.closure.impulse_ratio.value);
  if (m.closure.tangential_sign < 0) {
    text += say("  the impulses close only with the tangential axis flipped (omega %.3f)\n",
                m.closure.omega_axis_flipped_rad_s.value);
  }
  return text;
}

}  // namespace impactdic::report

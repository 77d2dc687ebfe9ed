#include "host/report/job/compare_files.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/report/job/fit_files.h"
#include "host/report/job/table_file.h"

namespace impactdic::report {
namespace {

using Json = nlohmann::ordered_json;

void write_comparison_table(const std::filesystem::path& file, const CompareResult& result) {
  TableFile table(
      file,
      "track,surface_angle_deg,model,friction_kinetic,vt_before_m_s,vn_before_m_s,"
      "omega_before_rad_s,vt_measured_m_s,vn_measured_m_s,omega_measured_rad_s,vt_m_s,"
      "vn_m_s,omega_rad_s,vt_error,vn_error,omega_error,vt_printed_m_s,vn_printed_m_s,"
      "omega_printed_rad_s,restitution,contact_s,t_max_compression_s,final_chi_square,final_aic,"
      "rms_m,chi_square,aic");
  for (const ComparedShot& c : result.shots) {
    const ShotFlight& before = c.shot.before;
    const ShotFlight& after = c.shot.after;
    for (const ModelOutcome& m : c.models) {
      const ModelPrediction& p = m.prediction;
      table << c.shot.file << c.shot.surface_angle_deg << std::string(name_of(m.model))
            << m.friction_kinetic << before.vt_m_s.value << before.vn_m_s.value
            << before.omega_rad_s.value << after.vt_m_s.value << after.vn_m_s.value
            << after.omega_rad_s.value << p.vt_m_s << p.vn_m_s << p.omega_rad_s << m.vt_error
            << m.vn_error << m.omega_error << m.printed.vt_m_s << m.printed.vn_m_s
            << m.printed.omega_rad_s << p.restitution << p.contact_s << p.t_max_compression_s
            << m.final_chi_square << m.final_aic << m.rms_m << m.chi_square << m.aic;
      table.end_row();
    }
  }
  table.close();
}

// Every phase of every model that has any.
void write_phases(const std::filesystem::path& file, const CompareResult& result) {
  TableFile table(file, "track,model,kind,phase,start_s,end_s");
  for (const ComparedShot& c : result.shots) {
    for (const ModelOutcome& m : c.models) {
      for (const ContactPhase& phase : m.prediction.phases) {
        table << c.shot.file << std::string(name_of(m.model))
              << std::string(phase.kind == ContactPhaseKind::kNormal ? "normal" : "tangential")
              << std::string(phase.name) << phase.start_s << phase.end_s;
        table.end_row();
      }
    }
  }
  table.close();
}

void write_restitution(const std::filesystem::path& folder, const CompareResult& result) {
  TableFile table(folder / "restitution.csv",
                  "track,surface_angle_deg,speed_m_s,vn_before_m_s,restitution,restitution_sd,"
                  "friction_published,friction_with_gravity,friction_sd,rolling_cap");
  for (const ComparedShot& c : result.shots) {
    const MeasuredShot& s = c.shot;
    table << s.file << s.surface_angle_deg
          << std::hypot(s.before.vt_m_s.value, s.before.vn_m_s.value) << s.before.vn_m_s.value
          << s.restitution.value << s.restitution.sd << s.friction.published << s.friction.sound
          << s.friction_sd << s.friction.rolling_cap;
    table.end_row();
  }
  table.close();
  TableFile angles(folder / "restitution_by_angle.csv",
                   "surface_angle_deg,shots,restitution,restitution_scatter_sd,friction_published,"
                   "friction_published_scatter_sd,friction_with_gravity,"
                   "friction_with_gravity_scatter_sd,rolling_cap");
  for (const AngleAverage& a : result.angles) {
    angles << a.surface_angle_deg << static_cast<double>(a.shots) << a.restitution.value
           << a.restitution.sd << a.friction_published.value << a.friction_published.sd
           << a.friction_sound.value << a.friction_sound.sd << a.rolling_cap.value;
    angles.end_row();
  }
  angles.close();
}

Json outcome_json(const ModelOutcome& m) {
  const ModelPrediction& p = m.prediction;
  Json phases = Json::array();
  for (const ContactPhase& phase : p.phases) {
    phases.push_back({{"name", phase.name}, {"start_s", phase.start_s}, {"end_s", phase.end_s}});
  }
  return {{"model", name_of(m.model)},
          {"friction_kinetic", m.friction_kinetic},
          {"restitution", json_number(p.restitution)},
          {"final",
           {{"vt_m_s", json_number(p.vt_m_s)},
            {"vn_m_s", json_number(p.vn_m_s)},
            {"omega_rad_s", json_number(p.omega_rad_s)}}},
          {"relative_error",
           {{"vt", json_number(m.vt_error)},
            {"vn", json_number(m.vn_error)},
            {"omega", json_number(m.omega_error)}}},
          {"printed",
           {{"vt_m_s", json_number(m.printed.vt_m_s)},
            {"vn_m_s", json_number(m.printed.vn_m_s)},
            {"omega_rad_s", json_number(m.printed.omega_rad_s)}}},
          {"contact_s", json_number(p.contact_s)},
          {"t_max_compression_s", json_number(p.t_max_compression_s)},
          {"phases", phases},
          {"final_chi_square", json_number(m.final_chi_square)},
          {"final_aic", json_number(m.final_aic)},
          {"rms_m", json_number(m.rms_m)},
          {"chi_square", json_number(m.chi_square)},
          {"aic", json_number(m.aic)}};
}

}  // namespace

void write_comparison(const std::filesystem::path& folder, const CompareRequest& job,
                      const CompareResult& result) {
  const ContactParameters& contact = result.laws.contact;
  Json summary{{"normal", name_of(job.calibration.impact.normal)},
               {"preset", name_of(job.calibration.impact.preset)},
               {"version", IMPACTDIC_VERSION},
               {"contact",
                {{key_of(FitParameter::kStiffness, job.calibration.impact.normal),
                  json_number(contact.stiffness)},
                 {"damping_n_s_per_m", json_number(contact.damping_n_s_per_m)},
                 {"friction_kinetic", json_number(contact.friction_kinetic)}}},
               {"calibration", nullptr},
               {"shots", Json::array()}};
  if (!result.calibration.shots.empty()) {
    summary["calibration"] = {{"parameters", pooled_json(result.calibration.pooled)},
                              {"shots", fits_json(result.calibration)}};
  }
  for (const ComparedShot& c : result.shots) {
    Json models = Json::array();
    for (const ModelOutcome& m : c.models) models.push_back(outcome_json(m));
    const Json initial{{"vt_m_s", json_number(c.initial.vt_m_s)},
                       {"vn_m_s", json_number(c.initial.vn_m_s)},
                       {"omega_rad_s", json_number(c.initial.omega_rad_s)}};
    summary["shots"].push_back(
        {{"measured", shot_json(c.shot)}, {"initial", initial}, {"models", models}});
  }
  write_ordered_json(folder / "summary.json", summary);
  write_comparison_table(folder / "comparison.csv", result);
  write_phases(folder / "phases.csv", result);
  write_restitution(folder, result);
}

void write_rod_comparison(const std::filesystem::path& folder, const RodCompareRequest& job,
                          const RodCompareResult& result) {
  Json summary{{"models", job.models}, {"version", IMPACTDIC_VERSION}, {"blows", Json::array()}};
  TableFile table(folder / "comparison.csv",
                  "blow,rod_angle_deg,model,vt_before_m_s,vn_before_m_s,omega_before_rad_s,"
                  "restitution_measured,vt_measured_m_s,vn_measured_m_s,omega_measured_rad_s,"
                  "restitution,vt_m_s,vn_m_s,omega_rad_s,micro_impacts,start_to_end_s,contact_s,"
                  "residual_m,restitution_printed,omega_printed_rad_s");
  for (const ComparedBlow& blow : result.blows) {
    Json models = Json::array();
    for (const RodOutcome& m : blow.models) {
      const bool formula = m.micro_impacts == 0;
      table << blow.file << blow.rod_angle_deg << m.model << blow.before.vt_m_s.value
            << blow.before.vn_m_s.value << blow.before.omega_rad_s.value << blow.restitution
            << blow.after.vt_m_s.value << blow.after.vn_m_s.value << blow.after.omega_rad_s.value
            << m.restitution << m.vt_m_s << m.vn_m_s << m.omega_rad_s
            << (formula ? std::string() : std::to_string(m.micro_impacts)) << m.start_to_end_s
            << m.contact_s << m.residual_m << m.printed.restitution << m.printed.omega_rad_s;
      table.end_row();
      models.push_back({{"model", m.model},
                        {"restitution", json_number(m.restitution)},
                        {"final",
                         {{"vt_m_s", json_number(m.vt_m_s)},
                          {"vn_m_s", json_number(m.vn_m_s)},
                          {"omega_rad_s", json_number(m.omega_rad_s)}}},
                        {"micro_impacts", formula ? Json(nullptr) : Json(m.micro_impacts)},
                        {"residual_m", json_number(m.residual_m)}});
    }
    summary["blows"].push_back({{"blow", blow.file},
                                {"rod_angle_deg", blow.rod_angle_deg},
                                {"restitution_measured", json_number(blow.restitution)},
                                {"models", models}});
  }
  table.close();
  write_ordered_json(folder / "summary.json", summary);
}

}  // namespace impactdic::report

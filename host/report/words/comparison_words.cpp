// Measured shots beside models: fits and comparisons.
#include <cmath>

#include "host/report/words/model_words.h"
#include "host/report/words/text.h"

namespace impactdic::report {
namespace {

std::string goodness(const ShotFit& fit) {
  if (fit.adequacy == Adequacy::kNotTested) return "";
  std::string text =
      say("chi square / freedom   %.4g, p %.2g: %s\n", fit.reduced_chi_square, fit.p_value,
          fit.adequacy == Adequacy::kAdequate ? "adequate" : "INADEQUATE");
  for (const RivalFit& rival : fit.rivals) {
    text += say("  %-20s %-10s %-18s AICc above the best %.4g\n",
                std::string(name_of(rival.normal)).c_str(),
                std::string(name_of(rival.friction)).c_str(),
                std::string(name_of(rival.restitution_damping)).c_str(), rival.above_best);
  }
  return text;
}

std::string one_shot(const ShotFit& shot) {
  std::string text;
  for (const ParameterEstimate& p : shot.parameters) {
    text += say("%-22s %.6g +- %.2g  95 %% in [%.6g, %.6g]%s%s\n", p.key.c_str(), p.value, p.sd,
                p.ci95_low, p.ci95_high,
                p.determined ? "" : "  NOT DETERMINED: ", p.determined ? "" : p.verdict.c_str());
  }
  return text + goodness(shot);
}

// A number of so many characters and digits behind the point, or as much room where there is none.
std::string cell(double value, int width, int digits) {
  return std::isnan(value) ? say("%*s", width, "-") : say("%*.*f", width, digits, value);
}

std::string speeds(const std::string& name, double vt, double vn, double omega) {
  return say("  %-20s vt %s  vn %s m/s  omega %s rad/s", name.c_str(), cell(vt, 8, 4).c_str(),
             cell(vn, 8, 4).c_str(), cell(omega, 8, 3).c_str());
}

}  // namespace

std::string in_words(const FitResult& result) {
  if (result.shots.size() == 1) return one_shot(result.shots[0]);
  std::string text;
  for (const PooledEstimate& p : result.pooled) {
    // The published grid gives no deviations to weigh by: its mean is all there is.
    if (!std::isnan(p.value)) {
      text += say("%-22s pooled %.6g +- %.2g, between shots %.2g\n", p.key.c_str(), p.value, p.sd,
                  p.between_sd);
    }
    text += say("%-22s mean of %zu shots %.6g, scatter %.2g\n", p.key.c_str(), result.shots.size(),
                p.mean, p.scatter_sd);
    for (const std::string& file : p.outliers) text += "  outlier: " + file + "\n";
  }
  return text;
}

std::string in_words(const CompareResult& result) {
  std::string text;
  for (const ComparedShot& c : result.shots) {
    const ShotFlight& after = c.shot.after;
    text += say("%s, %.1f deg\n", c.shot.file.c_str(), c.shot.surface_angle_deg);
    text += speeds("measured", after.vt_m_s.value, after.vn_m_s.value, after.omega_rad_s.value);
    text += "\n";
    for (const ModelOutcome& m : c.models) {
      const ModelPrediction& p = m.prediction;
      text += speeds(std::string(name_of(m.model)), p.vt_m_s, p.vn_m_s, p.omega_rad_s);
      if (!std::isnan(m.rms_m)) text += say("  rms %.4f mm", 1e3 * m.rms_m);
      text += "\n";
      if (!std::isnan(m.printed.vt_m_s) || !std::isnan(m.printed.omega_rad_s)) {
        text += speeds("  printed", m.printed.vt_m_s, m.printed.vn_m_s, m.printed.omega_rad_s);
        text += "\n";
      }
    }
  }
  return text;
}

std::string in_words(const RodCompareResult& result) {
  std::string text;
  for (const ComparedBlow& blow : result.blows) {
    text += say("%s, rod at %.1f deg\n  %-14s e %s  omega %s rad/s\n", blow.file.c_str(),
                blow.rod_angle_deg, "measured", cell(blow.restitution, 7, 4).c_str(),
                cell(blow.after.omega_rad_s.value, 8, 3).c_str());
    for (const RodOutcome& m : blow.models) {
      text +=
          say("  %-14s e %7.4f  omega %8.3f rad/s", m.model.c_str(), m.restitution, m.omega_rad_s);
      if (m.micro_impacts > 0) {
        text += say("  micro-impacts %d  dent %.2f um", m.micro_impacts, 1e6 * m.residual_m);
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace impactdic::report

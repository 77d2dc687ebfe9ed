#include "host/study/pattern_findings.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "sim/speckle/pattern.h"

namespace impactdic::study {
namespace {

// By what a pattern is judged: the motion of the ball as a whole and that of its windows alike.
double score(const PooledErrors& p) { return p.surface_rms_px * p.window_rms_px; }

// Patterns whose windows are now and then taken for others come last.
bool is_better_pattern(const PooledErrors& a, const PooledErrors& b) {
  constexpr double kWrong = 0.001;
  const auto flaws = [&](const PooledErrors& p) {
    return (p.failed_pairs > 0 ? 2 : 0) + (p.wrong_share > kWrong ? 1 : 0);
  };
  if (flaws(a) != flaws(b)) return flaws(a) < flaws(b);
  return score(a) < score(b);
}

// Fewer lost pairs first, then the smaller error.
bool is_better(const PooledErrors& a, const PooledErrors& b) {
  const auto lost = [](const PooledErrors& p) {
    return p.pairs > 0 ? static_cast<double>(p.failed_pairs) / p.pairs : 1.0;
  };
  if (lost(a) != lost(b)) return lost(a) < lost(b);
  return a.surface_rms_px < b.surface_rms_px;
}

// In the order in which they first appear.
std::vector<std::string> names_of(std::span<const PatternStudyRow> rows,
                                  std::string PatternStudyRow::*member) {
  std::vector<std::string> names;
  for (const PatternStudyRow& row : rows) {
    if (std::find(names.begin(), names.end(), row.*member) == names.end()) {
      names.push_back(row.*member);
    }
  }
  return names;
}

std::string what_it_is(const sim::speckle::PatternSpec& spec) {
  char text[120];
  if (spec.mean_area_px > 0) {
    std::snprintf(text, sizeof text, "round speckles of about %.0f px area, %.0f %% ink",
                  spec.mean_area_px, 100 * spec.density);
  } else {
    std::snprintf(text, sizeof text, "%s of %.0f to %.0f px area%s, %.0f %% ink",
                  spec.clusters ? "speckles of random shape" : "round speckles", spec.min_area_px,
                  spec.max_area_px, spec.lines > 0 ? " and a few thin lines" : "",
                  100 * spec.density);
  }
  return text;
}

std::string finding(const PooledErrors& best, const std::string& best_pattern,
                    const std::vector<std::string>& equals, const PooledErrors& worst,
                    const std::string& worst_pattern) {
  char text[500];
  std::snprintf(text, sizeof text,
                "Paint pattern %s (%s): %s measures its motion to %.4f px and %.4f deg a frame, "
                "and a window to %.4f px; on the worst, %s, to %.4f px, %.4f deg and %.4f px.",
                best_pattern.c_str(), what_it_is(sim::speckle::find_pattern(best_pattern)).c_str(),
                best.estimator.c_str(), best.motion_rms_px, best.rot_rms_deg, best.window_rms_px,
                worst_pattern.c_str(), worst.motion_rms_px, worst.rot_rms_deg, worst.window_rms_px);
  std::string sentence = text;
  for (std::size_t i = 0; i < equals.size(); ++i) {
    sentence += (i == 0 ? " Within the study's doubt as good: " : ", ") + equals[i];
  }
  return equals.empty() ? sentence : sentence + ".";
}

}  // namespace

PooledErrors pool(std::span<const PatternStudyRow> rows, const std::string& pattern_prefix,
                  const std::string& estimator, double radius_px) {
  PooledErrors pooled;
  pooled.estimator = estimator;
  double motion = 0, rotation = 0, shift = 0, window = 0, window_bound = 0, bound = 0,
         bound_rot = 0;
  double measured = 0, found = 0, windows = 0, clips = 0;
  for (const PatternStudyRow& row : rows) {
    if (row.estimator != estimator || !row.pattern.starts_with(pattern_prefix)) continue;
    const MotionErrors& e = row.errors;
    pooled.pairs += e.pairs;
    pooled.failed_pairs += e.failed_pairs;
    pooled.no_texture_share += e.no_texture;
    pooled.wrong_share += e.wrong;
    windows += e.windows;
    ++clips;
    bound += (std::pow(row.bound_dx_px, 2) + std::pow(row.bound_dy_px, 2)) / 2;
    bound_rot += std::pow(row.bound_rot_deg, 2);
    if (const double n = e.dx_px.count(); n > 0) {
      motion += n * (std::pow(e.dx_px.rms(), 2) + std::pow(e.dy_px.rms(), 2)) / 2;
      rotation += n * std::pow(e.rot_deg.rms(), 2);
      shift += n * std::pow(e.shift_px.rms(), 2);
      measured += n;
    }
    if (const double n = e.window_px.count(); n > 0) {
      window += n * std::pow(e.window_px.rms(), 2);
      window_bound += n * std::pow(e.window_bound_px.rms(), 2);
      found += n;
    }
  }
  pooled.motion_rms_px = std::sqrt(motion / measured);
  pooled.rot_rms_deg = std::sqrt(rotation / measured);
  pooled.shift_rms_px = std::sqrt(shift / measured);
  // Over a disc the mean square of the distance from the centre is R²/2, half of it along an axis.
  pooled.surface_rms_px =
      std::hypot(pooled.motion_rms_px, pooled.rot_rms_deg * kRadPerDeg * radius_px / 2);
  pooled.window_rms_px = std::sqrt(window / found);
  pooled.window_bound_px = std::sqrt(window_bound / found);
  pooled.no_texture_share /= windows;
  pooled.wrong_share /= windows;
  pooled.bound_px = std::sqrt(bound / clips);
  pooled.bound_deg = std::sqrt(bound_rot / clips);
  return pooled;
}

PatternFindings find_patterns(std::span<const PatternStudyRow> rows, double radius_px) {
  const auto patterns = names_of(rows, &PatternStudyRow::pattern);
  const auto estimators = names_of(rows, &PatternStudyRow::estimator);
  std::set<std::string> groups;
  for (const std::string& pattern : patterns) groups.insert(pattern.substr(0, 1));
  const auto pooled = [&](const std::string& prefix, const std::string& estimator) {
    return pool(rows, prefix, estimator, radius_px);
  };
  PatternFindings findings;
  findings.best_estimator = estimators.front();
  for (const std::string& estimator : estimators) {
    EstimatorErrors errors{estimator, pooled("", estimator), {}, {}};
    for (const std::string& group : groups) {
      errors.groups.emplace_back(group, pooled(group, estimator));
    }
    for (const std::string& pattern : patterns) {
      errors.patterns.emplace_back(pattern, pooled(pattern, estimator));
    }
    if (is_better(errors.all, pooled("", findings.best_estimator))) {
      findings.best_estimator = estimator;
    }
    findings.estimators.push_back(std::move(errors));
  }
  const auto of = [&](const std::string& pattern) {
    return pooled(pattern, findings.best_estimator);
  };
  const auto order = [&](const std::string& a, const std::string& b) {
    return is_better_pattern(of(a), of(b));
  };
  findings.best_pattern = *std::min_element(patterns.begin(), patterns.end(), order);
  const std::string worst = *std::max_element(patterns.begin(), patterns.end(), order);
  // An rms over n pairs and two axes is known to 1/√(4n); two such differ by chance up to twice it.
  const PooledErrors first = of(findings.best_pattern);
  const double doubt = 1 + 2 / std::sqrt(4.0 * first.pairs);
  for (const std::string& pattern : patterns) {
    PooledErrors allowed = of(pattern);
    allowed.surface_rms_px /= doubt;
    if (pattern != findings.best_pattern && !is_better_pattern(first, allowed)) {
      findings.as_good_patterns.push_back(pattern);
    }
  }
  findings.finding =
      finding(first, findings.best_pattern, findings.as_good_patterns, of(worst), worst);
  return findings;
}

}  // namespace impactdic::study

#include "host/study/study_case.h"

#include <impactdic/error.h>

namespace impactdic::study {

const std::vector<StudyMotion>& study_motions() {
  static const std::vector<StudyMotion> motions = {
      {"x", 1, 0, 0, true},
      {"xy", 1, 1, 0, true},
      {"turn", 0, 0, 3, true},
      {"general", 1, 1, 3, true},
      {"x_fraction", 0.37, 0, 0, false},
      {"xy_fraction", 0.37, -0.61, 0, false},
      {"turn_fraction", 0, 0, 1.7, false},
      {"general_fraction", 1.37, -0.61, 2.3, false},
  };
  return motions;
}

StudyEstimator parse_study_estimator(const std::string& name) {
  StudyEstimator made;
  made.name = name;
  FieldOptions& field = made.options.field;
  constexpr std::string_view kPublished = "published", kIcgn = "icgn";
  const char last = name.empty() ? ' ' : name.back();
  if (name == kPublished || (name.size() == kPublished.size() + 1 && name.starts_with(kPublished) &&
                             last >= '0' && last <= '9')) {
    field.method = FieldMethod::kPublished;
    if (name != kPublished) field.interp_points = last - '0';
    made.aimed = false;
  } else if (name == "zncc") {
    field.method = FieldMethod::kZncc;
  } else if (name.size() == kIcgn.size() + 1 && name.starts_with(kIcgn) &&
             (last == '3' || last == '5' || last == '7')) {
    field.method = FieldMethod::kIcgn;
    field.spline_degree = last - '0';
  } else if (name == "ring" || name == "ball") {
    made.options.estimator = parse_estimator(name);
  } else {
    throw InvalidArgument("'" + name + "' is not an estimator of the study", "--estimators",
                          "there are published (published0 … published9), zncc, icgn3, icgn5, "
                          "icgn7, ring and ball");
  }
  return made;
}

}  // namespace impactdic::study

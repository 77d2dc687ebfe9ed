#include <impactdic/study.h>

#include <vector>

#include "host/base/stopwatch.h"
#include "host/run/session.h"
#include "host/study/density_study.h"
#include "host/study/pattern_findings.h"
#include "host/study/pattern_study.h"

namespace impactdic {
namespace {

StudyDevice describe(Session& session) {
  const std::vector<opencl::Engine*> engines = session.impl().open_engines();
  const opencl::Device& device = engines.front()->device();
  return {device.name, device.platform, device.driver, engines.size()};
}

void tell_times(Session& session, const RunControl& control) {
  if (!session.options().profile || !control.message) return;
  control.message({MessageKind::kTiming, session.profile()});
}

}  // namespace

PatternStudyResult study_patterns(const PatternStudyRequest& request, Session& session,
                                  const RunControl& control) {
  request.validate();
  opencl::Engine& engine = *session.impl().open_engines().front();
  const Stopwatch watch;
  PatternStudyResult result;
  result.device = describe(session);
  result.rows = study::run_pattern_study(engine, request, control);
  result.cancelled = control.is_cancelled();
  if (!result.rows.empty()) {
    result.findings = study::find_patterns(result.rows, request.radius_px);
  }
  result.seconds = watch.seconds();
  tell_times(session, control);
  return result;
}

DensityStudyResult study_density(const DensityStudyRequest& request, Session& session,
                                 const RunControl& control) {
  request.validate();
  opencl::Engine& engine = *session.impl().open_engines().front();
  DensityStudyResult result = study::run_density_study(engine, request, control);
  result.device = describe(session);
  if (!result.rows.empty()) {
    result.findings = study::find_density(result.rows, request.window_px);
  }
  tell_times(session, control);
  return result;
}

}  // namespace impactdic

#include <impactdic/study.h>

#include <memory>

#include "host/base/stopwatch.h"
#include "host/opencl/engine.h"
#include "host/study/density_study.h"
#include "host/study/pattern_findings.h"
#include "host/study/pattern_study.h"

namespace impactdic {
namespace {

// The device of a study, and what is said of it.
class StudyEngine {
 public:
  StudyEngine(const std::string& device, bool profile) {
    std::string first = device;
    if (device == "all") {
      const auto all = opencl::all_devices(opencl::list_devices());
      described_.count = all.size();
      first = std::to_string(all.front().index);
    } else {
      described_.count = 1;
    }
    opencl::EngineOptions options;
    options.profile = profile;
    engine_ = std::make_unique<opencl::Engine>(first, options);
    described_.name = engine_->device().name;
    described_.platform = engine_->device().platform;
    described_.driver = engine_->device().driver;
  }

  opencl::Engine& engine() { return *engine_; }
  const StudyDevice& described() const { return described_; }
  void tell_times(const RunControl& control) {
    if (!engine_->profiler().enabled() || !control.message) return;
    control.message({MessageKind::timing, engine_->profiler().table()});
  }

 private:
  std::unique_ptr<opencl::Engine> engine_;
  StudyDevice described_;
};

}  // namespace

PatternStudyResult study_patterns(const PatternStudyRequest& request, const RunControl& control) {
  request.validate();
  StudyEngine device(request.device, request.profile);
  const Stopwatch watch;
  PatternStudyResult result;
  result.device = device.described();
  result.rows = study::run_pattern_study(device.engine(), request, control);
  result.cancelled = control.is_cancelled();
  if (!result.rows.empty()) {
    result.findings = study::find_patterns(result.rows, request.radius_px);
  }
  result.seconds = watch.seconds();
  device.tell_times(control);
  return result;
}

DensityStudyResult study_density(const DensityStudyRequest& request, const RunControl& control) {
  request.validate();
  StudyEngine device(request.device, request.profile);
  DensityStudyResult result = study::run_density_study(device.engine(), request, control);
  result.device = device.described();
  if (!result.rows.empty()) {
    result.findings = study::find_density(result.rows, request.window_px);
  }
  device.tell_times(control);
  return result;
}

}  // namespace impactdic

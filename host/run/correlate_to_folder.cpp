// `correlate` with files at its edge.
#include <impactdic/error.h>

#include <nlohmann/json.hpp>

#include "host/report/advice_json.h"
#include "host/report/csv.h"
#include "host/report/fields_file.h"
#include "host/report/summary.h"
#include "host/run/correlate_run.h"
#include "host/run/folder.h"
#include "host/run/open_clip.h"
#include "host/run/settings/job_file.h"

namespace impactdic {

void CorrelateFolder::validate() const {
  if (folder.empty()) throw InvalidArgument("the output folder has no name", "--output");
  run::check_compression(compression);
}

CorrelateResult correlate_to_folder(const CorrelateRequest& request, const CorrelateFolder& folder,
                                    Session& session, const RunControl& control) {
  folder.validate();
  run::Caller caller(control);
  CorrelateResult result;
  run::CorrelateRun run(request, session, caller, result);
  const auto path = run::prepare_folder(folder.folder, folder.force);
  run::SettingWriter settings;
  run::visit_correlate(settings, request, folder);
  report::Attributes attributes = run::attributes_of(session, run.info());
  settings.describe(attributes);
  run::visit_session(settings, session.options());
  run::write_job_file(path / "job.toml", "correlate", settings.values());
  run.look();

  run::DigestBeside digest(request.clip, run.info(), true);
  report::MotionCsv motion_csv(path / "motion.csv");
  auto fields = report::FieldsFile::create(path / "fields.h5", run.windows().size(),
                                           request.field.window_px, attributes, folder.compression);
  const auto finish = [&] {
    fields.flush();
    const video::ClipDigest found = digest.get();
    if (digest.wanted()) fields.set_source_digest(found);
    nlohmann::json summary = {{"input", report::describe_input(run.info(), found)},
                              {"device", run::describe_device(session)},
                              {"frames_analysed", result.rows.size()},
                              {"frames_measured", result.frames_measured},
                              {"windows", result.windows},
                              {"frames_per_s", result.frames_per_s},
                              {"advice", report::describe_advice(result.advice)},
                              {"warnings", result.warnings}};
    if (result.cancelled) summary["cancelled"] = true;
    report::write_json(path / "summary.json", summary);
  };
  try {
    run.measure([&](const MotionRow& row, std::span<const WindowMotion> field) {
      motion_csv.add(row);
      fields.add(row.frame, row.time_s, run.windows(), field, nullptr);
    });
  } catch (...) {
    finish();  // what was measured is kept
    throw;
  }
  finish();
  return result;
}

}  // namespace impactdic

#include <impactdic/batch.h>
#include <impactdic/track.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "host/python/arrays.h"
#include "host/python/field_columns.h"
#include "host/python/job.h"
#include "host/python/jobs.h"
#include "host/python/options.h"

namespace nb = nanobind;

namespace impactdic::python {
namespace {

nb::dict outcome_of(const TrackResult& result) {
  nb::dict outcome;
  outcome["cancelled"] = result.cancelled;
  outcome["frames"] = result.frames_measured;
  outcome["frames_ok"] = result.frames_ok;
  outcome["seconds"] = result.seconds;
  outcome["frames_per_s"] = result.frames_per_s;
  outcome["metre_per_px"] = result.scale.metre_per_px;
  outcome["warnings"] = nb::cast(result.warnings);
  return outcome;
}

nb::dict row_of(const TrackRow& row) {
  nb::dict values;
  values["frame"] = row.frame;
  values["time_s"] = row.time_s;
  values["status"] = to_string(row.status);
  const std::pair<const char*, double> numbers[] = {{"cx_px", row.cx_px},
                                                    {"cy_px", row.cy_px},
                                                    {"r_px", row.r_px},
                                                    {"cx_sd_px", row.cx_sd_px},
                                                    {"cy_sd_px", row.cy_sd_px},
                                                    {"r_sd_px", row.r_sd_px},
                                                    {"dx_px", row.dx_px},
                                                    {"dy_px", row.dy_px},
                                                    {"rot_deg", row.rot_deg},
                                                    {"dx_sd_px", row.dx_sd_px},
                                                    {"dy_sd_px", row.dy_sd_px},
                                                    {"rot_sd_deg", row.rot_sd_deg},
                                                    {"rot_x_deg", row.rot_x_deg},
                                                    {"rot_y_deg", row.rot_y_deg},
                                                    {"rim_off_x_px", row.rim_off_x_px},
                                                    {"rim_off_y_px", row.rim_off_y_px}};
  for (const auto& [name, value] : numbers) values[name] = value;
  values["windows"] = row.windows;
  return values;
}

// `on_frame(row, picture, field)`: in order, while the run goes on.
TrackSink sink_of(const nb::object& on_frame) {
  if (on_frame.is_none()) return {};
  return [&on_frame](const TrackedFrame& frame) {
    const nb::gil_scoped_acquire gil;
    FieldColumns field;
    field.add(frame.field);
    const std::vector<std::size_t> shape{static_cast<std::size_t>(frame.picture.height()),
                                         static_cast<std::size_t>(frame.picture.width())};
    const Frame& picture = frame.picture;
    const nb::object pixels =
        picture.type == PixelType::kU8
            ? to_numpy(std::vector(picture.u8.data(), picture.u8.data() + picture.u8.size()), shape)
            : to_numpy(std::vector(picture.u16.data(), picture.u16.data() + picture.u16.size()),
                       shape);
    on_frame(row_of(frame.row), pixels, field.take({frame.field.size()}));
  };
}

nb::dict track_clip(const PythonClip& clip, const nb::dict& options, const nb::dict& output,
                    Session& session, nb::object progress, nb::object message,
                    const nb::object& on_frame) {
  TrackRequest request;
  TrackFolder folder;
  folder.keep_rows = false;
  put_into(request.clip, clip);
  OptionReader reader(options);
  run::visit_reading(reader, request.clip);
  run::visit_track_settings(reader, request, folder);
  reader.finish("track");
  OptionReader place(output);
  place("folder", folder.folder);
  place("force", folder.force);
  place("resume", folder.resume);
  place.finish("track");
  if (clip.paths.empty()) folder.checksum = false;  // there is no file
  Job job({std::move(progress), std::move(message)});
  TrackResult result;
  const TrackSink sink = sink_of(on_frame);
  job.run([&](const RunControl& control) {
    result = track_to_folder(request, folder, session, control, sink);
  });
  return outcome_of(result);
}

nb::dict batch_folder(std::string folder, const nb::dict& options, const nb::dict& output,
                      Session& session, nb::object progress, nb::object message) {
  BatchRequest request;
  OptionReader reader(options);
  run::visit_batch(reader, request);
  reader.finish("batch");
  OptionReader place(output);
  place("folder", request.output.folder);
  place("force", request.output.force);
  place("resume", request.output.resume);
  place.finish("batch");
  request.folder = std::move(folder);
  Job job({std::move(progress), std::move(message)});
  BatchResult result;
  job.run([&](const RunControl& control) { result = batch(request, session, control); });
  nb::dict outcome;
  outcome["cancelled"] = result.cancelled;
  outcome["shots"] = result.shots.size();
  outcome["failed"] = result.failed;
  outcome["warnings"] = nb::cast(result.warnings);
  return outcome;
}

}  // namespace

void bind_track(nb::module_& module) {
  module.def("track", &track_clip, nb::arg("clip"), nb::arg("options"), nb::arg("output"),
             nb::arg("session"), nb::arg("progress").none(), nb::arg("message").none(),
             nb::arg("on_frame").none());
  module.def("batch", &batch_folder, nb::arg("folder"), nb::arg("options"), nb::arg("output"),
             nb::arg("session"), nb::arg("progress").none(), nb::arg("message").none());
}

}  // namespace impactdic::python

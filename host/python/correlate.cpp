#include <impactdic/correlate.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "host/python/arrays.h"
#include "host/python/field_columns.h"
#include "host/python/job.h"
#include "host/python/jobs.h"
#include "host/python/options.h"

namespace nb = nanobind;

namespace impactdic::python {
namespace {

using Mask = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

void put_mask(CorrelateRequest& request, const nb::object& mask) {
  if (mask.is_none()) return;
  Mask pixels;
  if (!nb::try_cast(mask, pixels, false)) {
    throw InvalidArgument("must be an array of uint8 of the shape (height, width)", "mask");
  }
  Image<std::uint8_t> picture(static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)));
  std::memcpy(picture.data(), pixels.data(), picture.size());
  request.mask_picture = std::move(picture);
}

// One value a row.
nb::dict columns_of(const std::vector<MotionRow>& rows) {
  nb::dict columns;
  const auto numbers = [&](const char* name, double MotionRow::*member) {
    std::vector<double> values;
    for (const MotionRow& row : rows) values.push_back(row.*member);
    columns[name] = to_numpy(std::move(values));
  };
  std::vector<std::int64_t> frames, windows;
  std::vector<std::string> status;
  for (const MotionRow& row : rows) {
    frames.push_back(row.frame);
    windows.push_back(row.windows);
    status.emplace_back(to_string(row.status));
  }
  columns["frame"] = to_numpy(std::move(frames));
  numbers("time_s", &MotionRow::time_s);
  columns["status"] = nb::cast(status);
  numbers("dx_px", &MotionRow::dx_px);
  numbers("dy_px", &MotionRow::dy_px);
  numbers("rot_deg", &MotionRow::rot_deg);
  numbers("dx_sd_px", &MotionRow::dx_sd_px);
  numbers("dy_sd_px", &MotionRow::dy_sd_px);
  numbers("rot_sd_deg", &MotionRow::rot_sd_deg);
  columns["windows"] = to_numpy(std::move(windows));
  numbers("dx_m", &MotionRow::dx_m);
  numbers("dy_m", &MotionRow::dy_m);
  numbers("plane_rot_deg", &MotionRow::plane_rot_deg);
  numbers("dx_sd_m", &MotionRow::dx_sd_m);
  numbers("dy_sd_m", &MotionRow::dy_sd_m);
  numbers("plane_rot_sd_deg", &MotionRow::plane_rot_sd_deg);
  return columns;
}

// The field of every frame but the reference, whose motion is zero by definition.
nb::dict correlate_clip(const PythonClip& clip, const nb::dict& options, const nb::dict& output,
                        const nb::object& mask, Session& session, nb::object progress,
                        nb::object message) {
  CorrelateRequest request;
  CorrelateFolder folder;
  put_mask(request, mask);
  OptionReader reader(options);
  run::visit_correlate(reader, request, folder);
  reader.finish("correlate");
  OptionReader place(output);
  place("folder", folder.folder);
  place("force", folder.force);
  place("resume", folder.resume);
  place.finish("correlate");
  put_into(request.clip, clip);
  Job job({std::move(progress), std::move(message)});
  CorrelateResult result;
  FieldColumns field;
  std::vector<std::int64_t> frames;
  job.run([&](const RunControl& control) {
    if (!folder.folder.empty()) {
      result = correlate_to_folder(request, folder, session, control);
      return;
    }
    result = correlate(request, session, control, [&](const CorrelatedFrame& frame) {
      if (frame.field.empty()) return;
      frames.push_back(frame.row.frame);
      field.add(frame.field);
    });
  });
  nb::dict outcome;
  outcome["cancelled"] = result.cancelled;
  outcome["fps"] = result.fps;
  outcome["warnings"] = nb::cast(result.warnings);
  outcome["roi"] = nb::make_tuple(result.roi.x, result.roi.y, result.roi.width, result.roi.height);
  outcome["motion"] = columns_of(result.rows);
  const std::size_t count = frames.size();
  outcome["field_frames"] = to_numpy(std::move(frames));
  outcome["field"] = field.take({count, count > 0 ? result.windows : 0});
  return outcome;
}

}  // namespace

void bind_correlate(nb::module_& module) {
  module.def("correlate", &correlate_clip, nb::arg("clip"), nb::arg("options"), nb::arg("output"),
             nb::arg("mask").none(), nb::arg("session"), nb::arg("progress").none(),
             nb::arg("message").none());
}

}  // namespace impactdic::python

#include <impactdic/error.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <future>
#include <nlohmann/json.hpp>

#include "host/app/advice_output.h"
#include "host/app/command.h"
#include "host/app/field_options.h"
#include "host/app/job.h"
#include "host/app/run_context.h"
#include "host/app/video_options.h"
#include "host/base/log.h"
#include "host/pipeline/correlate_clip.h"
#include "host/report/csv.h"
#include "host/report/fields_file.h"
#include "host/report/summary.h"

namespace impactdic::app {
namespace {

struct Request {
  Common common;
  VideoRequest video;
  FieldRequest field;
  std::string output, frames, roi, reference = "first", mask, polygon, motion = "windows";
};

ReferenceFrame parse_reference(const std::string& word) {
  if (word == "first") return ReferenceFrame::first;
  if (word == "previous") return ReferenceFrame::previous;
  throw InvalidArgument("'" + word + "' is not a reference", "--reference", "first or previous");
}

RegionMotion parse_motion(const std::string& word) {
  if (word == "windows") return RegionMotion::windows;
  if (word == "region") return RegionMotion::region;
  throw InvalidArgument("'" + word + "' is no way to measure the motion", "--motion",
                        "windows or region");
}

Image<std::uint8_t> read_mask(const std::string& path, const ClipInfo& clip) {
  if (path.empty()) return {};
  VideoRequest request;
  request.inputs = {path};
  const auto source = open_requested(request);
  if (source->info().width != clip.width || source->info().height != clip.height) {
    throw InvalidArgument("the mask has another size than the clip", path);
  }
  Frame frame;
  source->read(0, frame);
  Image<std::uint8_t> mask(frame.width(), frame.height());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask.data()[i] =
        frame.type == PixelType::u8 ? frame.u8.data()[i] != 0 : frame.u16.data()[i] != 0;
  }
  return mask;
}

// What both leave: the mask's picture and the polygon.
Image<std::uint8_t> resolve_mask(const Request& request, const ClipInfo& clip) {
  Image<std::uint8_t> mask = read_mask(request.mask, clip);
  if (request.polygon.empty()) return mask;
  const Image<std::uint8_t> polygon = parse_polygon(request.polygon, clip.width, clip.height);
  if (mask.size() == 0) return polygon;
  for (std::size_t i = 0; i < mask.size(); ++i) mask.data()[i] &= polygon.data()[i];
  return mask;
}

// The rectangle asked for; without one, all of the picture in which every window's search area lies
// inside too, so that no window is lost at the picture's edge.
Roi resolve_roi(const std::string& text, const ClipInfo& info, int search_px) {
  if (!text.empty()) return parse_roi(text, info.width, info.height);
  const int margin = std::min({search_px, (info.width - 1) / 2, (info.height - 1) / 2});
  return {margin, margin, info.width - 2 * margin, info.height - 2 * margin};
}

ClipAdvice look_at(FrameSource& source, const pipeline::CorrelateOptions& options) {
  advice::AdviceRequest request;
  request.ball = false;
  request.frames = options.frames;
  request.roi = options.roi;
  request.field = options.field;
  return advice::advise_clip(source, request);
}

void run_correlate(const CLI::App& command, const Request& request) {
  const auto source = open_requested(request.video);
  const ClipInfo& info = source->info();
  pipeline::CorrelateOptions options;
  options.field = resolve(request.field);
  options.spacing_px = request.field.spacing_px;
  options.frames = parse_frame_range(request.frames, info.frame_count);
  options.mask = resolve_mask(request, info);
  options.roi = request.roi.empty() && !request.polygon.empty()
                    ? extent(options.mask)
                    : resolve_roi(request.roi, info, options.field.search_px);
  options.reference = parse_reference(request.reference);
  options.motion = parse_motion(request.motion);
  options.fps = resolve_fps(request.video, info, "");
  if (options.frames.count() < 2) {
    throw InvalidArgument("a displacement needs two frames", info.path,
                          "several pictures form a sequence");
  }
  std::vector<Window> windows = pipeline::region_grid(options);
  RunContext run(request.common);
  const auto folder = prepare_output_directory(request.output, request.common.force);
  write_job(command, folder / "job.toml");

  const ClipAdvice advice = look_at(*source, options);
  if (advice.texture) options.field.noise = advice.texture->noise;
  const std::vector<std::string> warnings = all_warnings(request.video, info, advice);
  if (!request.common.quiet) print_advice(advice, warnings);

  std::future<video::ClipDigest> digest =
      std::async(std::launch::async, video::digest_of, std::cref(info), video::kDigestPiece);
  report::Attributes attributes = run.attributes(info);
  describe(request.field, attributes);
  attributes["option_reference"] = request.reference;
  attributes["option_motion"] = request.motion;
  report::MotionCsv motion_csv(folder / "motion.csv");
  auto fields =
      report::FieldsFile::create(folder / "fields.h5", windows.size(), options.field.window_px,
                                 attributes, request.field.compression);
  options.times = run.stage_times();
  int measured = 0;
  Stopwatch watch;
  {
    TerminalProgress progress("correlate", request.common.quiet);
    pipeline::correlate_clip(
        *source, run.engine(), options,
        [&](const pipeline::CorrelatedFrame& frame) {
          motion_csv.add(frame);
          fields.add(frame.frame, frame.time_s, windows, frame.field, nullptr);
          if (!frame.is_reference && frame.status == TrackStatus::ok) ++measured;
        },
        std::ref(progress));
  }
  fields.flush();
  const double wall_s = watch.seconds();
  const double rate = static_cast<double>(options.frames.count()) / wall_s;
  const video::ClipDigest found = digest.get();
  fields.set_source_digest(found);
  nlohmann::json summary = {{"input", report::describe_input(info, found)},
                            {"device", run.describe()},
                            {"frames_analysed", options.frames.count()},
                            {"frames_measured", measured},
                            {"windows", windows.size()},
                            {"frames_per_s", rate},
                            {"advice", describe_advice(advice)},
                            {"warnings", warnings}};
  report::write_json(folder / "summary.json", summary);
  if (!request.common.quiet) {
    std::printf("%d of %lld frames measured with %zu windows, %.1f frames/s; results in %s\n",
                measured, static_cast<long long>(options.frames.count() - 1), windows.size(), rate,
                folder.string().c_str());
  }
  run.print_stages(wall_s, options.frames.count());
  run.print_profile();
}

}  // namespace

void add_correlate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "correlate", "Full-field displacement of any speckled surface, from frame to frame");
  auto request = std::make_shared<Request>();
  add_video_options(*command, request->video);
  command->add_option("-o,--output", request->output, "Folder for the results")->required();
  command->add_option("--reference", request->reference, "Measure against: first or previous")
      ->capture_default_str();
  command->add_option(
      "--roi", request->roi,
      "X,Y,W,H: the rectangle that is measured, px; without it, the picture less the "
      "search radius");
  command->add_option("--mask", request->mask, "Picture: only its non-zero pixels are measured");
  command->add_option("--polygon", request->polygon,
                      "X,Y,X,Y,X,Y...: corners, px; only pixels inside are measured");
  command
      ->add_option("--motion", request->motion,
                   "Rigid motion of the region: windows (robust fit to their displacements) or "
                   "region (one registration of all its pixels, for rigid bodies)")
      ->capture_default_str();
  command->add_option("--frames", request->frames, "A:B[:STEP]: frames analysed, B excluded");
  add_field_options(*command, request->field);
  add_common_options(*command, request->common);
  command->footer(
      "Writes motion.csv (rigid motion of the region about its centre), fields.h5, summary.json "
      "and job.toml.\nExample:\n  impactdic correlate plate.tif --roi 100,80,200,200 -o results\n");
  command->callback([command, request] { run_correlate(*command, *request); });
}

}  // namespace impactdic::app

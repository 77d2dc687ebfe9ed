// A camera from pictures of a target, with files at its edge.
#include <impactdic/camera/calibrate.h>
#include <impactdic/error.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "host/base/parallel/parallel_for.h"
#include "host/run/control.h"
#include "host/run/open_clip.h"
#ifdef IMPACTDIC_WITH_CALIBRATION
#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/calibrate/find_target.h"
#endif

namespace impactdic {
namespace {

namespace fs = std::filesystem;

#ifdef IMPACTDIC_WITH_CALIBRATION

constexpr std::int64_t kMostPictures = 1000;

// One frame of one of the files that were named.
struct Source {
  std::string name;
  std::shared_ptr<FrameSource> clip;
  std::int64_t frame = 0;
};

std::vector<Source> open_pictures(const CalibrateRequest& request) {
  std::vector<Source> sources;
  for (const std::string& path : request.pictures) {
    ClipRequest one;
    one.paths = {path};
    one.open = request.open;
    const std::shared_ptr<FrameSource> clip = run::open_requested(one);
    const ClipInfo& info = clip->info();
    for (std::int64_t i = 0; i < info.frame_count; ++i) {
      std::string name = path;
      const auto at = static_cast<std::size_t>(i);
      if (at < info.files.size()) {
        name = info.files[at];
      } else if (info.frame_count > 1) {
        name += "#" + std::to_string(i);
      }
      sources.push_back({std::move(name), clip, i});
    }
    if (static_cast<std::int64_t>(sources.size()) > kMostPictures) {
      throw InvalidArgument("more than " + std::to_string(kMostPictures) + " pictures", path,
                            "some 5 to 30 will do");
    }
  }
  const ClipInfo& first = sources.at(0).clip->info();
  for (const Source& source : sources) {
    const ClipInfo& info = source.clip->info();
    if (info.width == first.width && info.height == first.height) continue;
    throw InvalidArgument("the picture has another size than the first", source.name);
  }
  return sources;
}

CalibrateResult find_camera(const CalibrateRequest& request, const RunControl& control) {
  request.validate();
  const std::vector<Source> sources = open_pictures(request);
  const ClipInfo& info = sources.front().clip->info();
  if (request.target == CalibrationTarget::kRuler) {
    const Source& picture = sources.front();
    if (!request.marks.empty()) {
      return camera::calibrate_marks(request, picture.name, info.width, info.height);
    }
    Frame frame;
    picture.clip->read(picture.frame, frame);
    return camera::calibrate_ticks(request, picture.name, camera::to_grey(frame));
  }
  std::vector<camera::View> views(sources.size());
  const std::vector<char> done =
      parallel_pieces(sources.size(), 0, "calibrate", control, [&](std::size_t i) {
        Frame frame;
        sources[i].clip->read(sources[i].frame, frame);
        views[i] = {sources[i].name, camera::find_target(camera::to_grey(frame), request)};
      });
  for (const char one : done) {
    if (!one) throw Error("the calibration was stopped");
  }
  const auto levels_of = [&](std::size_t i) {
    Frame frame;
    sources[i].clip->read(sources[i].frame, frame);
    return frame.to_float();
  };
  return camera::calibrate_pictures(request, views, info.width, info.height, levels_of, control);
}

void write_drawing(const fs::path& path, const CalibrateResult& result) {
  std::ofstream file(path);
  file << camera::draw_residuals(result);
  file.flush();
  if (!file) throw FileError("cannot write the drawing", path.string());
}

#else

CalibrateResult find_camera(const CalibrateRequest& request, const RunControl&) {
  request.validate();
  throw Error("this build has no calibration", "calibrate", "build it with IMPACTDIC_CALIBRATION");
}

void write_drawing(const fs::path&, const CalibrateResult&) {}

#endif

}  // namespace

CalibrateResult calibrate(const CalibrateRequest& request, const RunControl& control) {
  return find_camera(request, control);
}

CalibrateResult calibrate_to_file(const CalibrateRequest& request, const std::string& path,
                                  bool force, const RunControl& control) {
  if (path.empty()) throw InvalidArgument("the file has no name", "--output");
  if (!force && fs::exists(path)) {
    throw InvalidArgument("the file is there already", path, "--force writes over it");
  }
  CalibrateResult result = find_camera(request, control);
  run::Caller caller(control);
  for (const CalibrationPicture& picture : result.pictures) {
    if (!picture.used) {
      caller.say(MessageKind::kWarning, picture.name + " is not used: " + picture.reason);
    }
  }
  write_camera(result.camera, path);
  write_drawing(fs::path(path).replace_extension(".svg"), result);
  return result;
}

}  // namespace impactdic

#include "host/report/picture/overlay_files.h"

#include <impactdic/error.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "host/report/picture/png.h"
#include "host/video/codec_module.h"

namespace impactdic::report {
namespace {

constexpr double kUsualRate = 25, kHighestRate = 60;  // frames/s of the video

// How fast the video plays, and which frames it shows.
struct Playback {
  double rate = kUsualRate;
  std::size_t step = 1;
};

Playback playback(const OverlayOptions& options, double fps) {
  if (options.slow_motion <= 0 || fps <= 0) return {};
  Playback play;
  const double all = fps / options.slow_motion;
  play.step = static_cast<std::size_t>(std::max(1.0, std::ceil(all / kHighestRate)));
  play.rate = all / static_cast<double>(play.step);
  return play;
}

// The overlay as one file, where there are codecs; the pictures are there anyway.
class Video {
 public:
  Video(std::filesystem::path path, double rate) : path_(std::move(path)), rate_(rate) {}
  void add(const ColourPicture& picture) {
    if (!video::has_codecs()) return;
    if (!writer_) {
      writer_ = video::codec_module(path_.string(), "")
                    .open_mp4(path_.string(), picture.width, picture.height, rate_);
    }
    writer_->write(picture.bgr.data(), std::ptrdiff_t{3} * picture.width);
  }
  void finish() {
    if (writer_) writer_->finish();
  }

 private:
  std::filesystem::path path_;
  double rate_;
  std::unique_ptr<video::ColourSink> writer_;
};

template <typename... Numbers>
std::string print(const char* format, Numbers... numbers) {
  char text[80];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

// To `digits` decimals, without the sign of a zero.
double rounded(double value, int digits) {
  const double power = std::pow(10.0, digits);
  return std::round(value * power) / power + 0.0;
}

const char* phase_of(const TrackRow& row, const ImpactFigures& impact) {
  if (!impact.t0.known() || !impact.t_max_compression.known() || !impact.t_end.known()) return "";
  const auto passed = [&](const ImpactInstant& instant) {
    return static_cast<double>(row.frame) >= instant.frame;
  };
  if (passed(impact.t_end)) return "after the contact";
  if (passed(impact.t_max_compression)) return "restitution";
  return passed(impact.t0) ? "compression" : "before the contact";
}

std::vector<std::string> label(const TrackResult& result, std::size_t index) {
  const TrackRow& row = result.rows[index];
  std::vector<std::string> lines(2);
  if (result.scale.fps > 0) lines[0] = print("%.2f ms  ", 1e3 * row.time_s);
  lines[0] += phase_of(row, result.impact_si);
  if (!row.motion_ok) return lines;
  const SiRow si = to_si(result, index);
  lines[1] = std::isfinite(si.vt_m_s)
                 ? print("vt %.2f vn %.2f m/s", rounded(si.vt_m_s, 2), rounded(si.vn_m_s, 2))
                 : print("dx %.2f dy %.2f px", rounded(row.dx_px, 2), rounded(row.dy_px, 2));
  lines[1] += std::isfinite(si.omega_rad_s) ? print(" spin %.1f rad/s", rounded(si.omega_rad_s, 1))
                                            : print(" spin %.2f deg", rounded(row.rot_deg, 2));
  return lines;
}

}  // namespace

OverlayFiles::OverlayFiles(std::filesystem::path folder, const OverlayOptions& options,
                           const Roi& roi, std::span<const TrackRow> earlier)
    : folder_(std::move(folder)),
      options_(options),
      painter_(options.arrow_scale, roi.x, roi.y, earlier) {
  std::error_code error;
  std::filesystem::create_directories(folder_ / "overlay", error);
  if (error) throw FileError("cannot make the folder", (folder_ / "overlay").string());
}

std::filesystem::path OverlayFiles::picture_of(const TrackRow& row) const {
  return folder_ / "overlay" / print("frame_%06lld.png", static_cast<long long>(row.frame));
}

void OverlayFiles::add(const pipeline::TrackedFrame& frame, int window_px) {
  std::span<const Window> windows;
  std::span<const WindowMotion> field;
  if (frame.pair != nullptr) {
    windows = frame.pair->windows;
    field = frame.pair->field;
  }
  const ColourPicture picture = painter_.paint(frame.frame, frame.row, windows, field, window_px);
  write_png_bgr(picture_of(frame.row), picture.width, picture.height, picture.bgr);
}

void OverlayFiles::finish(const TrackResult& result) const {
  const std::vector<TrackRow>& rows = result.rows;
  const Playback play = playback(options_, result.scale.fps);
  PictureScale scale{1e3 * result.scale.metre_per_px, 0, painter_.arrow_scale()};
  scale.m_s_per_px = result.scale.metre_per_px * result.scale.fps;
  Video video(folder_ / "overlay.mp4", play.rate);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::filesystem::path path = picture_of(rows[i]);
    if (!std::filesystem::exists(path)) continue;  // of a run without overlay that was resumed
    ColourPicture picture;
    picture.bgr = read_png_bgr(path, picture.width, picture.height);
    write_label(picture, label(result, i));
    write_scale(picture, scale);
    write_png_bgr(path, picture.width, picture.height, picture.bgr);
    if (i % play.step == 0) video.add(picture);
  }
  video.finish();
}

}  // namespace impactdic::report

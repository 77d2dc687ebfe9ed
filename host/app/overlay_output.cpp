#include "host/app/overlay_output.h"

#include <cstdio>

#include "host/base/error.h"
#include "host/report/png.h"
#ifdef IMPACTDIC_WITH_CODECS
#include "host/video/codec/codec.h"
#endif

namespace impactdic::app {

// The MP4 plays slowly enough to be looked at, whatever the camera's rate was.
struct OverlayOutput::Video {
#ifdef IMPACTDIC_WITH_CODECS
  static constexpr double kPlaybackFps = 25;
  std::unique_ptr<Mp4Writer> writer;
  void add(const std::filesystem::path& path, const ColourPicture& picture) {
    if (!writer) {
      writer = std::make_unique<Mp4Writer>(path.string(), picture.width, picture.height,
                                           kPlaybackFps);
    }
    writer->write(picture.bgr.data(), std::ptrdiff_t{3} * picture.width);
  }
  void finish() {
    if (writer) writer->finish();
  }
#else
  void add(const std::filesystem::path&, const ColourPicture&) {}
  void finish() {}
#endif
};

OverlayOutput::OverlayOutput(std::filesystem::path folder)
    : folder_(std::move(folder)), video_(std::make_unique<Video>()) {
  std::error_code error;
  std::filesystem::create_directories(folder_ / "overlay", error);
  if (error) throw FileError("cannot make the folder", (folder_ / "overlay").string());
}

OverlayOutput::~OverlayOutput() = default;

void OverlayOutput::add(const TrackedFrame& frame, const Roi& roi, int window_px) {
  std::span<const Window> windows;
  std::span<const WindowMotion> field;
  if (frame.pair != nullptr) {
    windows = frame.pair->windows;
    field = frame.pair->field;
  }
  const ColourPicture picture =
      painter_.paint(frame.frame, roi.x, roi.y, frame.row, windows, field, window_px);
  char name[40];
  std::snprintf(name, sizeof name, "frame_%06lld.png", static_cast<long long>(frame.row.frame));
  write_png_bgr(folder_ / "overlay" / name, picture.width, picture.height, picture.bgr);
  video_->add(folder_ / "overlay.mp4", picture);
}

void OverlayOutput::finish() { video_->finish(); }

}  // namespace impactdic::app

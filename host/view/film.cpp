#include "host/view/film.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/base/private_folder.h"
#include "host/report/csv.h"
#include "host/report/picture/overlay.h"
#include "host/video/codec_module.h"
#include "host/view/page_request.h"

namespace impactdic::view {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostPictures = 1000;
constexpr double kHighestRate = 120, kArrowScale = 5;

// What the folder of results knows of the shot.
struct Measured {
  std::map<std::int64_t, TrackRow> rows;  // by frame
  report::PictureScale scale{0, 0, kArrowScale};
};

Measured read_results(const fs::path& folder) {
  Measured found;
  if (folder.empty() || !fs::is_regular_file(folder / "track.csv")) return found;
  for (const TrackRow& row : report::read_track_csv(folder / "track.csv")) {
    found.rows[row.frame] = row;
  }
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  const auto number = [&](const char* key) {
    const bool known = summary.is_object() && summary.contains(key) && summary[key].is_number();
    return known ? summary[key].get<double>() : 0.0;
  };
  found.scale.mm_per_px = 1e3 * number("scale_m_per_px");
  found.scale.m_s_per_px = number("scale_m_per_px") * number("analysed_fps");
  return found;
}

// The windows of a frame as the painter takes them; its places are whole pixels.
struct Field {
  std::vector<Window> windows;
  std::vector<WindowMotion> motions;
};

Field field_of(const FieldFrames* fields, std::int64_t frame) {
  Field field;
  if (fields == nullptr) return field;
  const auto& frames = fields->frames();
  const auto at = std::find(frames.begin(), frames.end(), frame);
  if (at == frames.end()) return field;
  const std::vector<float> values = fields->frame(static_cast<std::size_t>(at - frames.begin()));
  const std::size_t count = fields->windows();
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isfinite(values[k]) || !std::isfinite(values[count + k])) continue;
    Window window{};
    window.x0 = static_cast<int>(std::lround(values[k]));
    window.y0 = static_cast<int>(std::lround(values[count + k]));
    WindowMotion motion{};
    motion.u = values[2 * count + k];
    motion.v = values[3 * count + k];
    motion.status = static_cast<idic_int>(values[(FieldFrames::kColumns.size() - 1) * count + k]);
    field.windows.push_back(window);
    field.motions.push_back(motion);
  }
  return field;
}

// As the page shows it: its grey levels stretched.
Frame stretched(const Frame& frame, const Contrast& contrast) {
  const std::string bytes = bytes_of_picture(frame, contrast, 1);
  Frame shown;
  shown.reset(frame.width(), frame.height(), 8);
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(shown.u8.data()));
  return shown;
}

// Sides rounded down to even numbers, as the painter's.
report::ColourPicture plain(const Frame& frame) {
  report::ColourPicture picture{frame.width() & ~1, frame.height() & ~1, {}};
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = frame.u8.row(y);
    for (int x = 0; x < picture.width; ++x) picture.bgr.insert(picture.bgr.end(), 3, row[x]);
  }
  return picture;
}

std::string time_of(const TrackRow& row) {
  char text[40] = "";
  if (std::isfinite(row.time_s)) std::snprintf(text, sizeof text, "%.2f ms", 1e3 * row.time_s);
  return text;
}

}  // namespace

void FilmRequest::validate() const {
  if (first < 0 || end <= first || step < 1) throw InvalidArgument("holds no frame", "frames");
  if ((end - first + step - 1) / step > kMostPictures) {
    throw InvalidArgument("a film has at most " + std::to_string(kMostPictures) + " pictures",
                          "frames", "take fewer of them, or a larger step");
  }
  if (!(rate >= 1 && rate <= kHighestRate)) throw InvalidArgument("must be 1 to 120", "rate");
}

std::string film_of(Shot& shot, const FilmRequest& request) {
  request.validate();
  if (!shot.source()) throw NotThere(shot.clip_error());
  if (!video::has_codecs()) throw NotThere("this program was built without codecs");
  if (request.end > shot.source()->info().frame_count) {
    throw InvalidArgument("the clip has no such frame", "frames");
  }
  const Measured measured = read_results(shot.folder());
  const auto fields = shot.fields();
  const ScratchFolder scratch;
  const std::string path = (scratch.path() / "film.mp4").string();
  std::unique_ptr<video::ColourSink> sink;
  report::OverlayPainter painter(kArrowScale, 0, 0);
  Frame frame;
  for (std::int64_t k = request.first; k < request.end; k += request.step) {
    shot.source()->read(k, frame);
    const Frame shown = stretched(frame, request.contrast);
    const auto row = measured.rows.find(k);
    report::ColourPicture picture;
    if (row == measured.rows.end()) {
      picture = plain(shown);
    } else {
      const Field field = field_of(fields.get(), k);
      picture = painter.paint(shown, row->second, field.windows, field.motions, 1);
      report::write_label(picture, {time_of(row->second)});
      report::write_scale(picture, measured.scale);
    }
    if (!sink) {
      sink =
          video::codec_module(path, "").open_mp4(path, picture.width, picture.height, request.rate);
    }
    sink->write(picture.bgr.data(), std::ptrdiff_t{3} * picture.width);
  }
  sink->finish();
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace impactdic::view

#include "host/view/shot.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <vector>

#include "host/run/open_clip.h"
#include "host/view/page_request.h"

namespace impactdic::view {
namespace {

namespace fs = std::filesystem;

constexpr std::array kTextFiles = {"track.csv", "pose.csv",  "motion.csv",
                                   "job.toml",  "shots.csv", "summary.json"};
constexpr char kResiduals[] = "residuals.csv";
constexpr double kCutShare = 0.002;  // of the pixels, at either end

template <typename T>
std::vector<std::size_t> histogram(const Image<T>& picture, int bits) {
  std::vector<std::size_t> counts(std::size_t{1} << bits);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    ++counts[std::min<std::size_t>(picture.data()[i], counts.size() - 1)];
  }
  return counts;
}

// The byte of every grey level.
std::vector<unsigned char> table_of_bytes(int bits, const Contrast& contrast) {
  std::vector<unsigned char> bytes(std::size_t{1} << bits);
  const double range = std::max(contrast.white - contrast.black, 1e-9);
  for (std::size_t level = 0; level < bytes.size(); ++level) {
    const double share = (static_cast<double>(level) - contrast.black) / range;
    bytes[level] = static_cast<unsigned char>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
  }
  return bytes;
}

template <typename T>
void show(const Image<T>& picture, const std::vector<unsigned char>& bytes, int shrink,
          std::string& out) {
  const int width = picture.width() / shrink, height = picture.height() / shrink;
  out.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const std::size_t brightest = bytes.size() - 1;
  char* to = out.data();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::size_t sum = 0;
      for (int j = 0; j < shrink; ++j) {
        const T* from = picture.row(y * shrink + j) + static_cast<std::ptrdiff_t>(x) * shrink;
        sum = std::accumulate(from, from + shrink, sum);
      }
      const std::size_t mean = sum / (static_cast<std::size_t>(shrink) * shrink);
      *to++ = static_cast<char>(bytes[std::min(mean, brightest)]);
    }
  }
}

template <typename T>
void show_whole(const Image<T>& picture, const std::vector<unsigned char>& bytes,
                std::string& out) {
  out.resize(picture.size());
  const std::size_t brightest = bytes.size() - 1;
  std::transform(picture.data(), picture.data() + picture.size(), out.begin(), [&](T level) {
    return static_cast<char>(bytes[std::min<std::size_t>(level, brightest)]);
  });
}

}  // namespace

Contrast stretched_contrast(const Frame& frame) {
  const auto counts = frame.type == PixelType::kU8 ? histogram(frame.u8, frame.bits)
                                                   : histogram(frame.u16, frame.bits);
  const double all =
      static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
  Contrast contrast{0, static_cast<double>(counts.size() - 1)};
  double below = 0;
  bool dark = true;
  for (std::size_t level = 0; level < counts.size(); ++level) {
    below += static_cast<double>(counts[level]);
    if (dark && below > kCutShare * all) {
      contrast.black = static_cast<double>(level);
      dark = false;
    }
    if (below >= (1 - kCutShare) * all) {
      contrast.white = std::max(static_cast<double>(level), contrast.black + 1);
      break;
    }
  }
  return contrast;
}

std::string bytes_of_picture(const Frame& frame, const Contrast& contrast, int shrink) {
  const auto bytes = table_of_bytes(frame.bits, contrast);
  std::string out;
  const bool small = frame.type == PixelType::kU8;
  if (shrink == 1) {
    small ? show_whole(frame.u8, bytes, out) : show_whole(frame.u16, bytes, out);
  } else {
    small ? show(frame.u8, bytes, shrink, out) : show(frame.u16, bytes, shrink, out);
  }
  return out;
}

Shot::Shot(ClipRequest clip, fs::path folder, fs::path residuals)
    : clip_(std::move(clip)), residuals_(std::move(residuals)), folder_(std::move(folder)) {
  try {
    source_ = run::open_requested(clip_);
    if (source_->info().frame_count < 1) {
      throw InvalidArgument("the clip has no frames", source_->info().path);
    }
    Frame first;
    source_->read(0, first);
    contrast_ = stretched_contrast(first);
  } catch (const Error& error) {
    clip_error_ = error.line();
    source_.reset();
  }
}

std::string Shot::picture(std::int64_t frame, const Contrast& contrast, int shrink) const {
  if (!source_) throw NotThere(clip_error_);
  const ClipInfo& info = source_->info();
  if (frame < 0 || frame >= info.frame_count) {
    throw NotThere("the clip has no frame " + std::to_string(frame), info.path);
  }
  if (shrink < 1 || shrink > std::min(info.width, info.height)) {
    throw InvalidArgument("no picture is shrunk so far", "shrink");
  }
  thread_local Frame picture;
  source_->read(frame, picture);
  return bytes_of_picture(picture, contrast, shrink);
}

fs::path Shot::folder() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return folder_;
}

void Shot::set_folder(const fs::path& folder) {
  const std::lock_guard<std::mutex> lock(mutex_);
  folder_ = folder;
  fields_.reset();
}

std::string Shot::text(const std::string& name) const {
  const bool known = std::find(kTextFiles.begin(), kTextFiles.end(), name) != kTextFiles.end();
  const fs::path folder = this->folder();
  std::ifstream file;
  if (known && !folder.empty()) file.open(folder / name, std::ios::binary);
  if (name == kResiduals && !residuals_.empty()) file.open(residuals_, std::ios::binary);
  if (!file.is_open()) throw NotThere("there is no such file of results");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> Shot::text_files() const {
  const fs::path folder = this->folder();
  std::vector<std::string> names;
  for (const char* name : kTextFiles) {
    if (!folder.empty() && fs::is_regular_file(folder / name)) names.emplace_back(name);
  }
  if (!residuals_.empty() && fs::is_regular_file(residuals_)) names.emplace_back(kResiduals);
  return names;
}

std::shared_ptr<FieldFrames> Shot::fields() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const fs::path path = folder_ / "fields.h5";
  if (!fields_ && !folder_.empty() && fs::is_regular_file(path)) {
    fields_ = std::make_shared<FieldFrames>(path);
  }
  return fields_;
}

void Shot::forget_fields() {
  const std::lock_guard<std::mutex> lock(mutex_);
  fields_.reset();
}

}  // namespace impactdic::view

// A clip, the folder of its results, or both: what the page shows at a time.
#pragma once

#include <impactdic/clip.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "host/run/settings/setting_value.h"
#include "host/view/field_frames.h"

namespace impactdic::view {

// Grey levels of the file that are shown black and white.
struct Contrast {
  double black = 0, white = 255;
};

// Levels with all but the darkest and the brightest 0.2 % of the picture's pixels between them.
Contrast stretched_contrast(const Frame& frame);

// The picture as bytes, row after row: `black` and below as 0, `white` and above as 255. Of
// `shrink` by `shrink` pixels the mean, edges cut off.
std::string bytes_of_picture(const Frame& frame, const Contrast& contrast, int shrink);

class Shot {
 public:
  // `folder` may be empty: no results yet. A clip that cannot be read is no error: see clip_error.
  // `residuals`: what a fit left of the track, or empty.
  Shot(ClipRequest clip, std::filesystem::path folder, std::filesystem::path residuals = {});

  // Null where the clip cannot be read; why, in a line.
  std::shared_ptr<FrameSource> source() const { return source_; }
  const std::string& clip_error() const { return clip_error_; }
  const ClipRequest& clip() const { return clip_; }
  Contrast contrast() const { return contrast_; }
  // See bytes_of_picture. Throws InvalidArgument for a frame that the clip lacks, and as `read`.
  std::string picture(std::int64_t frame, const Contrast& contrast, int shrink) const;

  // Where results are, or empty. Called from several threads, as all of these.
  std::filesystem::path folder() const;
  void set_folder(const std::filesystem::path& folder);
  // A file of the results by its name: one of those that `track` and `correlate` write as text, or
  // residuals.csv.
  // Throws NotThere for any other name, or where there is none.
  std::string text(const std::string& name) const;
  // Those of them that are there.
  std::vector<std::string> text_files() const;
  // fields.h5; null where there is none. Throws FileError, FormatError.
  std::shared_ptr<FieldFrames> fields();
  // Lets go of fields.h5, which a run is about to write.
  void forget_fields();

 private:
  ClipRequest clip_;
  std::shared_ptr<FrameSource> source_;
  std::filesystem::path residuals_;
  std::string clip_error_;
  Contrast contrast_;
  mutable std::mutex mutex_;  // of what follows
  std::filesystem::path folder_;
  std::shared_ptr<FieldFrames> fields_;
};

}  // namespace impactdic::view

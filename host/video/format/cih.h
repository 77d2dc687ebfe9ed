// Photron's camera information header: .cih (text) and .cihx (XML), as one set of facts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/video/byte_file.h"

namespace impactdic::video {

struct CihFacts {
  std::string camera;                 // "FASTCAM SA-Z type 2100K-M-64GB"
  std::string recorded_at;            // camera's local date and time, as written
  std::string file_format;            // "MRaw", "Mraw", "TIFF", ...
  std::string color_type;             // "Mono", "Raw", "Color"
  std::optional<double> record_rate;  // frames/s of the recording
  std::optional<double> exposure_s;
  std::int64_t total_frames = 0;
  std::int64_t start_frame = 0;
  std::int64_t save_step = 1;  // recorded periods between stored frames
  std::int64_t width = 0, height = 0;
  std::int64_t color_bit = 0;        // stored bits a pixel
  std::int64_t effective_depth = 0;  // 0: not stated
  bool left_justified = false;       // EffectiveBit Side: Higher
};

// Throws FormatError where the text is not such a header or a needed number is none.
CihFacts read_cih(const ByteFile& file);
CihFacts read_cihx(const ByteFile& file);

}  // namespace impactdic::video

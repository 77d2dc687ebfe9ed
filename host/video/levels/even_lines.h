// Pictures without what the columns and rows of a sensor add to them.
#pragma once

#include <impactdic/clip.h>

#include <memory>
#include <vector>

namespace impactdic::video {

// What lines side by side, columns or rows, show of a grey level v beside what an even sensor
// would: offset + gain (v - level) more, in grey levels of the file. Empty: nothing.
struct LinePattern {
  std::vector<float> offset, gain;  // one a line
  double level = 0;
};

struct SensorPattern {
  LinePattern columns, rows;
};

// The clip with the pattern taken off; in 16 bits where it had 8, so that less than a grey level
// can be. Pixels at either end of the scale stay there: what they show is not known. Throws
// InvalidArgument for a pattern of another size.
std::shared_ptr<FrameSource> even_lines(std::shared_ptr<FrameSource> source,
                                        const SensorPattern& pattern);

}  // namespace impactdic::video

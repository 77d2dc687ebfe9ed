// What a quick look at a clip says, for a person and for summary.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host/advice/clip_advice.h"
#include "host/app/video_options.h"

namespace impactdic::app {

// Windows, usable ones and the error expected of each size; of the ball as a whole; null where
// there was nothing to judge.
nlohmann::json describe_advice(const ClipAdvice& advice);

// The same as lines of label and text. `error_px` is the error that a person wants to reach.
std::vector<std::pair<std::string, std::string>> advice_lines(const ClipAdvice& advice,
                                                              double error_px);

// What the file's header makes doubtful (its frame rate not where --fps is given), and what the
// look found.
std::vector<std::string> all_warnings(const VideoRequest& request, const ClipInfo& info,
                                      const ClipAdvice& advice);

// At the start of a run, on stderr: texture in a line, then the warnings.
void print_advice(const ClipAdvice& advice, const std::vector<std::string>& warnings);

}  // namespace impactdic::app

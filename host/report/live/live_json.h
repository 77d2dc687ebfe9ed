// Rows of a live run as lines of JSON.
#pragma once

#include <impactdic/live/track_live.h>

#include <string>

namespace impactdic::report {

// One line without its end: the columns of track.csv under their names, null where a value was not
// measured, and delay_s. A frame that was dropped has the status "dropped".
std::string live_json_line(const LiveRow& row);

// "10 frames, 9 ok, 1 dropped, …": one line for a person.
std::string in_words(const LiveResult& result);

}  // namespace impactdic::report

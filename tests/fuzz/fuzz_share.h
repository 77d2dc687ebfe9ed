// What processes that share a batch read of each other, out of any bytes.
#pragma once

#include <string>

namespace impactdic::fuzz {

// A folder of tickets, beats and settings that others have left there: its files in lines
// "PATH=TEXT". All that is to be taken is taken and ended.
void read_share(const std::string& text);

// An environment of a launcher, in lines "NAME=VALUE".
void read_launch(const std::string& text);

}  // namespace impactdic::fuzz

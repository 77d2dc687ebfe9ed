// What each setting is for, in the words of --help and of the page.
#pragma once

#include <map>
#include <string>

namespace impactdic::run {

// Of the settings of track, correlate and batch (settings.h), by their keys.
const std::map<std::string, std::string>& setting_texts();

}  // namespace impactdic::run
